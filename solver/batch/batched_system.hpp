// The linear system of a Newton iteration of several equal chains at once, rod r in lane r: the equations of
// linear_system.hpp, solved by block LDL^T.
//
// The elimination uses the stretch-shear rows in the frame of the joint's second segment: with Q = diag(P_b H^T, I) and
// y = Q x, the matrix is Q A Q^T and the right-hand side Q b. There a joint's sides are, arms over l,
//   Q J_a = (S/l, -S [arm_a]x; 0, -(w I - [v]x) P_a^T),   Q J_b = (-I/l, [arm_b]x; 0, (w I + [v]x) P_b^T),
// S = R(d)^T,
// and its compliance is Q diag(c) Q^T, or diag(c) if the three stretch-shear compliances are equal.
//
// A chain's matrix is block tridiagonal. Segment k, which joints k - 1 and k share, contributes (m its mass, D its
// diagonal inverse inertia, K the rotational columns of Q J; the first terms are in the stretch-shear rows only)
//   A_kk += I/(m l_k^2) + K_a D K_a^T,   A_k-1,k-1 += I/(m l_k-1^2) + K_b D K_b^T,
//   A_k,k-1 = B_k = -S_k/(m l_k l_k-1) + K_a D K_b^T.
// Joints are eliminated from the last to the first, each as soon as its blocks are evaluated: A is never stored, and
// only lower triangles of its diagonal blocks are evaluated. With A_kk - W_k+1^T U_k+1 = L D L^T,
//   W_k = L^-1 B_k,  U_k = D^-1 W_k,  w = L^-1 (b_k - W_k+1^T z_k+1),  z_k = D^-1 w      and then
//   y_k = L^-T (z_k - U_k y_k-1).
// A_k-1,k-1 is evaluated between the factors of A_kk, a sequence of dependent divisions, and B_k.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "solver/batch/batched_balance.hpp"

namespace rodsweep {

class BatchedSystem {
 public:
  /// `balance`: for systems that can keep the balance of momentum.
  BatchedSystem(const BatchedRods& rods, std::optional<BatchedBalance> balance)
      : linearization_(rods), columns_(rods.joints.size()), balance_(std::move(balance)) {}

  /// Evaluates b and the Jacobians. In the lanes `kept` they include g and K, which stiffens the rods.
  void linearize(BatchedRods& rods, const LaneMask& kept);

  /// The lanes in which |C + alpha~ lambda| and the residual of momentum are below their tolerances; NaN is not below.
  LaneMask below(double tolerance, double momentum_tolerance) const;
  const BatchedLinearization& linearization() const { return linearization_; }

  struct Outcome {
    LaneMask positive;  ///< all pivots are positive: A is positive definite
    LaneMask finite;    ///< the solution is finite
  };
  /// Evaluates A and solves A dlambda = b.
  Outcome solve(const BatchedRods& rods);

  /// Writes the solution of one lane, six numbers per joint.
  void write_solution(const BatchedRods& rods, int lane, double* solution) const;

  /// Moves the rods by the solution, in the lanes `where` only.
  void apply(BatchedRods& rods, const LaneMask& where) const;

 private:
  struct Column {
    LaneFactor factor;
    LaneVector6 u[6];      ///< columns
    LaneVector6 solution;  ///< z, then y
  };
  LaneMask eliminate(const BatchedRods& rods);

  BatchedLinearization linearization_;
  std::vector<Column> columns_;
  std::optional<BatchedBalance> balance_;
};

}  // namespace rodsweep
