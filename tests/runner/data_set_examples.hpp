// For tests of evaluated tasks and of what reads data sets: records, and files made by one process.
#pragma once

#include "tests/runner/file_examples.hpp"

namespace rodsweep {

/// What a task's evaluation records; an exception if it is abandoned.
TaskRecord record_of(const Plan& plan, std::int64_t task = 0);

/// Rows of the solves that were run.
std::vector<std::size_t> rows_run(const TaskRecord& record);

/// Five steps of the small job.
Json five_steps(const std::string& guesses, const std::string& solve = "{}");

/// The file of a job, of which tasks from `failing` on fail, or are left out where `pending`.
Plan make_data_set(const std::filesystem::path& path, const Json& job, std::int64_t failing = 1000,
                   bool pending = false);

}  // namespace rodsweep
