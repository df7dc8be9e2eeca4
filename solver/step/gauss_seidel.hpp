// Projections that correct one joint after the other, each at the positions after the corrections before it: the family
// of `pbd` and `xpbd`. One call of project() is one iteration; the time step's Newton loop counts them, so
// StepSettings::newton_iterations is the number of iterations per step.
//
// Joints are corrected in bilateral interleaving order (Umetani, Schmidt & Stam 2014; Kugelstadt & Schoemer 2016): even
// ones from the first, odd ones from the last, alternately, so that neither end of a chain is favoured. Any graph of
// joints is allowed, trees and closed loops included, because the correction of a joint does not use its neighbours.
//
// The residual of an iteration is the largest |C + alpha~ lambda|, each evaluated just before the correction of its
// joint, at no extra cost. Nothing allocates after construction.
#pragma once

#include <vector>

#include "solver/step/projection.hpp"

namespace rodsweep {

/// 0, m - 1, 2, m - 3, ... for an even number m of joints, 0, m - 2, 2, m - 4, ... for an odd one.
std::vector<int> bilateral_order(int joints);

class GaussSeidelProjection : public Projection {
 public:
  /// Throws SceneError if a joint joins two static segments.
  explicit GaussSeidelProjection(const Scene& scene);

  /// `not_run` if the residual was below `newton_tolerance` (the corrections of the iteration are kept), `not_a_number`
  /// if it is not finite, `indefinite` if a joint's block is not positive definite.
  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) final;

 protected:
  struct Iteration {
    double residual = 0;   ///< max |C + alpha~ lambda| met
    bool definite = true;  ///< all blocks were positive definite

    void meet(const Vector6& met);
  };

 private:
  /// Corrects the joints of the rod in this order. Called once per iteration.
  virtual Iteration iterate(Rod& rod, const std::vector<int>& order, double dt) const = 0;

  std::vector<std::vector<int>> orders_;  ///< of every rod
};

/// Extended position-based dynamics (Macklin, Mueller & Chentanez 2016): Gauss-Seidel over the joints, with compliances
/// and accumulated multipliers, on the constraints and alpha~ of the linear system (linearization.hpp).
///
/// A joint's six rows are solved together, linearised at the current positions:
///   (J M^-1 J^T + alpha~) dlambda = -C - alpha~ lambda    of that joint alone (6x6)
///   lambda += dlambda,   (u, phi) = M^-1 J^T dlambda of its two segments
/// The paper solves row by row. A block converges in fewer iterations, because stretch-shear and bend-twist of a joint
/// act on the same segments. A fixed point is also one of Newton's iteration, C + alpha~ lambda = 0. But forces act
/// along J at the positions in between, so the results of a step differ by O(dt^4) in positions, O(dt^3) in velocities.
class XpbdProjection : public GaussSeidelProjection {
 public:
  using GaussSeidelProjection::GaussSeidelProjection;

 private:
  Iteration iterate(Rod& rod, const std::vector<int>& order, double dt) const override;
};

struct PbdStiffness {
  double stretch = 1;  ///< k_s of stretch-shear, 0 to 1
  double bending = 1;  ///< k_b of bend-twist, 0 to 1
};

/// Position-based dynamics of Cosserat rods (Mueller et al. 2006; Kugelstadt & Schoemer 2016): closed-form corrections
/// without compliances or multipliers, Gauss-Seidel over the joints. With the gap g = x_a + rho_a - x_b - rho_b [m],
/// rho = R arm, and C_b, d of linearization.hpp, a joint is corrected by first
///   mu = -k_s g / (w_a + w_b + i_a |arm_a|^2 + i_b |arm_b|^2)     stretch-shear
///   dx_a = w_a mu,  dtheta_a = i_a rho_a x mu,   dx_b = -w_b mu,  dtheta_b = -i_b rho_b x mu
/// and then
///   t = k_b R_a (d_w C_b + Im(d) x C_b) / (i_a + i_b)             bend-twist
///   dtheta_a = i_a t,   dtheta_b = -i_b t
/// w = 1/m, i the transverse inverse inertia, k_s and k_b in [0, 1] act in every iteration: more iterations, smaller
/// steps and fewer segments make the rod stiffer, for any moduli.
///
/// Differences from Kugelstadt & Schoemer: their particles are at the ends of quaternions, and a stretch-shear
/// constraint has two particles and one quaternion. Here positions and orientations are those of segment centres, so a
/// constraint has two of each and acts at the joint, as in `direct`. Weights are not free: w is the segment's. A
/// quaternion's weight is i/4, with which q moves as the segment does under a torque across its axis. Then their
/// denominators follow (w_q 4 r^2 = i r^2), and their corrections except the part along q, which normalisation removes.
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
