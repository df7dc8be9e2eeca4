// The CG ratio of a guess on stored simulations: it measures the saved iterations, unlike the loss.
//
// Each stored system of a first Newton iteration is assembled again and solved with CG (jacobi, true residual). The
// guess receives the exact history. Ratio per simulation = sum of iterations with the guess / sum from zero, which
// equals the cg_ratio of MeasuredSolve for first Newton iterations. Needs PETSc.
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
  /// NaN if CG from zero takes no iterations; infinite if a guess has an invalid first residual.
  using Ratios = std::array<double, tolerance_count>;
  static Ratios unmeasured();  ///< NaN everywhere
  /// Constructs the guess for the simulation's scene; the replay moves the rods of this scene.
  using MakeGuess = std::function<std::unique_ptr<InitialGuess>(const Scene&, const StoredSimulation&)>;

  /// Also counts the iterations from zero.
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
