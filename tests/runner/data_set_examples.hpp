// For tests of what reads data sets: their files, made by one process.
#pragma once

#include "tests/runner/file_examples.hpp"

namespace rodsweep {

/// The file of a job, of which tasks from `failing` on fail, or are left out where `pending`.
Plan make_data_set(const std::filesystem::path& path, const Json& job, std::int64_t failing = 1000,
                   bool pending = false);

}  // namespace rodsweep
