#include <cmath>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// A rod whose joints lie on `vertices`, and the force at its tip.
void add_rod(const std::vector<Vector3>& vertices, const OpenRod& p, Scene& scene) {
  std::vector<SegmentSpec> segments = segments_through(vertices, p);
  segments.front().is_static = p.clamp == Clamp::segment;
  if (p.clamp == Clamp::wall) {
    SegmentSpec wall;
    wall.position_m = vertices.front();
    wall.orientation = segments.front().orientation;
    wall.is_static = true;
    segments.insert(segments.begin(), wall);
  }
  scene.rods.push_back(chain(segments, p, weight(segments, p) + p.tip_force_n.norm()));
  if (p.tip_force_n.isZero()) return;
  const Vector3 tip(0, 0, segments.back().length_m / 2);
  scene.loads.push_back({0, static_cast<int>(segments.size()) - 1, p.tip_force_n, Vector3::Zero(), tip});
}

}  // namespace

void OpenRod::check() const {
  if (clamp == Clamp::segment)
    check_least("segments", segments, 2, ": the clamp \"segment\" holds the first one");
  else
    check_least("segments", segments, 1);
}

SceneSize OpenRod::size() const {
  const int count = segments + (clamp == Clamp::wall ? 1 : 0);
  return {count, count - 1};
}

void BendingRod::build(Scene& scene) const {
  const double angle = initial_angle_deg * pi / 180;
  const Vector3 along = length_m / segments * Vector3(std::cos(angle), std::sin(angle), 0);
  std::vector<Vector3> vertices;
  for (int i = 0; i <= segments; ++i) vertices.push_back(i * along);
  add_rod(vertices, *this, scene);
}

void Helix::build(Scene& scene) const {
  std::vector<Vector3> vertices;
  for (int i = 0; i <= segments; ++i) {
    const double fraction = static_cast<double>(i) / segments;
    const double t = 2 * pi * windings * fraction;
    vertices.emplace_back(helix_radius_m * std::cos(t), -helix_height_m * fraction, helix_radius_m * std::sin(t));
  }
  add_rod(vertices, *this, scene);
}

}  // namespace rodsweep
