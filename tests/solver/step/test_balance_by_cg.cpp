// Steps that keep the balance of momentum, with CG instead of the direct solve.
#include <catch2/catch.hpp>
#include <optional>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/guess/extrapolation_guess.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_balance_by_cg {

TEST_CASE("cg from a history reaches the direct solve's balanced steps") {
  const Scene start = build_scene(test::bending_rod(15));
  Simulation direct(start, {0.02, 20, 1e-12}, 1e-9);
  direct.run(20);
  const Scene& exact = direct.scene;

  Scene scene = start;
  ExtrapolationGuess guess(scene, 20, 3);
  std::optional<ConjugateGradient> cg;
  SolveBy solve([&](const LinearSystem& system, const SolvePosition& at, VectorX& x) {
    if (!cg) cg.emplace(system.matrix(), CgSettings{});
    cg->matrix_changed();
    const bool nonzero = guess.propose(system, at, x).nonzero;
    const CgReport report = cg->solve(system.rhs(), x, nonzero, 1e-8, system.rhs().norm());
    guess.accept(system, at, x);
    return report.outcome;
  });
  LinearProjection by_cg(scene, solve, 1e-9);
  TimeStepper stepper(scene, {0.02, 20, 1e-12});
  for (int step = 0; step < 20; ++step) REQUIRE(stepper.step(by_cg).outcome == SolveOutcome::converged);
  for (int s = 0; s < 15; ++s) CHECK((scene.rods[0].position[s] - exact.rods[0].position[s]).norm() < 1e-7);
}

}  // namespace rodsweep::test_balance_by_cg
