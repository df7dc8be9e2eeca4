#include "runner/plan/scene_spec.hpp"

#include <fmt/format.h>

#include "runner/specs/scene_keys.hpp"

namespace rodsweep {

SceneSpec scene_spec(const Point& point, const Job& job) {
  auto scene = kind_named<SceneSpec>(point.text("scene.type"));
  scene_keys().fill(scene, {point, job, "scene"});
  return scene;
}

void check_scene(const SceneSpec& scene, const Job& job) {
  const OpenRod* rod = open_rod(scene);
  if (rod && segment_count(scene) < 2) {
    throw job_error(
        job.path, "scene.segments",
        fmt::format(
            "{} is not allowed with clamp \"{}\": there is no joint; must be at least 2, or 1 with clamp \"wall\"",
            rod->segments, rod->clamp == Clamp::free ? "free" : "segment"));
  }
  try {
    validate(scene);
  } catch (const SceneError& error) {
    throw job_error(job.path, "scene", error.what());
  }
}

void check_built(const SceneSpec& scene, const Job& job) {
  try {
    build_scene(scene);
  } catch (const SceneError& error) {
    throw job_error(job.path, "scene", error.what());
  }
}

}  // namespace rodsweep
