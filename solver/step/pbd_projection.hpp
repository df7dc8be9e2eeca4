// Position-based dynamics of Cosserat rods (Mueller et al. 2006; Kugelstadt & Schoemer 2016): closed-form corrections
// without compliances or multipliers, Gauss-Seidel over the joints. With the gap g = x_a + rho_a - x_b - rho_b [m],
// rho = R arm, and C_b, d of linearization.hpp, a joint is corrected by first
//   mu = -k_s g / (w_a + w_b + i_a |arm_a|^2 + i_b |arm_b|^2)     stretch-shear
//   dx_a = w_a mu,  dtheta_a = i_a rho_a x mu,   dx_b = -w_b mu,  dtheta_b = -i_b rho_b x mu
// and then
//   t = k_b R_a (d_w C_b + Im(d) x C_b) / (i_a + i_b)             bend-twist
//   dtheta_a = i_a t,   dtheta_b = -i_b t
// w = 1/m, i the transverse inverse inertia, k_s and k_b in [0, 1] act in every iteration: more iterations, smaller
// steps and fewer segments make the rod stiffer, for any moduli.
//
// Differences from Kugelstadt & Schoemer: their particles are at the ends of quaternions, and a stretch-shear
// constraint has two particles and one quaternion. Here positions and orientations are those of segment centres, so a
// constraint has two of each and acts at the joint, as in `direct`. Weights are not free: w is the segment's. A
// quaternion's weight is i/4, with which q moves as the segment does under a torque across its axis. Then their
// denominators follow (w_q 4 r^2 = i r^2), and their corrections except the part along q, which normalisation removes.
#pragma once

#include "solver/step/gauss_seidel.hpp"

namespace rodsweep {

struct PbdStiffness {
  double stretch = 1;  ///< k_s of stretch-shear, 0 to 1
  double bending = 1;  ///< k_b of bend-twist, 0 to 1
};

class PbdProjection : public GaussSeidelProjection {
 public:
  PbdProjection(const Scene& scene, const PbdStiffness& stiffness)
      : GaussSeidelProjection(scene), stiffness_(stiffness) {}

 private:
  /// The residual is max |C|, with the length of C_s; multipliers stay zero.
  Iteration iterate(Rod& rod, const std::vector<int>& order, double dt) const override;

  PbdStiffness stiffness_;
};

}  // namespace rodsweep
