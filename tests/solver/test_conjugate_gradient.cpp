// KSPCG as instrumented here: solutions, histories, iteration counts, and every way to end other than well.
#include <array>
#include <catch2/catch.hpp>
#include <limits>
#include <string>
#include <type_traits>

#include "solver/block_factor.hpp"
#include "solver/conjugate_gradient.hpp"
#include "solver/linear_system.hpp"
#include "support.hpp"

namespace rodsweep {
namespace {

using test::MatrixX;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr Preconditioner preconditioners[] = {Preconditioner::none, Preconditioner::jacobi,
                                              Preconditioner::point_block_jacobi, Preconditioner::icc,
                                              Preconditioner::cholesky};
constexpr Norm norms[] = {Norm::true_residual, Norm::natural};

const char* name(Preconditioner p) {
  static const char* const names[] = {"none", "jacobi", "point_block_jacobi", "icc", "cholesky"};
  return names[static_cast<std::size_t>(p)];
}

/// A Newton system of a rod in motion, and its solution.
struct Case {
  Rod rod;
  LinearSystem system;
  VectorX exact;

  explicit Case(const Rod& r, double dt = 0.02) : rod(r), system(rod), exact(VectorX::Zero(6 * rod.joint_count())) {
    system.assemble(rod, dt);
    BlockFactor factor(system.matrix(), root_to_leaf_order(rod));
    REQUIRE(factor.solve(system.matrix(), system.rhs(), exact) == SolveOutcome::converged);
  }
  const BlockMatrix& a() const { return system.matrix(); }
  const VectorX& b() const { return system.rhs(); }
};

/// A chain in motion whose next prediction violates its constraints.
Case moving_chain(int segments = 12) {
  Rod rod = test::moving_scene(segments).rods.front();
  for (int s = 0; s < rod.segment_count(); ++s)
    if (!rod.segments[s].is_static) rod.position[s] += 0.02 * rod.velocity[s];
  rod.lambda.setZero();
  return Case(rod);
}

struct Run {
  CgReport report;
  VectorX x;
  std::vector<double> history;
};

Run run(ConjugateGradient& cg, const VectorX& b, double tolerance, const VectorX* guess = nullptr) {
  Run out;
  out.x = guess ? *guess : VectorX(VectorX::Zero(b.size()));
  cg.record_history(true);
  out.report = cg.solve(b, out.x, guess != nullptr, tolerance, cg.norm_of(b));
  out.history = cg.history();
  return out;
}

Run run(const BlockMatrix& a, const CgSettings& settings, const VectorX& b, double tolerance) {
  ConjugateGradient cg(a, settings);
  return run(cg, b, tolerance);
}

TEST_CASE("CG, the direct solve and a dense Cholesky agree in residual and energy error") {
  const std::pair<const char*, Case> cases[] = {
      {"chain", moving_chain()},
      {"tree", Case(test::random_rod(test::tree(2, 3), {0}, 2))},
      {"ring", Case(test::random_rod(test::ring(8), {0}, 3))},
  };
  for (const auto& [graph, c] : cases) {
    const MatrixX a = c.a().dense();
    const VectorX dense = test::dense_solve(a, c.b());
    CHECK(test::energy_error(a, c.exact, dense) < 1e-10);
    CHECK((c.b() - a * c.exact).norm() < 1e-10 * c.b().norm());
    for (const Preconditioner p : preconditioners)
      for (const Norm norm : norms) {
        INFO(graph << ", " << name(p) << ", " << (norm == Norm::natural ? "natural" : "true residual"));
        const Run solved = run(c.a(), {p, norm, 0}, c.b(), 1e-13);
        CHECK(solved.report.outcome == SolveOutcome::converged);
        CHECK(test::energy_error(a, solved.x, dense) < 1e-10);
        CHECK((c.b() - a * solved.x).norm() < 1e-10 * c.b().norm());
      }
  }
}

TEST_CASE("incomplete and complete Cholesky are exact on a chain: one iteration, where Jacobi needs many") {
  const Case c = moving_chain(30);
  for (const Preconditioner p : {Preconditioner::icc, Preconditioner::cholesky})
    CHECK(run(c.a(), {p, Norm::true_residual, 0}, c.b(), 1e-8).report.iterations == 1);
  CHECK(run(c.a(), {Preconditioner::jacobi, Norm::true_residual, 0}, c.b(), 1e-8).report.iterations > 30);
}

TEST_CASE("complete Cholesky is exact on a net, where incomplete is not") {
  const Case c(test::random_rod(test::net(4, 4), {0}, 3));
  CHECK(run(c.a(), {Preconditioner::cholesky, Norm::true_residual, 0}, c.b(), 1e-8).report.iterations == 1);
  CHECK(run(c.a(), {Preconditioner::icc, Norm::true_residual, 0}, c.b(), 1e-8).report.iterations > 1);
}

TEST_CASE("Jacobi preconditioners divide by the diagonal and by its 6x6 blocks") {
  // From zero, the first iterate is along P^-1 b.
  const Case c = moving_chain();
  const MatrixX a = c.a().dense();
  MatrixX blocks = MatrixX::Zero(a.rows(), a.cols());
  for (int k = 0; k < c.a().block_rows(); ++k) blocks.block<6, 6>(6 * k, 6 * k) = a.block<6, 6>(6 * k, 6 * k);
  const std::pair<Preconditioner, VectorX> expected[] = {
      {Preconditioner::none, c.b()},
      {Preconditioner::jacobi, c.b().cwiseQuotient(a.diagonal())},
      {Preconditioner::point_block_jacobi, test::dense_solve(blocks, c.b())},
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
  for (const Preconditioner p : preconditioners)
    for (const Norm norm : norms) {
      INFO(name(p));
      ConjugateGradient cg(c.a(), {p, norm, 0});
      const double reference = cg.norm_of(c.b());
      const Run solved = run(cg, c.b(), 1e-6);
      REQUIRE(solved.history.size() == static_cast<std::size_t>(solved.report.iterations) + 1);
      CHECK(solved.history.front() == Approx(reference).epsilon(1e-13));
      CHECK(solved.history.back() <= 1e-6 * reference);
      for (std::size_t i = 0; i + 1 < solved.history.size(); ++i) CHECK(solved.history[i] > 1e-6 * reference);
    }
  ConjugateGradient cg(c.a(), {});
  CHECK(cg.norm_of(c.b()) == c.b().norm());
}

TEST_CASE("the recorded norm is that of b - A x") {
  const Case c = moving_chain();
  for (const int iterations : {1, 5, 20}) {
    const Run stopped = run(c.a(), {Preconditioner::jacobi, Norm::true_residual, iterations}, c.b(), 0);
    const double residual = (c.b() - c.a().dense() * stopped.x).norm();
    CHECK(stopped.history.back() == Approx(residual).epsilon(1e-9));
    // the natural norm, of the same iterate
    const Run natural = run(c.a(), {Preconditioner::jacobi, Norm::natural, iterations}, c.b(), 0);
    const VectorX r = c.b() - c.a().dense() * natural.x;
    CHECK(natural.history.back() ==
          Approx(std::sqrt(r.dot(r.cwiseQuotient(c.a().dense().diagonal().eval())))).epsilon(1e-9));
  }
}

TEST_CASE("the energy error falls in every iteration") {
  const Case c = moving_chain();
  const MatrixX a = c.a().dense();
  double before = 1;
  for (int iterations = 1; iterations <= 30; ++iterations) {
    const double error = test::energy_error(
        a, run(c.a(), {Preconditioner::jacobi, Norm::true_residual, iterations}, c.b(), 0).x, c.exact);
    REQUIRE(error < before);
    before = error;
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

TEST_CASE("the iteration limit is an outcome, and leaves the best iterate") {
  const Case c = moving_chain();
  const Run stopped = run(c.a(), {Preconditioner::jacobi, Norm::true_residual, 3}, c.b(), 1e-8);
  CHECK(stopped.report.outcome == SolveOutcome::iteration_limit);
  CHECK(stopped.report.iterations == 3);
  CHECK(stopped.history.size() == 4);
  CHECK(test::energy_error(c.a().dense(), stopped.x, c.exact) < 1);
}

TEST_CASE("a right-hand side of zero takes no iteration") {
  const Case c = moving_chain();
  const VectorX zero = VectorX::Zero(c.a().unknowns());
  for (const Preconditioner p : preconditioners)
    for (const Norm norm : norms) {
      const Run solved = run(c.a(), {p, norm, 0}, zero, 1e-8);
      CHECK(solved.report.outcome == SolveOutcome::converged);
      CHECK(solved.report.iterations == 0);
      CHECK(solved.x == zero);
    }
}

TEST_CASE("an exact guess takes no iteration") {
  const Case c = moving_chain();
  for (const Preconditioner p : preconditioners) {
    ConjugateGradient cg(c.a(), {p, Norm::true_residual, 0});
    const Run solved = run(cg, c.b(), 1e-8, &c.exact);
    CHECK(solved.report.outcome == SolveOutcome::converged);
    CHECK(solved.report.iterations == 0);
    CHECK(solved.x == c.exact);
  }
}

TEST_CASE("the test stays relative to b with a guess, even one whose residual starts far above b") {
  const Case c = moving_chain();
  const VectorX poor = 1e4 * test::Random(1).entries(c.a().unknowns()).cwiseProduct(c.exact.cwiseAbs());
  for (const Norm norm : norms) {
    ConjugateGradient cg(c.a(), {Preconditioner::jacobi, norm, 0});
    const double reference = cg.norm_of(c.b());
    const Run solved = run(cg, c.b(), 1e-6, &poor);
    CHECK(solved.history.front() > 100 * reference);
    CHECK(solved.report.outcome == SolveOutcome::converged);
    CHECK(solved.history.back() <= 1e-6 * reference);
    if (norm == Norm::true_residual) CHECK((c.b() - c.a().dense() * solved.x).norm() < 1.01e-6 * reference);
  }
}

TEST_CASE("a residual past 1e30 times b is called diverged") {
  const Case c = moving_chain();
  const VectorX absurd = 1e36 * c.exact;
  ConjugateGradient cg(c.a(), {});
  CHECK(run(cg, c.b(), 1e-6, &absurd).report.outcome == SolveOutcome::diverged);
}

TEST_CASE("without a guess, what x held does not matter") {
  const Case c = moving_chain();
  const Run expected = run(c.a(), {}, c.b(), 1e-8);
  ConjugateGradient cg(c.a(), {});
  VectorX x = VectorX::Constant(c.a().unknowns(), nan);
  CHECK(cg.solve(c.b(), x, false, 1e-8, c.b().norm()).outcome == SolveOutcome::converged);
  CHECK(x == expected.x);
}

TEST_CASE("a NaN in b is an outcome") {
  const Case c = moving_chain();
  for (const Preconditioner p : preconditioners)
    for (const Norm norm : norms) {
      INFO(name(p));
      VectorX b = c.b();
      b[7] = nan;
      CHECK(run(c.a(), {p, norm, 0}, b, 1e-8).report.outcome == SolveOutcome::not_a_number);
    }
}

TEST_CASE("a NaN in the matrix never converges") {
  const Case c = moving_chain();
  BlockMatrix bad = c.a();
  bad.blocks[bad.diagonal(2)].column[1][1] = nan;
  for (const Preconditioner p : preconditioners)
    for (const Norm norm : norms) {
      const SolveOutcome outcome = run(bad, {p, norm, 0}, c.b(), 1e-8).report.outcome;
      INFO(name(p) << ": " << to_string(outcome));
      CHECK((outcome == SolveOutcome::not_a_number || outcome == SolveOutcome::indefinite));
    }
}

TEST_CASE("an indefinite matrix is called indefinite, unless the preconditioner solves it exactly") {
  const Case c = moving_chain();
  for (int row = 0; row < c.a().block_rows(); row += 5) {
    BlockMatrix bad = c.a();
    for (Lane8& column : bad.blocks[bad.diagonal(row)].column) column *= broadcast(-1);
    for (const Preconditioner p : preconditioners)
      for (const Norm norm : norms) {
        const Run ended = run(bad, {p, norm, 0}, c.b(), 1e-8);
        INFO(name(p) << ", block " << row << ": " << to_string(ended.report.outcome));
        if (p == Preconditioner::icc || p == Preconditioner::cholesky)  // LDL^T without a look at D's sign
          CHECK((c.b() - bad.dense() * ended.x).norm() < 1e-7 * c.b().norm());
        else
          CHECK(ended.report.outcome == SolveOutcome::indefinite);
      }
  }
}

TEST_CASE("a solver that failed solves the next system as if new") {
  const Case c = moving_chain();
  for (const Preconditioner p : preconditioners) {
    INFO(name(p));
    BlockMatrix a = c.a();
    ConjugateGradient cg(a, {p, Norm::true_residual, 0});
    for (Lane8& column : a.blocks[a.diagonal(3)].column) column *= broadcast(-1);
    run(cg, c.b(), 1e-8);
    CHECK(run(cg, VectorX::Constant(a.unknowns(), nan), 1e-8).report.outcome == SolveOutcome::not_a_number);
    a = c.a();
    cg.matrix_changed();
    const Run again = run(cg, c.b(), 1e-8);
    CHECK(again.report.outcome == SolveOutcome::converged);
    CHECK(again.x == run(c.a(), {p, Norm::true_residual, 0}, c.b(), 1e-8).x);
  }
}

TEST_CASE("after matrix_changed() the preconditioner is that of the new matrix") {
  // The same rod in two poses. An old preconditioner still converges, only later: that is what to look for.
  const Case first = moving_chain();
  Rod bent = first.rod;
  for (int s = 1; s < bent.segment_count(); ++s)
    bent.orientation[s] = Eigen::AngleAxisd(0.3 * s, Vector3(1, 1, 0).normalized()) * bent.orientation[s];
  const Case second(bent);
  for (const Preconditioner p : preconditioners) {
    if (p == Preconditioner::none) continue;
    INFO(name(p));
    const CgSettings settings{p, Norm::true_residual, 0};
    BlockMatrix a = first.a();
    ConjugateGradient forgot(a, settings), told(a, settings);
    run(forgot, first.b(), 1e-8);
    run(told, first.b(), 1e-8);
    a = second.a();
    told.matrix_changed();
    const Run fresh = run(second.a(), settings, second.b(), 1e-8), now = run(told, second.b(), 1e-8);
    CHECK(now.report.iterations == fresh.report.iterations);
    CHECK(now.x == fresh.x);
    CHECK(run(forgot, second.b(), 1e-8).report.iterations > fresh.report.iterations);
    if (p == Preconditioner::cholesky || p == Preconditioner::icc) CHECK(now.report.iterations == 1);
  }
}

TEST_CASE("norm_of() after matrix_changed() is in the new preconditioner's norm") {
  const Case c = moving_chain();
  for (const Preconditioner p : preconditioners) {
    INFO(name(p));
    BlockMatrix a = c.a();
    ConjugateGradient cg(a, {p, Norm::natural, 0});
    const double before = cg.norm_of(c.b());
    for (Block6& block : a.blocks)
      for (Lane8& column : block.column) column *= broadcast(4);
    cg.matrix_changed();
    CHECK(cg.norm_of(c.b()) == Approx(p == Preconditioner::none ? before : before / 2).epsilon(1e-12));
  }
}

TEST_CASE("solvers move, and leave a source that can be destroyed or given a new solver") {
  static_assert(std::is_nothrow_move_constructible_v<ConjugateGradient>);
  static_assert(std::is_nothrow_move_assignable_v<ConjugateGradient>);
  static_assert(!std::is_copy_constructible_v<ConjugateGradient>);
  const Case c = moving_chain();
  const VectorX expected = run(c.a(), {}, c.b(), 1e-8).x;
  ConjugateGradient first(c.a(), {});
  run(first, c.b(), 1e-8);
  ConjugateGradient second(std::move(first));
  CHECK(run(second, c.b(), 1e-8).x == expected);
  first = std::move(second);
  CHECK(run(first, c.b(), 1e-8).x == expected);
  second = ConjugateGradient(c.a(), {Preconditioner::cholesky, Norm::true_residual, 0});
  CHECK(run(second, c.b(), 1e-8).report.iterations == 1);
  std::vector<ConjugateGradient> many;
  for (int i = 0; i < 5; ++i) many.emplace_back(c.a(), CgSettings{});  // reallocation moves them
  for (ConjugateGradient& cg : many) CHECK(run(cg, c.b(), 1e-8).x == expected);
}

TEST_CASE("a solver used a hundred times gives the same bits") {
  const Case c = moving_chain();
  const VectorX other = test::Random(5).entries(c.a().unknowns()), guess = 0.9 * c.exact;
  for (const Preconditioner p : preconditioners) {
    ConjugateGradient cg(c.a(), {p, Norm::true_residual, 0});
    const Run zero = run(cg, c.b(), 1e-8), guessed = run(cg, c.b(), 1e-8, &guess);
    for (int i = 0; i < 100; ++i) {
      switch (i % 3) {
        case 0: run(cg, other, 1e-4); break;
        case 1: cg.matrix_changed(); break;
        default: cg.norm_of(other);
      }
      const Run again = run(cg, c.b(), 1e-8), again_guessed = run(cg, c.b(), 1e-8, &guess);
      REQUIRE(again.x == zero.x);
      REQUIRE(again.history == zero.history);
      REQUIRE(again_guessed.x == guessed.x);
    }
  }
}

TEST_CASE("the history is empty while recording is off, and the solution the same") {
  const Case c = moving_chain();
  ConjugateGradient cg(c.a(), {});
  VectorX x = VectorX::Zero(c.a().unknowns());
  cg.solve(c.b(), x, false, 1e-8, c.b().norm());
  CHECK(cg.history().empty());
  const Run recorded = run(cg, c.b(), 1e-8);
  CHECK(recorded.x == x);
  CHECK_FALSE(recorded.history.empty());
  cg.record_history(false);
  cg.solve(c.b(), x, false, 1e-8, c.b().norm());
  CHECK(cg.history().empty());
  CHECK(run(cg, c.b(), 1e-8).history == recorded.history);
}

TEST_CASE("b is not written to") {
  const Case c = moving_chain();
  const VectorX b = c.b();
  for (const Preconditioner p : preconditioners) run(c.a(), {p, Norm::natural, 0}, b, 1e-8);
  CHECK(b == c.b());
}

}  // namespace
}  // namespace rodsweep
