// Recycled Ritz vectors against the eigenvalues of the preconditioned matrix.
#include <Eigen/Eigenvalues>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/guess/extrapolation_guess.hpp"
#include "solver/guess/ritz_guess.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_ritz {

using test::MatrixX, test::OneRod;

RitzGuess recycling(const Scene& scene, int size, int collected, int lag_steps = 0) {
  return RitzGuess(scene, std::make_unique<ExtrapolationGuess>(scene, 1, 1), size, collected, lag_steps);
}

/// Solves the system at a step and returns the iterations.
int solve(const OneRod& one, RitzGuess& guess, int step, double tolerance = 1e-8) {
  ConjugateGradient cg(one.system.matrix(), {});
  VectorX x(one.size());
  const Proposal proposal = guess.propose(one.system, {step, 0, 0}, x);
  if (proposal.residual)
    CHECK((one.system.rhs() - one.a * x - *proposal.residual).norm() < 1e-10 * one.system.rhs().norm());
  const CgReport report =
      cg.solve(one.system.rhs(), x, proposal.start(), tolerance, one.system.rhs().norm(), guess.deflation());
  CHECK(report.outcome == SolveOutcome::converged);
  CHECK((one.system.rhs() - one.a * x).norm() < 2 * tolerance * one.system.rhs().norm());
  guess.accept(one.system, {step, 0, 0},
               VectorX::Zero(one.size()));  // the next solve starts from the Ritz vectors alone
  return report.iterations;
}

/// Ascending eigenvalues of D^-1 A.
VectorX eigenvalues(const OneRod& one) {
  const VectorX s = one.a.diagonal().cwiseSqrt().cwiseInverse();
  return Eigen::SelfAdjointEigenSolver<MatrixX>(s.asDiagonal() * one.a * s.asDiagonal()).eigenvalues();
}

TEST_CASE("Ritz values fall to the smallest eigenvalues of the preconditioned matrix, from above") {
  const OneRod one;
  const VectorX exact = eigenvalues(one);
  RitzGuess guess = recycling(one.scene, 6, 12);
  std::vector<double> last(6, 1e300);
  for (int step = 0; step < 12; ++step) {
    solve(one, guess, step, 1e-12);
    const std::vector<double>& values = guess.ritz_values(0);
    REQUIRE(values.size() == 6);
    for (int k = 0; k < 6; ++k) {
      CHECK(values[k] >= exact[k] * (1 - 1e-8));
      CHECK(values[k] <= last[k] * (1 + 1e-6));
    }
    last = values;
  }
  for (int k = 0; k < 3; ++k) CHECK(last[k] == Approx(exact[k]).epsilon(1e-2));
}

TEST_CASE("CG needs fewer iterations with recycled Ritz vectors, and fewer with more of them") {
  const OneRod one;
  int iterations[2];
  for (const int size : {4, 12}) {
    RitzGuess guess = recycling(one.scene, size, 20);
    const int first = solve(one, guess, 0);
    int step = 1;
    for (; step < 8; ++step) solve(one, guess, step);
    iterations[size == 12] = solve(one, guess, step);
    CHECK(iterations[size == 12] < first);
  }
  CHECK(iterations[1] < iterations[0]);
}

TEST_CASE("Ritz vectors serve the given number of time steps") {
  const OneRod one;
  RitzGuess guess = recycling(one.scene, 3, 8, 4);
  std::vector<double> renewed;
  for (int step = 0; step < 9; ++step) {
    const std::vector<double> before = guess.ritz_values(0);
    solve(one, guess, step);
    if (guess.ritz_values(0) != before) renewed.push_back(step);
  }
  CHECK(renewed == std::vector<double>{0, 4, 8});
}

TEST_CASE("more vectors than unknowns span them all, and nothing is left to CG") {
  OneRod one;
  one.scene = test::scene_of(test::random_rod(test::tree(1, 1), {0}, 1));
  one.system = test::assembled(one.scene.rods[0]);
  one.a = one.system.matrix().dense();
  RitzGuess guess = recycling(one.scene, 40, 40);
  for (int step = 0; step < 3; ++step) solve(one, guess, step, 1e-12);
  CHECK(static_cast<int>(guess.ritz_values(0).size()) <= one.size());
  CHECK(solve(one, guess, 3) == 0);
}

}  // namespace rodsweep::test_ritz
