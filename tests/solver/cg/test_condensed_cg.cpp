// CG on condensed systems: same solution and accuracy as CG on all joints, fewer iterations.
#include <limits>

#include "solver/cg/condensed_cg.hpp"
#include "tests/catch.hpp"
#include "tests/solver/cg_runs.hpp"

namespace rodsweep::test_condensed_cg {

using test::Case, test::Run, test::run;

Case lattice(int nodes, double modulus, Lattice::Cell cell = Lattice::Cell::cubic) {
  Rod rod =
      build_scene(test::slender_lattice(cell, nodes, 3, Held::side, modulus)).rods.front();  // at rest, before it falls
  test::Random random(1);
  for (int s = 0; s < rod.segment_count(); ++s)
    if (!rod.segments[s].is_static) rod.position[s] += Vector3(0, -0.004, 0) + random.vector(1e-4);
  return Case(rod);
}

Run solved(const Case& c, CgSolver& cg, double tolerance, const VectorX* start = nullptr,
           const VectorX* residual = nullptr) {
  cg.matrix_changed();
  return run(cg, c.b(), tolerance, start, residual);
}

double residual(const Case& c, const VectorX& x) { return test::residual(c.a(), c.b(), x).norm() / c.b().norm(); }

TEST_CASE("condensed CG stops where the residual of all joints is small, and says how small it was") {
  for (const Lattice::Cell cell : {Lattice::Cell::cubic, Lattice::Cell::body_centred, Lattice::Cell::octet}) {
    const Case c = lattice(3, 1e6, cell);
    CondensedCg cg(c.rod, c.system);
    for (const double tolerance : {1e-1, 1e-3, 1e-8}) {
      const Run found = solved(c, cg, tolerance);
      REQUIRE(found.report.outcome == SolveOutcome::converged);
      CHECK(found.report.products == 0);
      CHECK(static_cast<int>(found.history.size()) == found.report.iterations + 1);
      CHECK(found.history.front() == Approx(c.b().norm()));
      CHECK(residual(c, found.x) <= tolerance * (1 + 1e-6));
      CHECK(residual(c, found.x) == Approx(found.history.back() / c.b().norm()).epsilon(1e-3).margin(1e-12));
    }
    CHECK((solved(c, cg, 1e-10).x - c.exact).norm() < 1e-6 * c.exact.norm());
  }
}

TEST_CASE("eliminating struts saves iterations") {
  const Case c = lattice(4, 1e7);
  CondensedCg condensed(c.rod, c.system);
  ConjugateGradient jacobi(c.a(), {});
  CHECK(2 * solved(c, condensed, 1e-2).report.iterations < solved(c, jacobi, 1e-2).report.iterations);
}

TEST_CASE("a chain is solved in one iteration") {
  const Case c = test::moving_chain();
  CondensedCg cg(c.rod, c.system);
  const Run found = solved(c, cg, 1e-8);
  CHECK(found.report.outcome == SolveOutcome::converged);
  CHECK(found.report.iterations == 1);
  CHECK(residual(c, found.x) < 1e-8);
}

TEST_CASE("condensed CG starts from a guess, whose residual costs a product unless it is known") {
  const Case c = lattice(3, 1e6);
  CondensedCg cg(c.rod, c.system);
  test::Random random(3);
  const VectorX start =
      c.exact + 0.05 * c.exact.norm() / std::sqrt(c.exact.size()) * random.entries(static_cast<int>(c.exact.size()));
  VectorX left(start.size());
  c.system.multiply(start.data(), left.data());
  left = c.b() - left;
  const Run found = solved(c, cg, 1e-6, &start), known = solved(c, cg, 1e-6, &start, &left);
  CHECK(found.report.products == 1);
  CHECK(known.report.products == 0);
  CHECK(found.history.front() == Approx(left.norm()));
  CHECK(found.x == known.x);
  CHECK(residual(c, found.x) <= 1e-6);
  const Run exact = solved(c, cg, 1e-6, &c.exact);
  CHECK(exact.report.iterations == 0);
  CHECK(exact.x == c.exact);
}

TEST_CASE("a kept preconditioner serves a system that has changed, which is condensed anew") {
  Case c = lattice(3, 1e6);
  CondensedCg cg(c.rod, c.system), fresh(c.rod, c.system);
  const int at_first = solved(c, cg, 1e-6).report.iterations;
  for (int s = 0; s < c.rod.segment_count(); ++s)
    if (!c.rod.segments[s].is_static) c.rod.position[s] += 0.1 * c.rod.position[s].x() * Vector3(0, 1, 1);
  c.system.assemble(c.rod, 0.02);
  VectorX x = VectorX::Zero(c.b().size());
  const CgReport kept = cg.solve(c.b(), x, false, 1e-6, c.b().norm());
  CHECK(kept.outcome == SolveOutcome::converged);
  CHECK(residual(c, x) <= 1e-6 * (1 + 1e-6));
  CHECK(kept.iterations > at_first);
  CHECK(solved(c, fresh, 1e-6).report.iterations <= kept.iterations);
}

TEST_CASE("condensed CG reports what is not a number and what takes too long") {
  Case c = lattice(3, 1e6);
  CondensedCg cg(c.rod, c.system), impatient(c.rod, c.system, {Preconditioner::condensed, Norm::true_residual, 2});
  const CgReport limited = solved(c, impatient, 1e-12).report;
  CHECK(limited.outcome == SolveOutcome::iteration_limit);
  CHECK(limited.iterations == 2);
  VectorX b = c.b(), x = VectorX::Zero(b.size());
  b[7] = std::numeric_limits<double>::quiet_NaN();
  CHECK(cg.solve(b, x, false, 1e-2, 1).outcome == SolveOutcome::not_a_number);
}

}  // namespace rodsweep::test_condensed_cg
