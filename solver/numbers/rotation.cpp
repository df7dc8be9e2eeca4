#include "solver/numbers/rotation.hpp"

namespace rodsweep {

Quaternion turn_between(const Vector3& from, const Vector3& to) {
  const Vector3 a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  Quaternion turn;
  if (cosine < -1 + 1e-12) {
    turn.w() = 0;
    turn.vec() = a.unitOrthogonal();
    return turn;
  }
  const double s = std::sqrt((1 + cosine) * 2), inverse = 1 / s;
  turn.vec() = a.cross(b) * inverse;
  turn.w() = s * 0.5;
  return turn;
}

}  // namespace rodsweep
