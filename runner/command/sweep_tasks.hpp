// The tasks that a run has to do.
#pragma once

#include <optional>
#include <vector>

#include "runner/command/shard.hpp"
#include "runner/command/sweep_summary.hpp"
#include "runner/dispatch/pending_task.hpp"
#include "runner/file/extension.hpp"
#include "runner/file/results_file.hpp"

namespace rodsweep {

/// Whether an incomplete task has reached the limit of crashes and is not retried.
bool has_crashed(const ResultsFile& file, std::int64_t task, int max_crashes);

/// The tasks of the shard that are neither done nor crashed.
std::vector<PendingTask> pending_tasks(const Plan& plan, const ResultsFile& file,
                                       const std::optional<Extension>& extension, const std::optional<Shard>& shard,
                                       int max_crashes);

/// Removes tasks from `pending` whose results exceed `memory` bytes.
TooLarge leave_out_too_large(const Plan& plan, std::vector<PendingTask>& pending, double memory);

}  // namespace rodsweep
