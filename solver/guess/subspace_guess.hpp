// Projected initial guesses: the best approximation of the solution within the span of earlier ones of the same rod
// and Newton iteration (Fischer 1998, Comput. Methods Appl. Mech. Engrg. 163), for the current matrix
// (galerkin_projection.hpp). Newer solutions go before older ones.
//
// With deflation, CG also projects this span out of every residual, so it does not find these components again. They
// belong to the small eigenvalues, which CG finds last.
#pragma once

#include <vector>

#include "solver/guess/galerkin_projection.hpp"
#include "solver/guess/history_guess.hpp"

namespace rodsweep {

struct StoredSolutions : RecentSteps {
  StoredVectors solutions;
  void keep(const VectorX& solution) { solutions.set(newest, solution); }
};

class SubspaceGuess : public HistoryGuess<StoredSolutions> {
 public:
  enum class Window {
    restarted,  ///< `fischer`: solutions are collected until there are `size`, then the newest starts a new set
    sliding  ///< `subspace`: the newest `size` solutions, the space of a proper orthogonal decomposition with all modes
  };
  enum class Use { guess, guess_and_deflation };
  /// `size` of at least 1. As with extrapolation, a time step without a solution starts the history again.
  SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window, Use use = Use::guess);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
  Deflation* deflation() override { return deflating_ ? &projection_ : nullptr; }

 private:
  Window window_;
  std::vector<StoredVectors> products_;  ///< per rod: A V; empty unless deflating
  Eigen::VectorXi order_;                ///< of a history's solutions, the newest first
  GalerkinProjection projection_;
  bool deflating_ = false;  ///< the system last proposed for
};

}  // namespace rodsweep
