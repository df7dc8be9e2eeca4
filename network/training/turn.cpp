#include "network/training/turn.hpp"

#include <cmath>

namespace rodsweep {
namespace {

/// Uniform on the sphere, by Archimedes' projection of a cylinder.
Vector3 random_direction(SplitMix& random) {
  const double z = 2 * random.uniform() - 1, angle = 2 * pi * random.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

Turn random_turn(const Vector3& gravity_m_s2, double reach_m, SplitMix& random) {
  const Vector3 any = random_direction(random);
  const Vector3 axis = gravity_m_s2.norm() > 0 ? Vector3(gravity_m_s2.normalized()) : any;
  Turn turn;
  turn.rotation = Quaternion(Eigen::AngleAxisd(2 * pi * random.uniform(), axis));
  for (double& along : turn.shift) along = reach_m * (2 * random.uniform() - 1);
  return turn;
}

Rod turned(const Rod& rod, const Turn& turn) {
  Rod out = rod;
  for (Vector3& x : out.position) x = turn.rotation * x + turn.shift;
  for (Quaternion& q : out.orientation) q = turn.rotation * q;
  for (Vector3& v : out.velocity) v = turn.rotation * v;
  for (Vector3& w : out.angular_velocity) w = turn.rotation * w;
  return out;
}

}  // namespace rodsweep
