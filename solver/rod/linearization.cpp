#include "solver/rod/linearization.hpp"

#include <cstring>

namespace rodsweep {
namespace {

/// The columns of R(q).
inline SegmentFrame frame_of(const Quaternion& q) {
  const double x = q.x() + q.x(), y = q.y() + q.y(), z = q.z() + q.z();
  const double xx = x * q.x(), yy = y * q.y(), zz = z * q.z();
  const double xy = x * q.y(), xz = x * q.z(), yz = y * q.z();
  const double wx = x * q.w(), wy = y * q.w(), wz = z * q.w();
  return {{Lane4{1 - (yy + zz), xy + wz, xz - wy, 0}, Lane4{xy - wz, 1 - (xx + zz), yz + wx, 0},
           Lane4{xz + wy, yz - wx, 1 - (xx + yy), 0}}};
}

inline Lane4 operator*(const SegmentFrame& frame, const Vector3& v) {
  return frame.column[0] * v.x() + frame.column[1] * v.y() + frame.column[2] * v.z();
}

inline Lane4 lanes(const Vector3& v) { return Lane4{v.x(), v.y(), v.z(), 0}; }

inline Lane4 lanes(const Quaternion& q) {  // x, y, z, w
  Lane4 out;
  std::memcpy(&out, q.coeffs().data(), sizeof out);
  return out;
}

/// conj(a) b.
inline Lane4 relative(const Quaternion& a, const Quaternion& b) {
  const Lane4 q = lanes(b);
  return a.w() * q + a.x() * (Lane4{-1, 1, -1, 1} * __builtin_shufflevector(q, q, 3, 2, 1, 0)) +
         a.y() * (Lane4{-1, -1, 1, 1} * __builtin_shufflevector(q, q, 2, 3, 0, 1)) +
         a.z() * (Lane4{1, -1, -1, 1} * __builtin_shufflevector(q, q, 1, 0, 3, 2));
}

/// The columns of w I - [v]x.
inline void rotation_columns(const Lane4& v, double w, Lane4 (&column)[3]) {
  const Lane4 u = {v[0], v[1], v[2], w};
  column[0] = Lane4{1, -1, 1, 0} * __builtin_shufflevector(u, u, 3, 2, 1, 0);
  column[1] = Lane4{1, 1, -1, 0} * __builtin_shufflevector(u, u, 2, 3, 0, 1);
  column[2] = Lane4{-1, 1, 1, 0} * __builtin_shufflevector(u, u, 1, 0, 3, 2);
}

/// Stretch-shear rows from one, bend-twist rows from the other.
inline Lane8 rows(const Lane4& stretch, const Lane4& bend) {
  return __builtin_shufflevector(stretch, bend, 0, 1, 2, 4, 5, 6, 3, 3);
}

inline void linearize(const Rod& rod, const Joint& joint, const SegmentFrame& frame_a, const SegmentFrame& frame_b,
                      JointJacobian& jacobian, double* constraint) {
  const std::size_t a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
  const double inverse_length = 1 / joint.length;
  const Lane4 arm_a = inverse_length * (frame_a * joint.arm_a);  // rho / l
  const Lane4 arm_b = inverse_length * (frame_b * joint.arm_b);
  const Lane4 stretch = inverse_length * (lanes(rod.position[a]) - lanes(rod.position[b])) + arm_a - arm_b;

  const Lane4 rest = lanes(joint.rest);
  Lane4 d = relative(rod.orientation[a], rod.orientation[b]);
  const Lane4 products = d * rest;
  if ((products[0] + products[1]) + (products[2] + products[3]) < 0) d = -d;
  store6(constraint, rows(stretch, 2 * (d - rest)));

  Lane4 hat[3], cross_a[3], cross_b[3];
  rotation_columns(d, d[3], hat);
  rotation_columns(arm_a, 0, cross_a);
  rotation_columns(arm_b, 0, cross_b);
  jacobian.inverse_length = inverse_length;
  for (int c = 0; c < 3; ++c) {
    const Lane4 g = hat[0] * frame_a.column[0][c] + hat[1] * frame_a.column[1][c] + hat[2] * frame_a.column[2][c];
    jacobian.rotation_a[c] = rows(cross_a[c], -g);
    jacobian.rotation_b[c] = rows(-cross_b[c], g);
  }
}

}  // namespace

Linearization::Linearization(const Rod& rod)
    : joints(rod.joints.size()),
      frame(rod.segments.size()),
      axis(rod.segments.size()),
      constraint(VectorX::Zero(6 * rod.joint_count())) {}

void linearize(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint) {
  linearize(rod, joint, frame_of(rod.orientation[static_cast<std::size_t>(joint.a)]),
            frame_of(rod.orientation[static_cast<std::size_t>(joint.b)]), jacobian, constraint);
}

void linearize(const Rod& rod, Linearization& out) {
  for (std::size_t i = 0; i < rod.segments.size(); ++i) {
    out.frame[i] = frame_of(rod.orientation[i]);
    const Lane4& axis = out.frame[i].column[2];
    out.axis[i] = {axis[0], axis[1], axis[2]};
  }
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    linearize(rod, joint, out.frame[static_cast<std::size_t>(joint.a)], out.frame[static_cast<std::size_t>(joint.b)],
              out.joints[k], out.constraint.data() + 6 * k);
  }
}

}  // namespace rodsweep
