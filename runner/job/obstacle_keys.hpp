// What the rods of a scene in a job touch besides each other: the keys, and what they describe.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/job/job.hpp"
#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "solver/scene/contact_settings.hpp"

namespace rodsweep {

Key obstacles_key();

/// At a parameter point. Throws JobError for a half-space without a direction.
std::vector<Obstacle> obstacles(const Point& point, const Job& job);

/// Throws JobError for obstacles in a scene that nothing can touch: a validated job's scene, or a sweep of scenes.
/// Where contact is swept they may stand, since "none" is then what contact is compared with.
void check_obstacles(const nlohmann::ordered_json& scene, const std::string& path, const std::filesystem::path& file);

}  // namespace rodsweep
