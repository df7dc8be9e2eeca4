// Which tasks of a sweep a run has to do, and what is known of them from earlier runs.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "runner/command/shard.hpp"
#include "runner/command/sweep_summary.hpp"
#include "runner/dispatch/pending_task.hpp"
#include "runner/dispatch/time_budget.hpp"
#include "runner/file/extension.hpp"
#include "runner/file/results_file.hpp"

namespace rodsweep {

/// Whether a task that is not done has crashed as often as allowed, and is not tried again.
bool has_crashed(const ResultsFile& file, std::int64_t task, int max_crashes);

/// Those of the shard that are neither done nor crashed.
std::vector<PendingTask> pending_tasks(const Plan& plan, const ResultsFile& file,
                                       const std::optional<Extension>& extension, const std::optional<Shard>& shard,
                                       int max_crashes);

/// Takes out of `pending` what keeps more than `memory` bytes of results: no rank has room for them.
TooLarge leave_out_too_large(const Plan& plan, std::vector<PendingTask>& pending, double memory);

/// How long tasks took, and how far abandoned ones came.
void learn_from_earlier_runs(const std::filesystem::path& path, const Plan& plan, const ResultsFile& file,
                             std::vector<PendingTask>& pending, TimeBudget& time);

}  // namespace rodsweep
