// Constraints and their Jacobians of every joint of a rod at its current positions.
//
//   stretch-shear  C_s = (x_a + rho_a - x_b - rho_b) / l,        rho = R arm          (world frame, dimensionless)
//   bend-twist     C_b = 2 Im(d) - 2 Im(d0),  d = conj(q_a) q_b, d taken in d0's hemisphere
// which is l (Omega - Omega0) with the Darboux vector Omega = (2/l) Im(d)  (Kugelstadt & Schoemer 2016; Deul et al.
// 2018).
//
// With the update q <- normalise(q + [0, dtheta] q / 2) the Jacobians are
//   dC_s/dx_a = I/l,  dC_s/dtheta_a = -[rho_a]x / l,  dC_s/dx_b = -I/l,  dC_s/dtheta_b = [rho_b]x / l,
//   dC_b/dtheta_b = G = s (d_w I - [Im d]x) R_a^T,  dC_b/dtheta_a = -G,  s the hemisphere's sign.
#pragma once

#include <vector>

#include "solver/numbers/lanes.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// One joint's Jacobian: the columns dC/dtheta of its two sides (six rows in the six lanes), and dC/dx = +-I/l.
struct JointJacobian {
  Lane8 rotation_a[3];
  Lane8 rotation_b[3];
  double inverse_length;  ///< 1/l [1/m]
};

/// A segment's axes in the world, the columns of R.
struct SegmentFrame {
  Lane4 column[3];  ///< the fourth lane zero
};

struct Linearization {
  std::vector<JointJacobian> joints;
  std::vector<SegmentFrame> frame;
  std::vector<Vector3> axis;  ///< world direction of every segment's local z
  VectorX constraint;         ///< C, six per joint

  explicit Linearization(const Rod& rod);  ///< sized, not evaluated
};

/// One joint's Jacobian and the six values of its C at the rod's positions.
void linearize(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint);

/// Evaluates `out` at the rod's positions. Allocates nothing.
void linearize(const Rod& rod, Linearization& out);

}  // namespace rodsweep
