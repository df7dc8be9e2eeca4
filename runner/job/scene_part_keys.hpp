// The keys of the parts of a scene in a job: `scene.wind`, `scene.contact`, `scene.obstacles`.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/job/key_table.hpp"
#include "solver/scene/contact_settings.hpp"
#include "solver/scene/wind.hpp"

namespace rodsweep {

KeyTable<WindParameters> wind_keys();
KeyTable<ContactSettings> contact_keys();
Key obstacles_key();

/// Throws JobError for a half-space without a direction.
void read_value(const Place& list, std::vector<Obstacle>& obstacles);

inline nlohmann::ordered_json written(const Key&, const std::vector<Obstacle>&) {
  return nlohmann::ordered_json::array();  // none is the default
}

/// Throws JobError for obstacles in a scene that nothing can touch: a validated job's scene, or a sweep of scenes.
/// Where contact is swept they may stand, since "none" is then what contact is compared with.
void check_obstacles(const nlohmann::ordered_json& scene, const std::string& path, const std::filesystem::path& file);

}  // namespace rodsweep
