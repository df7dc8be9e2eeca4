#include <algorithm>
#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// The first positions of a hexagonal lattice of unit distance, ring by ring from the middle.
std::vector<Vector3> hexagonal_places(int count) {
  std::vector<Vector3> places{Vector3::Zero()};
  for (int ring = 1; static_cast<int>(places.size()) < count; ++ring)
    for (int side = 0; side < 6; ++side)
      for (int i = 0; i < ring; ++i) {
        const double at = side * pi / 3, along = at + 2 * pi / 3;
        places.push_back(ring * Vector3(std::cos(at), 0, std::sin(at)) +
                         i * Vector3(std::cos(along), 0, std::sin(along)));
      }
  places.resize(at(count));
  return places;
}

}  // namespace

void Bundle::check() const {
  check_least("rods", rods, 1);
  check_least("segments", segments, 2, ": the first ones are held");
  if (!(initial_angle_deg >= 0 && initial_angle_deg <= 90))
    throw SceneError("initial_angle_deg is " + std::to_string(initial_angle_deg) +
                     "; must be from 0 to 90 for a bundle, whose rods must not cross");
  check_segments("a bundle", static_cast<double>(rods) * segments);
}

SceneSize Bundle::size() const { return {rods * segments, rods * (segments - 1), rods}; }

void Bundle::build(Scene& scene) const {
  const std::vector<Vector3> places = hexagonal_places(rods);
  const double widest = std::max(1.0, places.back().norm());
  for (const Vector3& place : places) {
    const double angle = initial_angle_deg * pi / 180 * place.norm() / widest;
    const Vector3 outwards = place.isZero() ? Vector3(0, 0, 0) : Vector3(place.normalized());
    const Vector3 top = 2.1 * radius_m * place;
    const Vector3 along = std::sin(angle) * outwards - std::cos(angle) * Vector3::UnitY();
    std::vector<SegmentSpec> rod = segments_through(straight_line(top, top + length_m * along, segments), *this);
    rod.front().is_static = true;
    scene.rods.push_back(chain(rod, *this, weight(rod, *this)));
  }
}

}  // namespace rodsweep
