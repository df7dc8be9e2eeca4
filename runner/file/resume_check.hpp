// Checks whether a sweep can be resumed in a file. One process, read-only. Throws FileError with the difference and
// advice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "runner/plan/plan.hpp"

namespace rodsweep {

struct ResumePoint {
  std::vector<std::uint8_t> done;   ///< raw state bytes, by task index
  std::vector<std::uint8_t> tries;  ///< /timing/tasks/tries, by task index
  int runs = 0;                     ///< number of used rows of /runs
};

/// Throws unless the plan has the same tasks as the file.
void check_same_tasks(const std::filesystem::path& path, const Plan& plan);

/// Throws, with `advice`, unless the file was made from this plan by a program that expands its job in the same way.
void check_same_plan(const std::filesystem::path& path, const Plan& plan, const char* advice);

ResumePoint check_resumable(const std::filesystem::path& path, const Plan& plan);

}  // namespace rodsweep
