// The CG ratio of a guess on stored simulations: how many iterations it saves, rather than how small its loss is.
//
// Every stored system of a first Newton iteration is assembled again and solved with CG (jacobi, true residual), the
// guess reading the exact history. Per simulation: the sum of iterations with the guess over the sum from zero, which
// is what MeasuredSolve counts as a task's cg_ratio of the first Newton iteration. Needs PETSc.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "network/encoding/stored_simulation.hpp"
#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

class ValidationRatio {
 public:
  static constexpr std::size_t tolerance_count = 4;
  static const std::vector<double>& tolerances();  ///< 1e-1 ... 1e-4
  /// NaN where CG from zero takes no iterations at all, infinite where it cannot start from a guess.
  using Ratios = std::array<double, tolerance_count>;
  static Ratios unmeasured();  ///< NaN everywhere
  /// Makes the guess for the simulation's scene, whose rods the solves move.
  using MakeGuess = std::function<std::unique_ptr<InitialGuess>(const Scene&, const StoredSimulation&)>;

  /// Counts the iterations from zero.
  explicit ValidationRatio(std::vector<StoredSimulation> simulations);

  std::size_t simulations() const { return simulations_.size(); }
  Ratios measure(std::size_t simulation, const MakeGuess& make_guess) const;

 private:
  using Iterations = std::array<double, tolerance_count>;
  static Iterations count(const StoredSimulation& simulation, const MakeGuess& make_guess);

  std::vector<StoredSimulation> simulations_;
  std::vector<Iterations> from_zero_;
};

}  // namespace rodsweep
