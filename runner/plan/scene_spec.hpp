// Constructs the scene from a job's values at one parameter point. Throws JobError.
#pragma once

#include "runner/job/job.hpp"
#include "runner/sweep/sweep_space.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

SceneSpec scene_spec(const Point& point, const Job& job);

/// Throws JobError if a value of the scene is not allowed or if there is nothing to solve for.
void check_scene(const SceneSpec& scene, const Job& job);

/// Throws JobError if the scene cannot be built, for example because a segment's mass vanishes.
void check_built(const SceneSpec& scene, const Job& job);

}  // namespace rodsweep
