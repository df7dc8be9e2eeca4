// The direct solution of A d = b by condensation: struts are eliminated exactly (condensation.hpp), and the matrix S of
// the crossings is factorised (block_factor.hpp). S has fewer rows than A, and less fill.
//
// Stiff joints hide what soft ones carry: a solution loses digits in the ratio of the largest compliance to the smallest.
// The product A d shows how many. A solution with |b - A d| <= 1e-12 |b| is accepted. Others are corrected by the
// solution for b - A d (iterative refinement: Wilkinson 1963), until
//
//   |b - A d| <= 1e-15 a |d|,   a: the largest diagonal entry of A.
//
// Up to a ratio of 1e6 one correction suffices, and leaves a residual as small as that of the factor of A. Nothing
// allocates after the first solution; the same system gives the same bits.
#pragma once

#include "solver/factor/block_factor.hpp"
#include "solver/factor/condensation.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

/// Whether no compliance of the rod's joints is more than 1e6 times as large as another. Physical stretch is within
/// that on all but extremely slender rods (the ratio is about 4 l^2 / r^2), nearly inextensible stretch is not.
bool can_be_condensed(const Rod& rod);

/// The cheapest factorisation of S.
EliminationPlan plan_crossings(const Condensation& condensation);

/// Of condensing, expanding and the product with A, in the unit of EliminationPlan::cost.
double cost_of_condensing(const Rod& rod);

class CondensedFactor {
 public:
  /// `plan` is that of the crossings. Throws FactorTooLarge.
  CondensedFactor(Condensation condensation, EliminationPlan plan);

  /// Solves the assembled system of the rod. Returns false, with an invalid d, if the solution is not accepted after
  /// `most_corrections`, which includes that a matrix is not positive definite.
  bool solve(const Rod& rod, const LinearSystem& system, VectorX& d);

  /// As in DirectFactor.
  bool factorise(const Rod& rod, const LinearSystem& system);
  void substitute(VectorX& x);

  /// Finds (M + J^T alpha~^-1 J)^-1 for forces and torques on one segment, for motion_of(): as in Condensation.
  void load(int segment, const Lane8 (&force)[6]);
  void motion_of(int segment, Lane8 (&out)[6]) const { condensation_.motion_of(segment, loaded_, out); }

  int corrections() const { return corrections_; }  ///< of the last solution

  static constexpr int most_corrections = 3;

 private:
  void solve(const VectorX& r, VectorX& d);

  Condensation condensation_;
  BlockFactor factor_;
  VectorX crossings_, residual_, correction_;
  int corrections_ = 0;
  std::vector<Lane8> loaded_;  ///< motions of the crossings by the load
};

}  // namespace rodsweep
