// CG by PETSc's KSPCG: solutions, preconditioners, histories and iteration counts.
#include <array>
#include <cmath>
#include <limits>

#include "solver/scene/scenes.hpp"
#include "tests/catch.hpp"
#include "tests/solver/cg_runs.hpp"

namespace rodsweep::test_conjugate_gradient {

using namespace test;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST_CASE("complete Cholesky is exact on a net, where incomplete is not, but the closer the more fill it keeps") {
  Net net;
  net.rows = net.columns = 6;
  net.segments = 2;
  net.radius_m = 0.01;
  const Case c(build_scene(net).rods.front());
  const auto iterations = [&](Preconditioner p, int levels) {
    return run(c.a(), {p, Norm::true_residual, 0, levels}, c.b(), 1e-8).report.iterations;
  };
  CHECK(iterations(Preconditioner::cholesky, 0) == 1);
  CHECK(iterations(Preconditioner::icc, 0) > 1);
  const int none = iterations(Preconditioner::block_icc, 0), some = iterations(Preconditioner::block_icc, 2);
  CHECK(none < iterations(Preconditioner::jacobi, 0));
  CHECK(some < none);
  CHECK(iterations(Preconditioner::block_icc, 100) <= 4);
}

TEST_CASE("Jacobi preconditioners divide by the diagonal and by its 6x6 blocks") {
  // From zero, the first iterate is a multiple of P^-1 b.
  const Case c = moving_chain();
  const MatrixX a = c.a().dense();
  MatrixX blocks = MatrixX::Zero(a.rows(), a.cols());
  for (int k = 0; k < c.a().block_rows(); ++k) blocks.block<6, 6>(6 * k, 6 * k) = a.block<6, 6>(6 * k, 6 * k);
  const std::pair<Preconditioner, VectorX> expected[] = {
      {Preconditioner::none, c.b()},
      {Preconditioner::jacobi, c.b().cwiseQuotient(a.diagonal())},
      {Preconditioner::point_block_jacobi, dense_solve(blocks, c.b())},
  };
  for (const auto& [p, direction] : expected) {
    INFO(name(p));
    const Run once = run(c.a(), {p, Norm::true_residual, 1}, c.b(), 0);
    CHECK((once.x.normalized() - direction.normalized()).norm() < 1e-10);
    ConjugateGradient cg(c.a(), {p, Norm::natural, 0});
    CHECK(cg.norm_of(c.b()) == Approx(std::sqrt(c.b().dot(direction))).epsilon(1e-10));
  }
}

TEST_CASE("the history starts at the norm of b, ends at the test, and has an entry per iteration") {
  const Case c = moving_chain();
  const VectorX b = c.b();
  each_solver([&](const CgSettings& settings) {
    ConjugateGradient cg(c.a(), settings);
    const double reference = cg.norm_of(c.b());
    const Run solved = run(cg, c.b(), 1e-6);
    CHECK(solved.report.products == solved.report.iterations);
    REQUIRE(solved.history.size() == static_cast<std::size_t>(solved.report.iterations) + 1);
    CHECK(solved.history.front() == Approx(reference).epsilon(1e-13));
    CHECK(solved.history.back() <= 1e-6 * reference);
    for (std::size_t i = 0; i + 1 < solved.history.size(); ++i) CHECK(solved.history[i] > 1e-6 * reference);
  });
  CHECK(b == c.b());  // not modified
}

TEST_CASE("the iteration limit is an outcome, and the recorded norm of its iterate is that of b - A x") {
  const Case c = moving_chain();
  for (const int iterations : {1, 5, 20}) {
    const Run stopped = run(c.a(), {Preconditioner::jacobi, Norm::true_residual, iterations}, c.b(), 0);
    const double residual = (c.b() - c.a().dense() * stopped.x).norm();
    CHECK(stopped.report.outcome == SolveOutcome::iteration_limit);
    CHECK(stopped.report.iterations == iterations);
    CHECK(static_cast<int>(stopped.history.size()) == iterations + 1);
    CHECK(stopped.history.back() == Approx(residual).epsilon(1e-9));
    // The natural norm of the same iterate.
    const Run natural = run(c.a(), {Preconditioner::jacobi, Norm::natural, iterations}, c.b(), 0);
    const VectorX r = c.b() - c.a().dense() * natural.x;
    CHECK(natural.history.back() ==
          Approx(std::sqrt(r.dot(r.cwiseQuotient(c.a().dense().diagonal().eval())))).epsilon(1e-9));
  }
}

TEST_CASE("iterations_to finds the first entry at or below each tolerance, and -1 where there is none") {
  const std::vector<double> history = {2, 1, 1.5, 0.4, 0.5, 0.1};
  const std::vector<double> tolerances = {1, 0.5, 0.4, 0.25, 0.2, 0.05, 0.049};
  std::array<std::int16_t, 7> out{};
  iterations_to(history, 2, tolerances, out.data());
  CHECK(out == std::array<std::int16_t, 7>{0, 1, 3, 3, 3, 5, -1});
  iterations_to({}, 2, tolerances, out.data());
  CHECK(out == std::array<std::int16_t, 7>{-1, -1, -1, -1, -1, -1, -1});
  iterations_to({nan, nan}, 1, {1}, out.data());
  CHECK(out[0] == -1);
}

TEST_CASE("one tight solve counts what separate solves to each tolerance would need") {
  const Case c = moving_chain();
  const std::vector<double> tolerances = {1e-1, 1e-2, 1e-3, 1e-5, 1e-8};
  std::array<std::int16_t, 5> counted{};
  const Run tight = run(c.a(), {}, c.b(), 1e-8);
  iterations_to(tight.history, c.b().norm(), tolerances, counted.data());
  for (std::size_t t = 0; t < tolerances.size(); ++t) {
    CHECK(run(c.a(), {}, c.b(), tolerances[t]).report.iterations == counted[t]);
    if (t > 0) CHECK(counted[t] >= counted[t - 1]);
  }
}

TEST_CASE("residuals are true to the last tolerance, however far above b the guess starts") {
  const Case c = moving_chain();
  const VectorX direction = Random(1).entries(c.a().unknowns());
  const auto residual = [&](const VectorX& x) { return (c.b() - c.a().dense() * x).norm() / c.b().norm(); };
  const double size = residual(1e6 * direction) / 1e6;
  for (const double first : {1e3, 1e6, 1e8, 1e12})
    each_solver([&](const CgSettings& settings) {
      CAPTURE(first);
      ConjugateGradient cg(c.a(), settings);
      const VectorX poor = first / size * direction;
      const Run tight = run(cg, c.b(), 1e-8, &poor);
      CHECK(tight.report.outcome == SolveOutcome::converged);
      CHECK(tight.history.size() == static_cast<std::size_t>(tight.report.iterations) + 1);
      CHECK(tight.history.back() <= 1e-8 * cg.norm_of(c.b()));
      if (settings.norm == Norm::natural) return;
      CHECK(residual(tight.x) <= 1.1e-8);
      // Each count of the history is that of a solve of its own.
      std::int16_t counted = 0;
      iterations_to(tight.history, c.b().norm(), {1e-6}, &counted);
      const Run own = run(cg, c.b(), 1e-6, &poor);
      CHECK(residual(own.x) <= 1.1e-6);
      CHECK(std::abs(own.report.iterations - counted) <= 1 + counted / 10);
    });
}

TEST_CASE("a solve from a guess far above b stays within the limit of iterations") {
  const Case c = moving_chain();
  const VectorX poor = 1e10 * c.exact.norm() * Random(1).entries(c.a().unknowns());
  for (const int most : {1, 30, 60}) {
    ConjugateGradient cg(c.a(), {Preconditioner::jacobi, Norm::true_residual, most});
    const Run ended = run(cg, c.b(), 1e-8, &poor);
    CHECK(ended.report.outcome == SolveOutcome::iteration_limit);
    CHECK(ended.report.iterations == most);
    CHECK(ended.history.size() == static_cast<std::size_t>(most) + 1);
  }
}

}  // namespace rodsweep::test_conjugate_gradient
