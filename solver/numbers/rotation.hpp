// The two rotation maps of the time step, exact inverses of each other:
//   rotated(q, theta)  = normalise(q + [0, theta] q / 2)                       (turns by 2 atan(|theta| / 2))
//   rotation(q, q_old) = 2 Im(d) / Re(d), d = q conj(q_old)                    (gives theta back)
#pragma once

#include <cmath>

#include "solver/numbers/types.hpp"

namespace rodsweep {

inline Quaternion rotated(const Quaternion& q, const Vector3& theta) {
  const double x = theta.x() / 2, y = theta.y() / 2, z = theta.z() / 2;
  Quaternion out(q.w() - x * q.x() - y * q.y() - z * q.z(), q.x() + x * q.w() + y * q.z() - z * q.y(),
                 q.y() + y * q.w() + z * q.x() - x * q.z(), q.z() + z * q.w() + x * q.y() - y * q.x());
  out.coeffs() *= 1 / std::sqrt(out.squaredNorm());
  return out;
}

inline Vector3 rotation(const Quaternion& q, const Quaternion& q_old) {
  const Quaternion d = q * q_old.conjugate();
  return (2 / d.w()) * d.vec();
}

/// The shortest rotation from the direction of one vector to that of another; for opposite vectors, about any axis
/// across them. Replaces Eigen's function, whose singular value decomposition takes seconds to compile.
Quaternion turn_between(const Vector3& from, const Vector3& to);

/// R e_z of a unit quaternion: the world direction of a segment.
inline Vector3 director(const Quaternion& q) {
  return {2 * (q.x() * q.z() + q.w() * q.y()), 2 * (q.y() * q.z() - q.w() * q.x()),
          1 - 2 * (q.x() * q.x() + q.y() * q.y())};
}

}  // namespace rodsweep
