// Deflated CG with known spectra and with stored solutions.
#include <Eigen/Eigenvalues>
#include <cmath>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/guess/subspace_guess.hpp"
#include "solver/guess/wrapped_guess.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_deflation {

using test::MatrixX, test::OneRod;

SubspaceGuess deflating(const Scene& scene, int size) {
  return SubspaceGuess(scene, 1, size, SubspaceGuess::Window::sliding, SubspaceGuess::Use::guess_and_deflation);
}

CgReport solve(const OneRod& one, VectorX& x, bool nonzero, double tolerance, Deflation* deflation) {
  ConjugateGradient cg(one.system.matrix(), {});
  return cg.solve(one.system.rhs(), x, nonzero, tolerance, one.system.rhs().norm(), deflation);
}

TEST_CASE("guesses that use a deflating guess deflate when they use it") {
  OneRod one;
  VectorX x0(one.size());
  const auto inner = [&] {
    auto guess = std::make_unique<SubspaceGuess>(deflating(one.scene, 3));
    guess->accept(one.system, {0, 0, 0}, one.exact);
    return guess;
  };
  FirstGuess first(inner());
  CHECK(first.propose(one.system, {1, 0, 0}, x0).nonzero);
  CHECK(first.deflation() != nullptr);
  CHECK_FALSE(first.propose(one.system, {1, 1, 0}, x0).nonzero);
  CHECK(first.deflation() == nullptr);
  GuardedGuess kept(one.scene, inner(), 1), refused(one.scene, inner(), 1e-30);
  CHECK(kept.propose(one.system, {1, 0, 0}, x0).nonzero);
  CHECK(kept.deflation() != nullptr);
  CHECK_FALSE(refused.propose(one.system, {1, 0, 0}, x0).nonzero);
  CHECK(refused.deflation() == nullptr);
}

TEST_CASE(
    "a deflating guess starts where subspace does, and projects to what is A-orthogonal to the stored solutions") {
  OneRod one;
  test::Random random(3);
  SubspaceGuess guess = deflating(one.scene, 4);
  SubspaceGuess subspace(one.scene, 1, 4, SubspaceGuess::Window::sliding);
  std::vector<VectorX> stored;
  for (int step = 0; step < 6; ++step) {  // the first two leave the window
    stored.push_back(one.exact + 2 * random.entries(one.size()).cwiseProduct(one.exact));
    guess.accept(one.system, {step, 0, 0}, stored.back());
    subspace.accept(one.system, {step, 0, 0}, stored.back());
  }
  VectorX x0(one.size()), expected(one.size());
  const Proposal proposal = guess.propose(one.system, {6, 0, 0}, x0);
  CHECK(proposal.products == 4);
  subspace.propose(one.system, {6, 0, 0}, expected);
  CHECK((x0 - expected).norm() < 1e-12 * expected.norm());
  VectorX z = random.entries(one.size());
  const VectorX before = z;
  REQUIRE(guess.deflation() != nullptr);
  // For a residual with a part in V, complete() solves for that part, and reduce() removes it from what M sees.
  const VectorX r = random.entries(one.size());
  VectorX reduced = r;
  guess.deflation()->reduce(reduced.data());
  guess.deflation()->complete(z.data());
  const auto cosine = [&](const VectorX& u, const VectorX& v) {
    return std::abs(u.dot(one.a * v)) / std::sqrt(u.dot(one.a * u) * v.dot(one.a * v));
  };
  for (int step = 2; step < 6; ++step) {
    const VectorX& v = stored[step];
    CHECK(std::abs(v.dot(reduced)) < 1e-9 * v.norm() * r.norm());
    CHECK(v.dot(one.a * z - r) == Approx(0).margin(1e-9 * v.norm() * (one.a * z).norm()));  // V^T A z = V^T r
  }
  CHECK(cosine(z, before) > 0.1);
  VectorX again = z;
  guess.deflation()->complete(again.data());
  CHECK((again - z).norm() < 1e-9 * z.norm());  // a projection
}

TEST_CASE("CG deflated by the modes that it finds last ends in fewer iterations, with the same solution") {
  OneRod one;
  // Eigenvectors of D^-1/2 A D^-1/2, the matrix with Jacobi's preconditioner.
  const VectorX s = one.a.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixX> modes(s.asDiagonal() * one.a * s.asDiagonal());
  SubspaceGuess guess = deflating(one.scene, 12);
  for (int k = 0; k < 12; ++k) guess.accept(one.system, {k, 0, 0}, s.cwiseProduct(modes.eigenvectors().col(k)));
  VectorX plain = VectorX::Zero(one.size()), x0(one.size());
  const CgReport without = solve(one, plain, false, 1e-8, nullptr);
  REQUIRE(guess.propose(one.system, {12, 0, 0}, x0).nonzero);
  VectorX deflated = x0, undeflated = x0;
  const CgReport with = solve(one, deflated, true, 1e-8, guess.deflation());
  CHECK(with.outcome == SolveOutcome::converged);
  CHECK(with.iterations < 0.8 * without.iterations);
  CHECK((one.system.rhs() - one.a * deflated).norm() < 1e-7 * one.system.rhs().norm());
  // Without the projection, rounding brings the deflated part back. One iteration more or less is rounding.
  CHECK(with.iterations <= solve(one, undeflated, true, 1e-8, nullptr).iterations + 1);
}

TEST_CASE("deflated by solutions that are nearly the same, CG reaches what its residual says") {
  OneRod one;
  test::Random random(11);
  const VectorX exact = one.exact;
  for (const double apart : {1e-2, 1e-4, 1e-6, 1e-8}) {
    INFO(apart);
    SubspaceGuess guess = deflating(one.scene, 10);
    for (int k = 0; k < 10; ++k)
      guess.accept(one.system, {k, 0, 0},
                   0.9 * exact + std::pow(apart, 1 + k % 3) * random.entries(one.size()).cwiseProduct(exact));
    VectorX x0(one.size()), plain = VectorX::Zero(one.size());
    REQUIRE(guess.propose(one.system, {10, 0, 0}, x0).nonzero);
    const CgReport with = solve(one, x0, true, 1e-9, guess.deflation());
    CHECK(with.outcome == SolveOutcome::converged);
    CHECK(with.iterations <= solve(one, plain, false, 1e-9, nullptr).iterations);
    CHECK((one.system.rhs() - one.a * x0).norm() < 2e-9 * one.system.rhs().norm());
  }
}

}  // namespace rodsweep::test_deflation
