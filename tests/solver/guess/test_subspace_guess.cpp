// Projected guesses: optimal in the span of earlier solutions, for the current matrix.
#include <cmath>

#include "solver/guess/extrapolation_guess.hpp"
#include "solver/guess/subspace_guess.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_subspace_guess {

using Window = SubspaceGuess::Window;
using test::OneRod;

/// e^T A v / (|e|_A |v|_A), where e is the error of x0.
double error_along(const OneRod& one, const VectorX& x0, const VectorX& v) {
  const VectorX e = x0 - one.exact;
  return e.dot(one.a * v) / std::sqrt(e.dot(one.a * e) * v.dot(one.a * v));
}

TEST_CASE(
    "the error of a projected guess is orthogonal in energy to every stored solution, whatever matrix they were of") {
  OneRod one;
  for (const Window window : {Window::restarted, Window::sliding}) {
    SubspaceGuess guess(one.scene, 1, 4, window);
    test::Random random(3);
    VectorX x0 = VectorX::Zero(one.size());
    std::vector<VectorX> stored;
    for (int step = 0; step < 4; ++step) {
      stored.push_back(one.exact + 3 * random.entries(one.size()).cwiseProduct(one.exact));
      guess.accept(one.system, {step, 0, 0}, stored.back());
      const Proposal proposal = guess.propose(one.system, {step + 1, 0, 0}, x0);
      CHECK(proposal.nonzero);
      CHECK(proposal.products == step + 1);
      for (const VectorX& v : stored) CHECK(std::abs(error_along(one, x0, v)) < 1e-10);
    }
  }
}

TEST_CASE("a solution within the span is found, also where stored solutions are nearly the same") {
  OneRod one;
  SubspaceGuess guess(one.scene, 1, 3, Window::sliding);
  const VectorX other = test::Random(5).entries(one.size());
  VectorX x0 = VectorX::Zero(one.size());
  guess.accept(one.system, {0, 0, 0}, one.exact + other);
  guess.accept(one.system, {1, 0, 0}, other);
  guess.accept(one.system, {2, 0, 0}, other * (1 + 1e-15));
  REQUIRE(guess.propose(one.system, {3, 0, 0}, x0).nonzero);
  CHECK(test::energy_error(one.a, x0, one.exact) < 1e-6);
}

TEST_CASE("fischer starts again with the newest solution when full, subspace forgets the oldest") {
  OneRod one;
  test::Random random(7);
  std::vector<VectorX> stored;
  SubspaceGuess fischer(one.scene, 1, 3, Window::restarted), subspace(one.scene, 1, 3, Window::sliding);
  for (int step = 0; step < 4; ++step) {
    stored.push_back(random.entries(one.size()));
    fischer.accept(one.system, {step, 0, 0}, stored.back());
    subspace.accept(one.system, {step, 0, 0}, stored.back());
  }
  VectorX x0 = VectorX::Zero(one.size());
  CHECK(fischer.propose(one.system, {4, 0, 0}, x0).products == 1);
  CHECK(std::abs(error_along(one, x0, stored[3])) < 1e-10);
  CHECK(std::abs(error_along(one, x0, stored[2])) > 1e-6);
  CHECK(subspace.propose(one.system, {4, 0, 0}, x0).products == 3);
  for (const int kept : {1, 2, 3}) CHECK(std::abs(error_along(one, x0, stored[kept])) < 1e-10);
  CHECK(std::abs(error_along(one, x0, stored[0])) > 1e-6);
}

}  // namespace rodsweep::test_subspace_guess
