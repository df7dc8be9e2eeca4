// From the values of a job at one parameter point to the scene that they describe. Throws JobError.
#pragma once

#include "runner/job/job.hpp"
#include "runner/job/sweep_space.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

SceneSpec scene_spec(const Point& point, const Job& job);

/// Refuses a scene that cannot be built, or in which nothing can be solved for.
void check_scene(const SceneSpec& scene, const Job& job);

}  // namespace rodsweep
