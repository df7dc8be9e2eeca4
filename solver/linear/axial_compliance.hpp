// Joints that stretch along the rod as EA lets them, and shear across it as kappa G A does.
//
// The three stretch-shear rows of C are in the world frame, so their compliance turns with the rod:
//   alpha_s = alpha I + e t t^T,   t the mean direction of the joint's two segments,
// alpha that of shear (rows 0..2 of Joint::compliance), alpha + e that along t (e is Joint::axial_excess). Newton
// leaves out how t turns, and the step the couple gap x F of a force across its gap: both are of second order in the
// strain. Joints with e = 0, which are all "inextensible" ones, cost nothing here.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"
#include "solver/rod/linearization.hpp"

namespace rodsweep {

/// e t t^T of a joint between segments of these directions.
inline Matrix3 axial_compliance(const Joint& joint, const Vector3& axis_a, const Vector3& axis_b) {
  const Vector3 t = (axis_a + axis_b).normalized();
  return joint.axial_excess * t * t.transpose();
}
Matrix3 axial_compliance(const Rod& rod, const Linearization& at, std::size_t k);

/// C_s^T alpha_s^-1 C_s / 2 [J] of the stretch-shear rows of joint k; what has no compliance stores nothing.
double stretch_energy(const Rod& rod, const Linearization& at, std::size_t k);

/// Joints with e != 0.
std::vector<std::size_t> axial_joints(const Rod& rod);

/// Adds to A, and takes from b, what e makes of alpha~ in these joints.
void add_axial_compliance(const Rod& rod, const Linearization& at, const std::vector<std::size_t>& joints,
                          double inverse_dt2, BlockMatrix& matrix, VectorX& rhs);

}  // namespace rodsweep
