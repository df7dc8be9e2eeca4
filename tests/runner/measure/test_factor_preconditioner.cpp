// Learned factors as preconditioner of CG: symmetric, and CG ends at the solution.

#include "network/guess/factor_preconditioner.hpp"
#include "solver/cg/cg_solver.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_factor_preconditioner {

CgSettings settings(const std::shared_ptr<const Model>& model, const Rod& rod, const LinearSystem& system) {
  CgSettings made{Preconditioner::learned};
  made.make_given = [&, model] { return std::make_unique<FactorPreconditioner>(model, rod, system); };
  return made;
}

TEST_CASE("learned factors are a symmetric preconditioner with which CG finds the solution") {
  for (const CopingNetSettings& kind : test::kinds_of_networks()) {
    if (kind.processor != Processor::factors) continue;
    CAPTURE(static_cast<int>(kind.couplings));
    const auto model = test::random_model(kind);
    const Scene scene = build_scene(test::bending_rod(20));
    const Rod& rod = scene.rods.front();
    const LinearSystem system = test::assembled(rod);
    const VectorX b = system.rhs();

    FactorPreconditioner factors(model, rod, system);
    CHECK(factors.set_up(system.matrix()));
    const VectorX r = b, s = b.reverse();
    VectorX of_r(b.size()), of_s(b.size());
    factors.apply(r.data(), of_r.data());
    factors.apply(s.data(), of_s.data());
    CHECK(s.dot(of_r) == Approx(r.dot(of_s)).epsilon(1e-4));

    const auto cg = make_cg(rod, system, settings(model, rod, system));
    VectorX x = VectorX::Zero(b.size()), ax(b.size());
    const CgReport report = cg->solve(b, x, CgStart(false), 1e-6, b.norm());
    CHECK(report.outcome == SolveOutcome::converged);
    system.multiply(x.data(), ax.data());
    CHECK((b - ax).norm() <= 1.01e-6 * b.norm());
  }
}

TEST_CASE("a model without factors is refused") {
  const Scene scene = build_scene(test::bending_rod(5));
  const LinearSystem system = test::assembled(scene.rods.front());
  const auto model = test::random_model(test::message_passing(Encoding::paper_residual, false));
  CHECK_THROWS_AS(FactorPreconditioner(model, scene.rods.front(), system), std::invalid_argument);
}

}  // namespace rodsweep::test_factor_preconditioner
