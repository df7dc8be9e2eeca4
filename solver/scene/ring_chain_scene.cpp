#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

constexpr double open_ring_radii = 40;  // circumference of the smallest ring through which the next fits

void displace(Rod& rod, const Quaternion& turn, const Vector3& shift) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    rod.position[s] = turn * rod.position[s] + shift;
    rod.orientation[s] = (turn * rod.orientation[s]).normalized();
  }
}

}  // namespace

void RingChain::check() const {
  check_least("rings", rings, 1);
  check_least("segments", segments, 8, ": fewer do not make a round ring");
  const double shortest = open_ring_radii * radius_m;
  if (!(length_m >= shortest))
    throw SceneError("length_m is " + std::to_string(length_m) + "; must be at least " + std::to_string(shortest) +
                     " for rings of this radius_m to hang through each other");
  check_segments("a chain", static_cast<double>(rings) * segments);
}

SceneSize RingChain::size() const { return {rings * segments, rings * segments, rings, "rings"}; }

void RingChain::build(Scene& scene) const {
  Ring ring;
  static_cast<RodParameters&>(ring) = *this;
  ring.segments = segments;
  ring.length_m = length_m;
  ring.rest_shape = Ring::RestShape::circle;
  // From the top of a ring to that of the next: the inner diameter minus the next ring's thickness. The diameter is
  // twice the apothem, because rings hang from the middle of a side; a tenth of a radius remains free.
  const double drop = length_m / segments / std::tan(pi / segments) - 2.1 * radius_m;
  for (int k = 0; k < rings; ++k) {
    ring.clamp = k == 0 ? Clamp::segment : Clamp::free;
    ring.build(scene);
    const Quaternion turn(Eigen::AngleAxisd(k % 2 * pi / 2, Vector3::UnitY()));
    displace(scene.rods.back(), turn, Vector3(0, -k * drop, 0));
  }
}

}  // namespace rodsweep
