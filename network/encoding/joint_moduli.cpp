#include "network/encoding/joint_moduli.hpp"

#include <algorithm>

namespace rodsweep {

Eigen::Vector2d joint_moduli(const Rod& rod, const Joint& joint) {
  constexpr double rigid_pa = 1e15;  // modulus of a joint without compliance
  const double r = std::max(rod.segments[static_cast<std::size_t>(joint.a)].radius_m,  // a wall may have radius 0
                            rod.segments[static_cast<std::size_t>(joint.b)].radius_m);
  const double area_moment = pi * r * r * r * r / 4, bend = (joint.compliance[3] + joint.compliance[4]) / 2;
  return {std::min(joint.length / (bend * area_moment), rigid_pa),
          std::min(joint.length / (joint.compliance[5] * 2 * area_moment), rigid_pa)};
}

}  // namespace rodsweep
