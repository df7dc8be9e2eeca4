#include "runner/training/validation_ratio.hpp"

#include <limits>

#include "runner/plan/plan.hpp"
#include "solver/cg/conjugate_gradient.hpp"
#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {
namespace {

/// Solver and solution vector of one rod.
struct RodSolver {
  ConjugateGradient cg;
  VectorX x;

  explicit RodSolver(const LinearSystem& system)
      : cg(system.matrix(), {Preconditioner::jacobi, Norm::true_residual, 0}), x(VectorX::Zero(system.rhs().size())) {
    cg.keep_history(true);
  }
};

}  // namespace

const std::vector<double>& ValidationRatio::tolerances() {
  static const std::vector<double> chosen(tolerance_ladder().begin(), tolerance_ladder().begin() + tolerance_count);
  return chosen;
}

ValidationRatio::Ratios ValidationRatio::unmeasured() {
  Ratios ratios;
  ratios.fill(std::numeric_limits<double>::quiet_NaN());
  return ratios;
}

ValidationRatio::ValidationRatio(std::vector<StoredSimulation> simulations) : simulations_(std::move(simulations)) {
  for (const StoredSimulation& simulation : simulations_)
    from_zero_.push_back(
        count(simulation, [](const Scene&, const StoredSimulation&) { return std::make_unique<ZeroGuess>(); }));
}

ValidationRatio::Ratios ValidationRatio::measure(std::size_t simulation, const MakeGuess& make_guess) const {
  const Iterations with_guess = count(simulations_[simulation], make_guess);
  const Iterations& from_zero = from_zero_[simulation];
  Ratios ratios = unmeasured();
  for (std::size_t t = 0; t < tolerance_count; ++t)
    if (from_zero[t] > 0) ratios[t] = with_guess[t] / from_zero[t];
  return ratios;
}

ValidationRatio::Iterations ValidationRatio::count(const StoredSimulation& simulation, const MakeGuess& make_guess) {
  Replay replay(simulation);
  const std::unique_ptr<InitialGuess> guess = make_guess(replay.scene(), simulation);
  std::vector<RodSolver> solvers;
  for (const LinearSystem& system : replay.systems()) solvers.emplace_back(system);
  Iterations sums{};
  std::array<std::int16_t, tolerance_count> reached{};
  replay.run([&](const StoredSystem& stored, const Rod&, const LinearSystem& system) {
    if (stored.at.newton > 0) return;
    RodSolver& of = solvers[static_cast<std::size_t>(stored.at.rod)];
    guess->prepare(stored.at);
    const Proposal proposal = guess->propose(system, stored.at, of.x);
    if (system.largest_rhs() > rounding_level) {
      of.cg.matrix_changed();
      const double reference = of.cg.norm_of(system.rhs());
      const CgReport report = of.cg.solve(system.rhs(), of.x, proposal.start(), tolerances().back(), reference);
      iterations_to(of.cg.history(), reference, tolerances(), reached.data());
      if (of.cg.history().empty())
        sums.fill(std::numeric_limits<double>::infinity());  // the first residual is not a number
      for (std::size_t t = 0; t < tolerance_count; ++t) sums[t] += reached[t] >= 0 ? reached[t] : report.iterations;
    }
    guess->accept(system, stored.at, stored.solution);
  });
  return sums;
}

}  // namespace rodsweep
