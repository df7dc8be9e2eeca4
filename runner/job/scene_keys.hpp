// The keys of `scene` in a job: one table for all scenes of the variant SceneSpec. A new scene adds rows only for its
// own members. If it has members of existing rows, scene names in errors, defaults and the schema are derived
// automatically.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/job/key_table.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

const KeyTable<SceneSpec>& scene_keys();

Key scene_key();

/// Throws JobError if a scene has obstacles without contact. `scenes`: the scene of a validated job, or a sweep of them.
/// If contact is swept, obstacles are allowed: "none" is then the case to compare with.
void check_obstacles(const nlohmann::ordered_json& scenes, const std::filesystem::path& file);

/// A warning for each scene with a rod thicker than long, at the worst of a sweep's values.
std::vector<std::string> thick_rods(const nlohmann::ordered_json& scenes, const std::filesystem::path& file);

/// What was assumed to read the job's skeletons.
std::vector<std::string> assumed_of_skeletons(const Job& job);

/// How far points of curves move to meet within `join_m`, at most.
std::vector<std::string> joined_curves(const Job& job);

/// A warning for each load at a point, and for each scene that is twisted or spun, in steps that do not balance momentum,
/// if the method could. `values`: of a validated job.
std::vector<std::string> unbalanced_loads(const nlohmann::ordered_json& values, const std::filesystem::path& file);

}  // namespace rodsweep
