// For tests of evaluated tasks and of readers of data sets: records, and files written by one process.
#pragma once

#include "tests/runner/file_examples.hpp"

namespace rodsweep {

/// The record of an evaluated task; throws if the evaluation is cancelled.
TaskRecord record_of(const Plan& plan, std::int64_t task = 0);
TaskRecord record_of(const Json& job, std::int64_t task = 0);

/// Rows of the solves that ran.
std::vector<std::size_t> rows_run(const TaskRecord& record);

/// The small job with five steps.
Json five_steps(const std::string& guesses, const std::string& solve = "{}");

/// Writes the file of a job. Tasks from `failing` on diverge; with `pending` they are not written.
Plan make_data_set(const std::filesystem::path& path, const Json& job, std::int64_t failing = 1000,
                   bool pending = false);

/// A data set of three rods of different sizes.
Json ragged_job();

/// Overwrites a solution of task 1 in the file of this plan, which no longer has its checksum then.
void damage(const std::filesystem::path& path, const Plan& plan);

}  // namespace rodsweep
