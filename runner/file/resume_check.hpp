// May a sweep be continued in this file? One process, read-only. Throws FileError that says what differs and what to
// do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "runner/plan/plan.hpp"

namespace rodsweep {

struct ResumePoint {
  std::vector<std::uint8_t> done;   ///< state bytes, by task index, whatever they are
  std::vector<std::uint8_t> tries;  ///< /timing/tasks/tries, likewise
  int runs = 0;                     ///< rows of /runs in use
};

/// Does the job expand to the tasks that the file has?
void check_same_tasks(const std::filesystem::path& path, const Plan& plan);

/// Was the file made from this plan by a program that expands the plan's job in the same way? `advice`: what to do if
/// not.
void check_same_plan(const std::filesystem::path& path, const Plan& plan, const char* advice);

ResumePoint check_resumable(const std::filesystem::path& path, const Plan& plan);

}  // namespace rodsweep
