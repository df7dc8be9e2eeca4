// Every failure of a CG solve, and the state that a solver keeps between solves.
#include <limits>

#include "solver/cg/petsc_session.hpp"
#include "tests/catch.hpp"
#include "tests/solver/cg_runs.hpp"

namespace rodsweep::test_conjugate_gradient_ends {

using namespace test;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST_CASE("a guess whose residual is known saves the product, and is solved from in as many iterations") {
  const Case c = moving_chain();
  const VectorX guess = 0.9 * c.exact;
  // By the same product as CG's: rounding changes the fiftieth iteration of plain CG.
  const VectorX left = residual(c.a(), c.b(), guess);
  each_solver([&](const CgSettings& settings) {
    ConjugateGradient cg(c.a(), settings);
    const Run computed = run(cg, c.b(), 1e-8, &guess), known = run(cg, c.b(), 1e-8, &guess, &left);
    CHECK(known.report.outcome == SolveOutcome::converged);
    CHECK(std::abs(known.report.iterations - computed.report.iterations) <= 1);
    CHECK(known.report.products == known.report.iterations);
    CHECK(computed.report.products == computed.report.iterations + 1);
    CHECK((known.x - computed.x).norm() < 1e-6 * c.exact.norm());
  });
}

TEST_CASE("a lagged factor solves the next matrix in fewer iterations than jacobi, and its own in one") {
  const Rod rod = moving_scene(12).rods.front();
  LinearSystem system(rod);
  Rod moved = rod;
  system.assemble(moved, 0.02);
  ConjugateGradient lagged(system.matrix(), {Preconditioner::lagged_cholesky, Norm::true_residual, 0});
  ConjugateGradient jacobi(system.matrix(), {});
  CHECK(run(lagged, system.rhs(), 1e-8).report.iterations == 1);
  for (int s = 0; s < moved.segment_count(); ++s)
    if (!moved.segments[s].is_static) moved.position[s] += 0.02 * moved.velocity[s];
  Random random(2);
  for (Quaternion& q : moved.orientation) q = (q.coeffs() + 0.02 * random.entries(4)).normalized().eval();
  system.assemble(moved, 0.02);
  jacobi.matrix_changed();
  const Run kept = run(lagged, system.rhs(), 1e-8);
  CHECK(kept.report.outcome == SolveOutcome::converged);
  CHECK(kept.report.iterations > 1);
  CHECK(kept.report.iterations < run(jacobi, system.rhs(), 1e-8).report.iterations / 2);
  CHECK((system.rhs() - system.matrix().dense() * kept.x).norm() < 1e-7 * system.rhs().norm());
  lagged.matrix_changed();
  CHECK(run(lagged, system.rhs(), 1e-8).report.iterations == 1);
}

TEST_CASE("a right-hand side of zero takes no iteration, with a NaN in it or in the matrix none converges") {
  const Case c = moving_chain();
  const VectorX zero = VectorX::Zero(c.a().unknowns());
  VectorX bad_b = c.b();
  bad_b[7] = nan;
  BlockMatrix bad_a = c.a();
  bad_a.blocks[bad_a.diagonal(2)].column[1][1] = nan;
  each_solver([&](const CgSettings& settings) {
    const Run solved = run(c.a(), settings, zero, 1e-8);
    CHECK(solved.report.outcome == SolveOutcome::converged);
    CHECK(solved.report.iterations == 0);
    CHECK(solved.x == zero);
    CHECK(run(c.a(), settings, bad_b, 1e-8).report.outcome == SolveOutcome::not_a_number);
    const SolveOutcome outcome = run(bad_a, settings, c.b(), 1e-8).report.outcome;
    INFO(to_string(outcome));
    CHECK((outcome == SolveOutcome::not_a_number || outcome == SolveOutcome::indefinite));
  });
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

TEST_CASE("a guess whose residual is not finite is an outcome, without a history that could be read") {
  const Case c = moving_chain();
  // The square of the last value overflows.
  for (const double entry : {nan, std::numeric_limits<double>::infinity(), 1e200})
    each_solver([&](const CgSettings& settings) {
      CAPTURE(entry);
      ConjugateGradient cg(c.a(), settings);
      const VectorX guess = VectorX::Constant(c.a().unknowns(), entry);
      const Run ended = run(cg, c.b(), 1e-8, &guess);
      CHECK(ended.report.outcome == SolveOutcome::not_a_number);
      CHECK(ended.report.iterations == 0);
      CHECK(ended.history.empty());
    });
}

TEST_CASE("an indefinite matrix is called indefinite, unless the preconditioner solves it exactly") {
  const Case c = moving_chain();
  for (int row = 0; row < c.a().block_rows(); row += 5) {
    BlockMatrix bad = c.a();
    for (Lane8& column : bad.blocks[bad.diagonal(row)].column) column *= broadcast(-1);
    each_solver([&](const CgSettings& settings) {
      const Run ended = run(bad, settings, c.b(), 1e-8);
      INFO("block " << row << ": " << to_string(ended.report.outcome));
      if (settings.preconditioner == Preconditioner::icc)  // PETSc's LDL^T ignores the sign of D
        CHECK((c.b() - bad.dense() * ended.x).norm() < 1e-7 * c.b().norm());
      else
        CHECK(ended.report.outcome == SolveOutcome::indefinite);
    });
  }
}

TEST_CASE("nothing is set up for a guess that is good enough: not even what could not be") {
  const Case c = moving_chain();
  BlockMatrix bad = c.a();
  for (Lane8& column : bad.blocks[bad.diagonal(5)].column) column *= broadcast(-1);
  const VectorX exact = bad.dense().fullPivLu().solve(c.b());
  for (const Preconditioner p : {Preconditioner::block_icc, Preconditioner::cholesky}) {
    INFO(name(p));
    ConjugateGradient cg(bad, {p, Norm::true_residual, 0});
    const Run good = run(cg, c.b(), 1e-8, &exact);
    CHECK(good.report.outcome == SolveOutcome::converged);
    CHECK(good.report.iterations == 0);
    CHECK(good.report.products == 1);
    CHECK(good.history.size() == 1);
    CHECK(good.x == exact);
    const VectorX half = 0.5 * exact;
    CHECK(run(cg, c.b(), 1e-8, &half).report.outcome == SolveOutcome::indefinite);
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
  // Two poses of one rod. The second is crumpled, since small turns of joints hardly change the diagonal. An old
  // preconditioner still converges, but needs more iterations.
  const Case first = moving_chain();
  Rod bent = first.rod;
  for (int s = 1; s < bent.segment_count(); ++s)
    bent.orientation[s] = Eigen::AngleAxisd(2.0 * s * s, Vector3(1, 0.3 * s, 0).normalized()) * bent.orientation[s];
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
    // Jacobi needs the fewest more: a sixth.
    CHECK(run(forgot, second.b(), 1e-8).report.iterations > 1.1 * fresh.report.iterations);
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

TEST_CASE("a PETSc session inside another leaves PETSc running when it ends") {
  { const PetscSession inner; }
  const Case c = moving_chain();
  CHECK(run(c.a(), {}, c.b(), 1e-8).report.outcome == SolveOutcome::converged);
}

}  // namespace rodsweep::test_conjugate_gradient_ends
