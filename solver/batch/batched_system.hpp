// The linear system of a Newton iteration of eight equal chains at once, solved by block LDL^T: linear_system.hpp's
// equations, rod r in lane r.
//
// A chain's matrix is block tridiagonal. Segment k, which joints k - 1 and k share, contributes (m its mass, D its
// diagonal inverse inertia, K the columns dC/dphi, H the joints' half turns; the first terms stand in the
// stretch-shear rows alone)
//   A_kk += I/(m l_k^2) + K_a D K_a^T,   A_k-1,k-1 += I/(m l_k-1^2) + K_b D K_b^T,
//   A_k,k-1 = B_k = -(H_k-1 H_k)^T/(m l_k l_k-1) + K_a D K_b^T.
// Joints are eliminated from the last to the first, each as soon as its blocks are evaluated: A is never stored, and of
// its diagonal blocks only lower triangles are evaluated. With S_k = A_kk - W_k+1^T U_k+1 = L D L^T,
//   W_k = L^-1 B_k,  U_k = D^-1 W_k,  w = L^-1 (b_k - W_k+1^T y_k+1),  y_k = D^-1 w      and then
//   x_k = L^-T (y_k - U_k x_k-1).
#pragma once

#include <vector>

#include "solver/batch/batched_linearization.hpp"

namespace rodsweep {

class BatchedSystem {
 public:
  explicit BatchedSystem(const BatchedRods& rods) : linearization_(rods), columns_(rods.joints.size()) {}

  /// Evaluates b and the Jacobians.
  void linearize(const BatchedRods& rods) { rodsweep::linearize(rods, linearization_); }

  /// The lanes in which all |b| are below the tolerance; NaN is not.
  LaneMask below(double tolerance) const;
  const BatchedLinearization& linearization() const { return linearization_; }

  struct Outcome {
    LaneMask positive;  ///< all pivots are: A is positive definite
    LaneMask finite;    ///< the solution is
  };
  /// Evaluates A and solves A dlambda = b.
  Outcome solve(const BatchedRods& rods);

  /// Of one lane, six numbers a joint.
  void write_solution(int lane, double* solution) const;

  /// Moves the rods by the solution in the lanes `where`, the others not at all.
  void apply(BatchedRods& rods, const LaneMask& where) const;

 private:
  struct Column {
    LaneFactor factor;
    LaneBlock u;
    LaneVector6 solution;  ///< y, then x
  };
  LaneMask eliminate(const BatchedRods& rods);

  BatchedLinearization linearization_;
  std::vector<Column> columns_;
};

}  // namespace rodsweep
