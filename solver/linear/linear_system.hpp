// The linear system of one Newton iteration on one rod, and the update that its solution makes:
//
//   A dlambda = b,   A = J M^-1 J^T + alpha~,   b = -C - alpha~ lambda,   alpha~ = alpha / dt^2
//   (u, phi) = M^-1 J^T dlambda,   lambda += dlambda,   x += R u,   q <- normalise(q + q [0, phi] / 2)
//
// If the balance of momentum is kept, with its defect g and the geometric stiffness K (momentum_balance.hpp),
//
//   A = J (M + K)^-1 J^T + alpha~,   b = -C - alpha~ lambda + J (M + K)^-1 g
//   (u, phi) = (M + K)^-1 (J^T dlambda - g)
//
// All in the segments' and joints' own frames (linearization.hpp): rotating or shifting a rod changes neither A nor b
// (Deul et al. 2018; Shao et al. 2021). A is symmetric positive definite, with one 6x6 block row per joint. A joint is
// coupled to all joints that share a dynamic segment with it, siblings at a branching included. Nothing allocates after
// construction.
#pragma once

#include <optional>

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/constraint_product.hpp"
#include "solver/rod/linearization.hpp"
#include "solver/rod/momentum_balance.hpp"

namespace rodsweep {

class LinearSystem {
 public:
  explicit LinearSystem(const Rod& rod);

  /// Evaluates A and b at the rod's positions and multipliers.
  void assemble(const Rod& rod, double dt);
  void assemble_balanced(Rod& rod, double dt);  ///< with g and K; stiffens the rod

  /// M^-1 J^T dlambda, per segment and in its frame: u in lanes 0..2, phi in lanes 3..5, zero if static.
  void displacements(const Rod& rod, const VectorX& delta_lambda, std::vector<Lane8>& out) const;

  /// Moves the rod by the solution of the assembled system.
  void apply(Rod& rod, const VectorX& delta_lambda);

  bool keeps_balance() const { return balanced_; }  ///< was assembled with g and K
  const BlockMatrix& matrix() const { return matrix_; }
  const VectorX& rhs() const { return rhs_; }
  /// y = A x, by the matrix or, if that is faster, without it.
  void multiply(const double* x, double* y) const { product_ ? product_->multiply(x, y) : matrix_.multiply(x, y); }
  const ConstraintProduct* product() const {
    return product_ ? &*product_ : nullptr;
  }  ///< null: the product of the matrix is used
  const Linearization& linearization() const { return linearization_; }
  double dt() const { return dt_; }  ///< of the assembly
  /// max |C + alpha~ lambda|, the residual that Newton drives to zero; NaN if any entry is.
  double newton_residual() const { return newton_residual_; }
  /// Residual of the balance of momentum (MomentumBalance::residual); 0 if it is not kept.
  double momentum_residual() const { return balanced_ ? balance_.residual : 0; }
  /// max |b|; equal to the Newton residual if the balance is not kept.
  double largest_rhs() const;

 private:
  /// The 6x6 product of two sides on one segment: its block, and whether it is the first contribution to it.
  struct Contribution {
    int block;
    bool first;
  };
  void assemble_linearized(const Rod& rod, double dt);
  void assemble_matrix(const Rod& rod, double inverse_dt2);
  void hold_forces(Rod& rod) const;  ///< of stretch-shear, after a move by displacements_

  Linearization linearization_;
  BlockMatrix matrix_;
  std::optional<ConstraintProduct> product_;
  VectorX rhs_;
  std::vector<int> side_start_;  ///< sides of segment i: side_start_[i] .. side_start_[i + 1]; none for static ones
  std::vector<JointEnd> sides_;
  std::vector<Contribution> contributions_;  ///< in the order in which assemble_matrix() visits them
  std::vector<Lane8> displacements_;
  double dt_ = 0, newton_residual_ = 0;
  bool balanced_ = false;
  MomentumBalance balance_;
  std::vector<Lane8> balancing_;  ///< (M + K)^-1 g of every segment
};

/// Moves a free segment by u (lanes 0..2) and phi (lanes 3..5) in its own frame; does not move a static segment.
void displace(Rod& rod, std::size_t segment, const Lane8& displacement);

/// The update: lambda += dlambda, and displaces every free segment.
void displace(Rod& rod, const std::vector<Lane8>& displacements, const VectorX& delta_lambda);

}  // namespace rodsweep
