// Constructs the scene from a job's values at one parameter point. Throws JobError.
#pragma once

#include "runner/job/job.hpp"
#include "runner/job/sweep_space.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

SceneSpec scene_spec(const Point& point, const Job& job);

/// Throws JobError if the scene cannot be built or has nothing to solve for.
void check_scene(const SceneSpec& scene, const Job& job);

}  // namespace rodsweep
