#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

constexpr double golden_turn = 2.39996322972865332;  // the golden angle [rad]

}  // namespace

void FallingRods::check() const {
  check_least("rods", rods, 1);
  check_least("segments", segments, 2);
  if (!(height_m >= 2 * radius_m))
    throw SceneError("height_m is " + std::to_string(height_m) + "; must be at least 2 radius_m, or the rods overlap");
  check_segments("a heap", static_cast<double>(rods) * segments);
}

SceneSize FallingRods::size() const { return {rods * segments, rods * (segments - 1), rods}; }

// Centres are off the axis by a tenth of the length, all to different sides, so that a heap forms rather than a stack.
void FallingRods::build(Scene& scene) const {
  for (int k = 0; k < rods; ++k) {
    const double angle = k * turn_deg * pi / 180, side = k * golden_turn;
    const Vector3 half = length_m / 2 * Vector3(std::cos(angle), 0, std::sin(angle));
    const Vector3 centre(length_m / 10 * std::cos(side), radius_m + (k + 1) * height_m, length_m / 10 * std::sin(side));
    const std::vector<SegmentSpec> rod = segments_through(straight_line(centre - half, centre + half, segments), *this);
    scene.rods.push_back(chain(rod, *this, weight(rod, *this)));
  }
  scene.obstacles.emplace_back(HalfSpace{});
}

}  // namespace rodsweep
