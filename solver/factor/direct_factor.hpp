// The direct solution of a rod's systems by the cheaper of two factors: that of A (block_factor.hpp), or of the matrix
// that is left after the elimination of struts (condensed_factor.hpp).
//
// The construction chooses by the compliances and by the expected number of operations, so all machines choose alike.
// Chains, trees and rings take the factor of A; lattices that stretch physically are condensed. A condensed system whose
// solution is not accurate, or whose matrix is not positive definite, is solved by the factor of A as well. The first
// such system allocates it; nothing else allocates after the first solution. The same system gives the same bits.
#pragma once

#include <optional>

#include "solver/factor/condensed_factor.hpp"

namespace rodsweep {

class DirectFactor {
 public:
  /// Throws FactorTooLarge if the factor of A needs more memory than allowed.
  explicit DirectFactor(const Rod& rod);

  /// Solves the assembled system of the rod. x is valid only if the outcome is `converged`.
  SolveOutcome solve(const Rod& rod, const LinearSystem& system, VectorX& x);

  /// Factorises for substitute(), which solves with the factor as it is and uses the rod and the system. Returns false
  /// if a matrix is not positive definite.
  bool factorise(const Rod& rod, const LinearSystem& system);
  void substitute(VectorX& x);

  /// The factor of the last factorise(): one of the two.
  CondensedFactor* condensed_factor() { return is_condensed_ ? &*condensed_ : nullptr; }
  BlockFactor* whole_factor() { return is_condensed_ ? nullptr : &*whole_; }

  bool condenses() const { return condensed_.has_value(); }
  bool has_whole() const { return whole_.has_value(); }  ///< whether the factor of A was needed

 private:
  std::optional<CondensedFactor> condensed_;
  std::optional<BlockFactor> whole_;
  bool is_condensed_ = false;  ///< the last factorise()
};

}  // namespace rodsweep
