// The guesses: their proposals, their fallback to zero, and the state that they must not keep.
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "solver/guess/extrapolation_guess.hpp"
#include "solver/guess/initial_guess.hpp"
#include "solver/guess/oracle_guess.hpp"
#include "solver/guess/regression_guess.hpp"
#include "solver/guess/subspace_guess.hpp"
#include "solver/guess/wrapped_guess.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_initial_guess {

using test::MatrixX;

constexpr auto white = OracleGuess::Error::white, smooth = OracleGuess::Error::smooth;

/// Two rods of different size and their assembled systems.
struct TwoRods {
  Scene scene;
  std::vector<LinearSystem> systems;

  TwoRods() {
    scene.rods = {test::random_rod(test::chain(6), {0}, 1), test::random_rod(test::tree(2, 2), {0}, 2)};
    for (const Rod& rod : scene.rods) systems.push_back(test::assembled(rod));
  }
  int size(int rod) const { return systems[rod].matrix().unknowns(); }
  VectorX exact(int rod) {
    VectorX out = VectorX::Zero(size(rod));
    DirectSolve direct(scene);
    REQUIRE(direct.solve(systems[rod], {0, 0, rod}, 0, out) == SolveOutcome::converged);
    return out;
  }
};

struct Proposed : Proposal {
  VectorX x0;
};

Proposed propose(InitialGuess& guess, TwoRods& rods, const SolvePosition& at) {
  VectorX x0 = VectorX::Constant(rods.size(at.rod), 123);  // propose() must overwrite x0
  const Proposal proposal = guess.propose(rods.systems[at.rod], at, x0);
  return {proposal, x0};
}

void accept(InitialGuess& guess, const TwoRods& rods, const SolvePosition& at, const VectorX& solution) {
  guess.accept(rods.systems[at.rod], at, solution);
}

/// A solution that is a polynomial in the step, in numbers that are exact in floating point.
VectorX polynomial(int size, int degree, int step) {
  VectorX out(size);
  for (int i = 0; i < size; ++i)
    out[i] = 3 * i - 20 + (degree > 0 ? (i - 7) * step : 0) + (degree > 1 ? (5 - i) * step * step : 0);
  return out;
}

TEST_CASE("previous, linear and quadratic reproduce sequences of their degree exactly") {
  for (const int terms : {1, 2, 3}) {
    TwoRods rods;
    ExtrapolationGuess guess(rods.scene, 1, terms);
    for (int step = 0; step < 12; ++step) {
      const VectorX solution = polynomial(rods.size(0), terms - 1, step);
      const Proposed proposed = propose(guess, rods, {step, 0, 0});
      INFO(terms << " terms, step " << step);
      CHECK(proposed.nonzero == (step > 0));
      if (step == 0) CHECK(proposed.x0.isZero(0));
      if (step >= terms) CHECK(proposed.x0 == solution);
      accept(guess, rods, {step, 0, 0}, solution);
    }
  }
}

TEST_CASE("with less history than terms, fewer terms are used, and proposing changes nothing") {
  TwoRods rods;
  ExtrapolationGuess guess(rods.scene, 1, 3);
  const VectorX x[] = {polynomial(rods.size(0), 2, 0), polynomial(rods.size(0), 2, 1), polynomial(rods.size(0), 2, 2)};
  accept(guess, rods, {0, 0, 0}, x[0]);
  CHECK(propose(guess, rods, {1, 0, 0}).x0 == x[0]);
  accept(guess, rods, {1, 0, 0}, x[1]);
  CHECK(propose(guess, rods, {2, 0, 0}).x0 == 2 * x[1] - x[0]);
  accept(guess, rods, {2, 0, 0}, x[2]);
  for (int again = 0; again < 2; ++again) CHECK(propose(guess, rods, {3, 0, 0}).x0 == 3 * x[2] - 3 * x[1] + x[0]);
}

TEST_CASE("every Newton iteration of every rod has a history of its own") {
  TwoRods rods;
  ExtrapolationGuess guess(rods.scene, 3, 2);
  const auto solution = [&](int step, int newton, int rod) {
    return VectorX::Constant(rods.size(rod), 100 * rod + 10 * newton + (newton + 1) * step).eval();
  };
  for (int step = 0; step < 4; ++step)
    for (int newton = 0; newton < 3; ++newton)
      for (const int rod : {0, 1}) {
        if (newton == 2 && step == 2) continue;  // Newton converged early in one step
        const Proposed proposed = propose(guess, rods, {step, newton, rod});
        INFO("step " << step << ", Newton " << newton << ", rod " << rod);
        if (newton == 2 && step == 3)
          CHECK_FALSE(proposed.nonzero);
        else if (step >= 2)
          CHECK(proposed.x0 == solution(step, newton, rod));
        accept(guess, rods, {step, newton, rod}, solution(step, newton, rod));
      }
}

TEST_CASE("guesses from history are zero, at no cost, at an iteration without one and after a gap in the steps") {
  const test::OneRod one;
  std::vector<std::unique_ptr<InitialGuess>> guesses;
  guesses.push_back(std::make_unique<ExtrapolationGuess>(one.scene, 2, 2));
  guesses.push_back(std::make_unique<RegressionGuess>(one.scene, 2, 3, 0));
  for (const auto window : {SubspaceGuess::Window::sliding, SubspaceGuess::Window::restarted})
    guesses.push_back(std::make_unique<SubspaceGuess>(one.scene, 2, 3, window));
  for (const auto& guess : guesses) {
    VectorX x0(one.size());
    int products = 0;
    const auto proposed = [&](int step, int newton) {
      x0.setOnes();
      const Proposal proposal = guess->propose(one.system, {step, newton, 0}, x0);
      products = proposal.products;
      if (!proposal.nonzero) CHECK((x0.isZero(0) && products == 0));
      return proposal.nonzero;
    };
    CHECK_FALSE(proposed(0, 1));
    for (const int step : {0, 1}) {
      guess->accept(one.system, {step, 1, 0}, one.exact);
      CHECK_FALSE(proposed(step + 1, 0));  // the other Newton iteration has no history
      CHECK(proposed(step + 1, 1));
    }
    CHECK_FALSE(proposed(3, 1));
    guess->accept(one.system, {3, 1, 0}, one.exact);
    CHECK(proposed(4, 1));
    CHECK(products <= 1);  // only the subspace with its one solution takes one
    CHECK((x0 - one.exact).norm() < 1e-9 * x0.norm());
  }
}

TEST_CASE(
    "the oracle's error has the requested size in the energy norm, a smooth one is of the modes that CG finds last") {
  TwoRods rods;
  for (const int rod : {0, 1}) {
    const MatrixX a = rods.systems[rod].matrix().dense();
    const VectorX exact = rods.exact(rod);
    const double lowest = test::eigenvalues(a).minCoeff();
    for (const auto kind : {white, smooth})
      for (const double error : {1e-6, 0.1, 1.0, 10.0}) {
        OracleGuess guess(rods.scene, error, kind, 7);
        const Proposed proposed = propose(guess, rods, {3, 1, rod});
        CHECK(proposed.nonzero);
        const double measured = test::energy_error(a, proposed.x0, exact);
        CHECK(measured == Approx(error).epsilon(error < 1e-3 ? 1e-7 : 1e-9));  // x itself is accurate to about 1e-13
        const VectorX e = proposed.x0 - exact;
        if (error == 0.1) CHECK((e.dot(a * e) / e.squaredNorm() < 50 * lowest) == (kind == smooth));
      }
  }
  OracleGuess perfect(rods.scene, 0, white, 7);
  CHECK(propose(perfect, rods, {0, 0, 0}).x0 == rods.exact(0));
}

TEST_CASE("the oracle's error depends on the seed and the position, and on nothing else") {
  TwoRods rods;
  OracleGuess guess(rods.scene, 0.1, white, 7), late(rods.scene, 0.1, white, 7), other_seed(rods.scene, 0.1, white, 8);
  OracleGuess high_seed(rods.scene, 0.1, white, 7 + (std::uint64_t{1} << 32));
  const SolvePosition at{4, 1, 0};
  const VectorX expected = propose(guess, rods, at).x0;
  for (int step = 0; step < 4; ++step) {
    propose(late, rods, {step, 0, 1});
    accept(late, rods, {step, 0, 1}, rods.exact(1));
  }
  CHECK(propose(late, rods, at).x0 == expected);
  CHECK(propose(guess, rods, at).x0 == expected);
  CHECK(propose(other_seed, rods, at).x0 != expected);
  CHECK(propose(high_seed, rods, at).x0 != expected);
  CHECK(propose(guess, rods, {5, 1, 0}).x0 != expected);
  CHECK(propose(guess, rods, {4, 2, 0}).x0 != expected);
  CHECK(propose(guess, rods, {1, 4, 0}).x0 != expected);
}

TEST_CASE("the oracle's error is white: as likely up as down in every entry") {
  TwoRods rods;
  OracleGuess guess(rods.scene, 0.5, white, 1);
  const VectorX exact = rods.exact(0);
  VectorX mean = VectorX::Zero(exact.size()), square = mean;
  const int draws = 400;
  for (int step = 0; step < draws; ++step) {
    const VectorX e = propose(guess, rods, {step, 0, 0}).x0 - exact;
    mean += e / draws;
    square += e.cwiseAbs2() / draws;
  }
  const VectorX deviations = mean.cwiseQuotient((square / draws).cwiseSqrt());  // of the mean, in standard errors
  CHECK(deviations.lpNorm<Eigen::Infinity>() < 5);
  CHECK(square.maxCoeff() < 2 * square.minCoeff());
}

TEST_CASE("the oracle proposes zero where the system cannot be solved") {
  TwoRods rods;
  Rod& broken = rods.scene.rods[0];
  broken.position[2].x() = std::numeric_limits<double>::quiet_NaN();
  rods.systems[0].assemble(broken, 0.02);
  OracleGuess guess(rods.scene, 0.1, white, 7);
  const Proposed proposed = propose(guess, rods, {0, 0, 0});
  CHECK_FALSE(proposed.nonzero);
  CHECK(proposed.x0.isZero(0));
}

/// Proposes a fixed vector.
class Fixed : public InitialGuess {
 public:
  explicit Fixed(VectorX x) : x_(std::move(x)) {}
  Proposal propose(const LinearSystem&, const SolvePosition&, VectorX& x0) override {
    x0 = x_;
    return {!x_.isZero(0), 3};
  }
  void accept(const LinearSystem&, const SolvePosition&, const VectorX&) override {}

 private:
  VectorX x_;
};

TEST_CASE("guarded passes a guess on just below its threshold and replaces it by zero just above") {
  TwoRods rods;
  const BlockMatrix& a = rods.systems[0].matrix();
  const VectorX& b = rods.systems[0].rhs();
  const VectorX x0 = 0.7 * rods.exact(0) + 1e-4 * test::Random(1).entries(rods.size(0)).cwiseProduct(rods.exact(0));
  const MatrixX dense = a.dense();
  const VectorX r = b - dense * x0;
  const double ratio = std::sqrt(r.dot(r.cwiseQuotient(dense.diagonal())) / b.dot(b.cwiseQuotient(dense.diagonal())));
  REQUIRE(ratio > 0.1);

  GuardedGuess above(rods.scene, std::make_unique<Fixed>(x0), ratio * (1 + 1e-9));
  const Proposed kept = propose(above, rods, {0, 0, 0});
  CHECK(kept.nonzero);
  CHECK(kept.products == 4);  // the inner guess's products and one for the residual
  CHECK((*kept.residual - r).norm() < 1e-12 * b.norm());
  CHECK(kept.x0 == x0);
  GuardedGuess below(rods.scene, std::make_unique<Fixed>(x0), ratio * (1 - 1e-9));
  const Proposed rejected = propose(below, rods, {0, 0, 0});
  CHECK_FALSE(rejected.nonzero);
  CHECK(rejected.x0.isZero(0));
}

TEST_CASE("guarded rejects a guess that is not a number, and passes a zero one on as zero") {
  TwoRods rods;
  VectorX bad = rods.exact(0);
  bad[3] = std::numeric_limits<double>::quiet_NaN();
  for (const VectorX& x : {bad, VectorX(VectorX::Zero(rods.size(0)))}) {
    GuardedGuess guard(rods.scene, std::make_unique<Fixed>(x), 1e9);
    const Proposed proposed = propose(guard, rods, {0, 0, 0});
    CHECK_FALSE(proposed.nonzero);
    CHECK(proposed.x0.isZero(0));
  }
}

TEST_CASE("first asks another guess at first Newton iterations alone") {
  TwoRods rods;
  FirstGuess guess(std::make_unique<Fixed>(rods.exact(0)));
  const Proposed proposed = propose(guess, rods, {3, 0, 0}), later = propose(guess, rods, {3, 1, 0});
  CHECK(proposed.nonzero);
  CHECK(proposed.x0 == rods.exact(0));
  CHECK_FALSE(later.nonzero);
  CHECK(later.x0.isZero(0));
}

}  // namespace rodsweep::test_initial_guess
