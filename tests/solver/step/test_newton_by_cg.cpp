// Newton's iterations by CG: Eisenstat and Walker's forcing terms, and steps that keep the balance of momentum.
#include <optional>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/guess/initial_guess.hpp"
#include "solver/step/forcing_terms.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_newton_by_cg {

TEST_CASE("forcing terms follow the square of what the last iteration achieved, from the first one given") {
  ForcingTerms forcing(2, 0.5, 0);
  CHECK(forcing.next(0, 0, 1, 1) == 0.5);
  CHECK(forcing.next(0, 1, 0.1, 0.1) == Approx(0.9 * 0.25));    // not 0.009, since the safeguard 0.9 0.5^2 exceeds 0.1
  CHECK(forcing.next(0, 2, 0.02, 0.02) == Approx(0.9 * 0.04));  // the safeguard 0.9 0.225^2 is below 0.1
  CHECK(forcing.next(0, 3, 0.06, 0.06) == 0.5);                 // the residual grew: at most the first term
  CHECK(forcing.next(1, 1, 0.001, 0.001) == 0.5);               // another rod without history
  CHECK(forcing.next(0, 0, 1e-5, 1e-5) == 0.5);                 // another step
}

TEST_CASE("no solve does more than Newton's tolerance asks for") {
  ForcingTerms forcing(1, 0.1, 1e-6);
  CHECK(forcing.next(0, 0, 1, 1) == 0.1);
  CHECK(forcing.next(0, 1, 1e-3, 1e-3) == Approx(5e-4));  // half of 1e-6 over 1e-3, instead of 9e-7
  CHECK(forcing.next(0, 2, 1e-6, 1e-7) == 0.1);           // already converged
}

struct Counts {
  int solves = 0, iterations = 0;
};

TEST_CASE(
    "with forcing terms Newton converges in fewer iterations than to their first tolerance, with fewer of CG's "
    "than to a tight one") {
  const auto run = [](double tolerance, bool forced) {  // CG from zero, with forcing terms or with one tolerance
    Scene scene = build_scene(test::bending_rod(20));
    ForcingTerms forcing(1, tolerance, 1e-9);
    Counts counts;
    SolveBy solve([&](const LinearSystem& system, const SolvePosition& at, VectorX& x) {
      const double norm = system.rhs().norm();
      const double eta = forced ? forcing.next(at.rod, at.newton, norm, system.newton_residual()) : tolerance;
      ConjugateGradient cg(system.matrix(), {});
      const CgReport report = cg.solve(system.rhs(), x.setZero(), false, eta, norm);
      counts.iterations += report.iterations;
      ++counts.solves;
      return report.outcome;
    });
    LinearProjection projection(scene, solve);
    TimeStepper stepper(scene, {0.02, 40, 1e-9});
    for (int step = 0; step < 20; ++step) {
      REQUIRE(stepper.step(projection).outcome == SolveOutcome::converged);
      CHECK(newton_residual(scene.rods[0], 0.02) < 1e-9);
    }
    return counts;
  };
  const Counts forced = run(0.1, true), loose = run(0.1, false), tight = run(1e-6, false);
  CHECK(forced.solves < 0.7 * loose.solves);
  CHECK(forced.iterations < 0.95 * tight.iterations);
}

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

}  // namespace rodsweep::test_newton_by_cg
