#include "solver/linearization.hpp"

#include "solver/rotation.hpp"

namespace rodsweep {

Linearization::Linearization(const Rod& rod)
    : joints(rod.joints.size()), axis(rod.segments.size()), constraint(VectorX::Zero(6 * rod.joint_count())) {}

void linearize(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint) {
  const std::size_t a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
  const Matrix3 rotation_a = rod.orientation[a].toRotationMatrix();
  const double inverse_length = 1 / joint.length;
  const Vector3 arm_a = inverse_length * (rotation_a * joint.arm_a);  // rho / l
  const Vector3 arm_b = inverse_length * (rod.orientation[b].toRotationMatrix() * joint.arm_b);

  Eigen::Map<Vector3> stretch(constraint), bend(constraint + 3);
  stretch = (rod.position[a] - rod.position[b]) * inverse_length + arm_a - arm_b;

  Quaternion d = rod.orientation[a].conjugate() * rod.orientation[b];
  if (d.dot(joint.rest) < 0) d.coeffs() = -d.coeffs();
  bend = 2 * (d.vec() - joint.rest.vec());

  Matrix3 hat;  // d_w I - [Im d]x
  hat << d.w(), d.z(), -d.y(), -d.z(), d.w(), d.x(), d.y(), -d.x(), d.w();
  const Matrix3 g = hat * rotation_a.transpose();

  jacobian.inverse_length = inverse_length;
  jacobian.rotation_a[0] = Lane8{0, -arm_a.z(), arm_a.y(), -g(0, 0), -g(1, 0), -g(2, 0), 0, 0};
  jacobian.rotation_a[1] = Lane8{arm_a.z(), 0, -arm_a.x(), -g(0, 1), -g(1, 1), -g(2, 1), 0, 0};
  jacobian.rotation_a[2] = Lane8{-arm_a.y(), arm_a.x(), 0, -g(0, 2), -g(1, 2), -g(2, 2), 0, 0};
  jacobian.rotation_b[0] = Lane8{0, arm_b.z(), -arm_b.y(), g(0, 0), g(1, 0), g(2, 0), 0, 0};
  jacobian.rotation_b[1] = Lane8{-arm_b.z(), 0, arm_b.x(), g(0, 1), g(1, 1), g(2, 1), 0, 0};
  jacobian.rotation_b[2] = Lane8{arm_b.y(), -arm_b.x(), 0, g(0, 2), g(1, 2), g(2, 2), 0, 0};
}

void linearize(const Rod& rod, Linearization& out) {
  for (std::size_t i = 0; i < rod.segments.size(); ++i) out.axis[i] = director(rod.orientation[i]);
  for (std::size_t k = 0; k < rod.joints.size(); ++k)
    linearize(rod, rod.joints[k], out.joints[k], out.constraint.data() + 6 * k);
}

}  // namespace rodsweep
