#include <cmath>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {

void CoilingRod::check() const { check_least("segments", segments, 2, ": the first one is held"); }

SceneSize CoilingRod::size() const { return {segments, segments - 1}; }

void CoilingRod::build(Scene& scene) const {
  std::vector<Vector3> vertices;
  for (int i = 0; i <= segments; ++i) {
    const double along = static_cast<double>(i) / segments, turn = 2 * pi * along / 100;
    vertices.emplace_back(radius_m * (std::cos(turn) - 1), height_m + radius_m + length_m * (1 - along),
                          radius_m * std::sin(turn));
  }
  std::vector<SegmentSpec> rod = segments_through(vertices, *this);
  rod.front().is_static = true;
  scene.rods.push_back(chain(rod, *this, weight(rod, *this), true));
  scene.obstacles.emplace_back(HalfSpace{});
  move_clamp(scene, 0, Vector3(0, -feed_m_s, 0));
}

}  // namespace rodsweep
