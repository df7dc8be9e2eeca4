// A guess by regression on earlier right-hand sides: exact if possible, else least squares; no matrix product.
#include <cmath>
#include <vector>

#include "solver/guess/regression_guess.hpp"
#include "solver/guess/wrapped_guess.hpp"
#include "solver/step/projection.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_regression_guess {

using test::MatrixX;

/// Systems with one matrix; their right-hand sides -C - alpha~ lambda depend on the multipliers.
struct OneMatrix : test::OneRod {
  DirectSolve direct{scene};
  test::Random random;

  explicit OneMatrix(unsigned seed = 0) : random(seed) {}
  VectorX draw() { return random.entries(size()); }

  const LinearSystem& with(const VectorX& lambda) {
    scene.rods[0].lambda = lambda;
    system.assemble(scene.rods[0], 0.02);
    return system;
  }
  VectorX solution() {
    VectorX out = VectorX::Zero(size());
    REQUIRE(direct.solve(system, {}, 0, out) == SolveOutcome::converged);
    return out;
  }
  /// Proposes at a step with these multipliers, then accepts the solution.
  void pass(RegressionGuess& guess, int step, const VectorX& lambda) {
    VectorX x0(size());
    guess.propose(with(lambda), {step, 0, 0}, x0);
    guess.accept(system, {step, 0, 0}, solution());
  }
};

TEST_CASE("a right-hand side that the last ones make up has its solution found, without a product with A") {
  OneMatrix one(3);
  RegressionGuess guess(one.scene, 1, 3, 0);
  std::vector<VectorX> lambda;
  for (int step = 0; step < 5; ++step) {  // the first two leave the window
    lambda.push_back(one.draw());
    one.pass(guess, step, lambda.back());
  }
  VectorX x0(one.size());
  const Proposal proposal = guess.propose(one.with(0.5 * lambda[4] - 1.5 * lambda[3] + 2 * lambda[2]), {5, 0, 0}, x0);
  CHECK(proposal.nonzero);
  CHECK(proposal.products == 0);
  CHECK((x0 - one.solution()).norm() < 1e-9 * x0.norm());
  guess.propose(one.with(lambda[1]), {5, 0, 0}, x0);
  CHECK((x0 - one.solution()).norm() > 1e-3 * x0.norm());
}

TEST_CASE("what the last right-hand sides leave of today's is orthogonal to them, weighted by the diagonal of A") {
  OneMatrix one(5);
  RegressionGuess guess(one.scene, 1, 4, 0);
  std::vector<VectorX> stored;
  for (int step = 0; step < 4; ++step) {
    one.pass(guess, step, one.draw());
    stored.push_back(one.system.rhs());
  }
  VectorX x0(one.size());
  guess.propose(one.with(one.draw()), {4, 0, 0}, x0);
  const MatrixX a = one.system.matrix().dense();
  const VectorX left = (one.system.rhs() - a * x0).cwiseQuotient(a.diagonal());
  for (const VectorX& b : stored) CHECK(std::abs(left.dot(b)) < 1e-9 * left.norm() * b.norm());
  CHECK(left.dot(one.system.rhs()) > 1e-3 * left.norm() * one.system.rhs().norm());
}

TEST_CASE("noise in the stored solutions is not blown up by coefficients of opposite signs") {
  OneMatrix one(7);
  const double noise = 1e-2;
  RegressionGuess trusting(one.scene, 1, 2, 0), damped(one.scene, 1, 2, noise);
  const VectorX lambda = one.draw(), change = 1e-4 * one.draw();
  VectorX x0(one.size());
  for (int step = 0; step < 2; ++step) {
    one.with(lambda + step * change);
    const VectorX exact = one.solution(), found = exact + noise * exact.norm() / std::sqrt(one.size()) * one.draw();
    for (RegressionGuess* guess : {&trusting, &damped}) {
      guess->propose(one.system, {step, 0, 0}, x0);
      guess->accept(one.system, {step, 0, 0}, found);
    }
  }
  one.with(lambda + 50 * change);  // exactly 50 x2 - 49 x1
  const VectorX exact = one.solution();
  trusting.propose(one.system, {2, 0, 0}, x0);
  CHECK((x0 - exact).norm() > 20 * noise * exact.norm());
  damped.propose(one.system, {2, 0, 0}, x0);
  CHECK((x0 - exact).norm() < 2 * noise * exact.norm());
}

TEST_CASE("a regression combines totals as the first right-hand sides of their steps make up today's") {
  Scene scene = build_scene(test::bending_rod(6));
  Rod& rod = scene.rods[0];
  LinearSystem system(rod);
  test::Random random(4);
  TotalsGuess guess(scene, std::make_unique<RegressionGuess>(scene, 2, 2, 0));
  VectorX x0(30), lambda[2], first[2], later[2];
  for (int step = 0; step < 2; ++step) {
    rod.lambda = lambda[step] = random.entries(30);
    system.assemble(rod, 0.02);
    first[step] = random.entries(30);
    later[step] = random.entries(30);
    guess.prepare({step, 0, 0});
    guess.propose(system, {step, 0, 0}, x0);
    guess.accept(system, {step, 0, 0}, first[step]);
    rod.lambda = random.entries(30);
    system.assemble(rod, 0.02);
    guess.prepare({step, 1, 0});
    guess.propose(system, {step, 1, 0}, x0);
    guess.accept(system, {step, 1, 0}, later[step]);
  }
  rod.lambda = 3 * lambda[0] - 2 * lambda[1];  // b is -C - alpha~ lambda with C = 0 in all steps
  system.assemble(rod, 0.02);
  guess.prepare({2, 0, 0});
  guess.propose(system, {2, 0, 0}, x0);
  CHECK((x0 - (3 * (first[0] + later[0]) - 2 * (first[1] + later[1]))).norm() < 1e-9 * x0.norm());
}

}  // namespace rodsweep::test_regression_guess
