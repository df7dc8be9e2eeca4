// Checks of several keys of a validated job's scenes: what is refused, and what is warned of.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/job/job.hpp"

namespace rodsweep {

/// Throws JobError if a scene has obstacles without contact. `scenes`: the scene of a validated job, or a sweep of them.
/// If contact is swept, obstacles are allowed: "none" is then the case to compare with.
void check_obstacles(const nlohmann::ordered_json& scenes, const std::filesystem::path& file);

/// A line for each value of a scene that is probably not meant, or that the job's steps get wrong.
std::vector<std::string> scene_warnings(const Job& job);

}  // namespace rodsweep
