// Polynomial extrapolation in time through the last solutions of a Newton iteration,
//   previous  x1,      linear  2 x1 - x2,      quadratic  3 x1 - 3 x2 + x3        (x1 the newest),
// with fewer terms, or zero, if consecutive steps have no solution.
#pragma once

#include <vector>

#include "solver/guess/history_guess.hpp"

namespace rodsweep {

struct LastSolutions : RecentSteps {
  std::vector<VectorX> solutions;
  void keep(const VectorX& solution) { solutions[at(newest)] = solution; }
};

class ExtrapolationGuess : public HistoryGuess<LastSolutions> {
 public:
  /// `terms`: 1 previous, 2 linear, 3 quadratic.
  ExtrapolationGuess(const Scene& scene, int newton_iterations, int terms);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
};

}  // namespace rodsweep
