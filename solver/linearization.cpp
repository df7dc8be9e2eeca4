#include "solver/linearization.hpp"

namespace rodsweep {
namespace {

/// Leaves the entries that are always zero as they are: number by number is the fastest way to put the others.
inline void linearize(const Rod& rod, const Joint& joint, const Matrix3& frame_a, const Matrix3& frame_b,
                      JointJacobian& jacobian, double* constraint) {
  const std::size_t a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
  const double inverse_length = 1 / joint.length;
  const Vector3 arm_a = inverse_length * (frame_a * joint.arm_a);  // rho / l
  const Vector3 arm_b = inverse_length * (frame_b * joint.arm_b);

  Eigen::Map<Vector3> stretch(constraint), bend(constraint + 3);
  stretch = (rod.position[a] - rod.position[b]) * inverse_length + arm_a - arm_b;

  Quaternion d = rod.orientation[a].conjugate() * rod.orientation[b];
  if (d.dot(joint.rest) < 0) d.coeffs() = -d.coeffs();
  bend = 2 * (d.vec() - joint.rest.vec());

  Matrix3 hat;  // d_w I - [Im d]x
  hat << d.w(), d.z(), -d.y(), -d.z(), d.w(), d.x(), d.y(), -d.x(), d.w();
  const Matrix3 g = hat * frame_a.transpose();

  jacobian.inverse_length = inverse_length;
  Lane8 *const ka = jacobian.rotation_a, *const kb = jacobian.rotation_b;
  ka[1][0] = arm_a.z();
  ka[2][0] = -arm_a.y();
  ka[0][1] = -arm_a.z();
  ka[2][1] = arm_a.x();
  ka[0][2] = arm_a.y();
  ka[1][2] = -arm_a.x();
  kb[1][0] = -arm_b.z();
  kb[2][0] = arm_b.y();
  kb[0][1] = arm_b.z();
  kb[2][1] = -arm_b.x();
  kb[0][2] = -arm_b.y();
  kb[1][2] = arm_b.x();
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) {
      ka[c][3 + r] = -g(r, c);
      kb[c][3 + r] = g(r, c);
    }
}

}  // namespace

Linearization::Linearization(const Rod& rod)
    : joints(rod.joints.size()),
      frame(rod.segments.size()),
      axis(rod.segments.size()),
      constraint(VectorX::Zero(6 * rod.joint_count())) {}

void linearize(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint) {
  jacobian = {};
  linearize(rod, joint, rod.orientation[static_cast<std::size_t>(joint.a)].toRotationMatrix(),
            rod.orientation[static_cast<std::size_t>(joint.b)].toRotationMatrix(), jacobian, constraint);
}

void linearize(const Rod& rod, Linearization& out) {
  for (std::size_t i = 0; i < rod.segments.size(); ++i) {
    out.frame[i] = rod.orientation[i].toRotationMatrix();
    out.axis[i] = out.frame[i].col(2);
  }
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    linearize(rod, joint, out.frame[static_cast<std::size_t>(joint.a)], out.frame[static_cast<std::size_t>(joint.b)],
              out.joints[k], out.constraint.data() + 6 * k);
  }
}

}  // namespace rodsweep
