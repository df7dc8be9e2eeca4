// Which tasks of a sweep a start has to do, and what is known of them from the starts before.
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

/// A task that was begun often enough, and of whose workers none said what came of it, is tried no more.
bool is_given_up(const ResultsFile& file, std::int64_t task, int attempts);

/// Those of the shard that are neither done nor given up.
std::vector<PendingTask> pending_tasks(const Plan& plan, const ResultsFile& file,
                                       const std::optional<Extension>& extension, const std::optional<Shard>& shard,
                                       int attempts);

/// Takes out of `pending` what keeps more than `memory` bytes of results: no rank has room for them.
TooLarge leave_out_too_large(const Plan& plan, std::vector<PendingTask>& pending, double memory);

/// How long tasks took, and how far those came that were given up.
void learn_from_earlier_starts(const std::filesystem::path& path, const Plan& plan, const ResultsFile& file,
                               std::vector<PendingTask>& pending, TimeBudget& time);

}  // namespace rodsweep
