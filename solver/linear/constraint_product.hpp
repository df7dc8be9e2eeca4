// y = A x without A: y = J (M^-1 (J^T x)) + alpha~ x, from the turns of joints and the arms of their segments.
//
// J of a joint follows from d, its half turn H, the arms and 1/l (linearization.hpp): about twenty numbers, while A has
// four or five blocks of 36 in a row. If the blocks do not fit into the near caches, their product is bound by memory.
// Both passes process as many joints at once as a register has lanes. Several joints share a segment, so impulses and
// motions of segments are stored one after the other. Equal to BlockMatrix::multiply() up to rounding. Allocates
// nothing after construction. Not safe for concurrent products on one object: they share a scratch array.
#pragma once

#include <vector>

#include "solver/rod/linearization.hpp"

namespace rodsweep {

class ConstraintProduct {
 public:
  /// Systems with at least this many blocks of A use this product: a chain of 200 joints, a lattice of 160
  /// (tests/bench/bench_preconditioners.cpp).
  static constexpr int least_blocks = 600;

  explicit ConstraintProduct(const Rod& rod);

  /// Uses the rod's positions, at which `linearization` was evaluated, and the mobilities of its segments.
  void update(const Rod& rod, const Linearization& linearization, double inverse_dt2);

  /// `x` and `y` hold six doubles per joint and don't overlap.
  void multiply(const double* x, double* y) const;

 private:
  /// As many joints as a register has lanes.
  struct Group {
    JointTurn<Lane> turn;
    JointShape<Lane> shape;
  };
  struct Ends {
    int a, b;
  };
  void find_impulses(const double* x) const;
  void find_changes(const double* x, double* y) const;

  std::vector<Group> groups_;
  JointKinks kinks_;               ///< of the groups
  std::vector<Ends> ends_;         ///< segments of every joint
  std::vector<Lane8> mobility_;    ///< M^-1 of every segment, zero if static
  VectorX softness_;               ///< alpha~
  mutable std::vector<Lane8> at_;  ///< impulses, then motions, of every segment
};

}  // namespace rodsweep
