// A guess and a preconditioner from a shared library: what they see, what they return, and their errors.
#include <cfenv>
#include <cstdlib>
#include <limits>

#include "solver/cg/cg_solver.hpp"
#include "solver/guess/extrapolation_guess.hpp"
#include "solver/plugin/plugin.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_plugin {

using Catch::Matchers::ContainsSubstring, test::OneRod;

PluginSource example(const std::string& options) { return {PLUGIN_EXAMPLE, options, "plug-in example"}; }

CgReport solve(OneRod& one, const PluginSource& source, VectorX& x, Norm norm = Norm::true_residual) {
  CgSettings settings{Preconditioner::plugin, norm};
  settings.make_given = [&] {
    return std::make_unique<PluginPreconditioner>(source, one.scene.rods[0], 0, one.system);
  };
  const auto cg = make_cg(one.scene.rods[0], one.system, settings);
  return cg->solve(one.system.rhs(), x, CgStart(false), 1e-6, cg->norm_of(one.system.rhs()));
}

TEST_CASE("a plug-in that keeps the last solution proposes what `previous` does") {
  OneRod one;
  test::Random random(4);
  PluginGuess plugin(example(""), one.scene);
  ExtrapolationGuess previous(one.scene, 3, 1);
  VectorX x0(one.size()), expected(one.size());
  for (int step : {0, 1, 2, 4, 5})
    for (int newton = 0; newton < 3; ++newton) {
      const SolvePosition at{step, newton, 0};
      INFO(step << ' ' << newton);
      const Proposal proposal = plugin.propose(one.system, at, x0);
      CHECK(proposal.nonzero == previous.propose(one.system, at, expected).nonzero);
      CHECK(proposal.products == 0);
      CHECK(x0 == expected);
      const VectorX solution = random.entries(one.size());
      plugin.accept(one.system, at, solution);
      previous.accept(one.system, at, solution);
    }
}

TEST_CASE("a plug-in sees A and b, and its products are counted") {
  OneRod one;
  PluginGuess plugin(example("b"), one.scene);
  VectorX x0(one.size());
  const Proposal proposal = plugin.propose(one.system, {0, 0, 0}, x0);
  CHECK(proposal.products == 1);
  CHECK(proposal.start_products() == 2);
  CHECK((x0 - one.a * one.system.rhs()).norm() < 1e-13 * x0.norm());
}

TEST_CASE("a number of products that the files cannot hold is refused") {
  OneRod one;
  VectorX x0(one.size());
  PluginGuess negative(example("products -1"), one.scene), large(example("products 32001"), one.scene),
      most(example("products 32000"), one.scene);
  CHECK_THROWS_WITH(negative.propose(one.system, {0, 0, 0}, x0),
                    ContainsSubstring("plug-in example: counted -1 products with A; must be from 0 to 32000"));
  CHECK_THROWS_WITH(large.propose(one.system, {0, 0, 0}, x0), ContainsSubstring("counted 32001 products"));
  CHECK(most.propose(one.system, {0, 0, 0}, x0).products == 32000);
}

TEST_CASE("what a plug-in says of an error is the text of the exception") {
  OneRod one;
  VectorX x0(one.size());
  CHECK_THROWS_WITH(PluginGuess(example("create"), one.scene),
                    ContainsSubstring("plug-in example: ") && ContainsSubstring("no guess for 1 rods"));
  PluginGuess proposes(example("propose"), one.scene), accepts(example("accept"), one.scene),
      nan(example("nan"), one.scene);
  CHECK_THROWS_WITH(proposes.propose(one.system, {7, 0, 0}, x0), ContainsSubstring("no guess in step 7"));
  accepts.propose(one.system, {3, 0, 0}, x0);
  CHECK_THROWS_WITH(accepts.accept(one.system, {3, 0, 0}, x0),
                    ContainsSubstring("the solution of step 3 is not wanted"));
  nan.propose(one.system, {0, 0, 0}, x0);
  nan.accept(one.system, {0, 0, 0}, x0);
  CHECK_THROWS_WITH(nan.propose(one.system, {1, 0, 0}, x0), ContainsSubstring("not finite"));
}

TEST_CASE("with the diagonal from a plug-in CG takes the iterations of Jacobi, in both norms") {
  for (const Norm norm : {Norm::true_residual, Norm::natural}) {
    OneRod one;
    VectorX x = VectorX::Zero(one.size()), expected = x;
    const CgReport own = solve(one, example(""), x, norm);
    const auto jacobi = make_cg(one.scene.rods[0], one.system, {Preconditioner::jacobi, norm});
    const CgReport report =
        jacobi->solve(one.system.rhs(), expected, CgStart(false), 1e-6, jacobi->norm_of(one.system.rhs()));
    CHECK(own.outcome == SolveOutcome::converged);
    CHECK(own.iterations == report.iterations);
    CHECK((x - expected).norm() < 1e-12 * expected.norm());
  }
}

TEST_CASE("errors of a preconditioner leave CG as exceptions, and none for this matrix ends it as indefinite") {
  OneRod one;
  VectorX x = VectorX::Zero(one.size());
  CHECK_THROWS_WITH(solve(one, example("set_up"), x),
                    ContainsSubstring("plug-in example: no preconditioner in step -1"));
  for (const Norm norm : {Norm::true_residual, Norm::natural})
    CHECK_THROWS_WITH(solve(one, example("apply"), x, norm), ContainsSubstring("plug-in example: not applied"));
  CHECK(solve(one, example("none"), x).outcome == SolveOutcome::indefinite);
}

TEST_CASE("a preconditioner that gives no numbers is named, in both norms") {
  OneRod one;
  VectorX x = VectorX::Zero(one.size());
  for (const Norm norm : {Norm::true_residual, Norm::natural})
    CHECK_THROWS_WITH(solve(one, example("nan"), x, norm), "plug-in example: apply() gave a vector that is not finite");
}

bool rounds_as_ever() {
  volatile double third = 1, tiny = std::numeric_limits<double>::min();
  third = third / 3, tiny = tiny / 2;
  return std::fegetround() == FE_TONEAREST && 3 * third == 1 && tiny > 0;
}

TEST_CASE("numbers are rounded as before, whatever a function of a plug-in changes") {
  OneRod one;
  const VectorX r = one.system.rhs();
  VectorX x = VectorX::Zero(one.size());
  {
    PluginGuess guess(example("rounds"), one.scene);
    CHECK(rounds_as_ever());
    guess.propose(one.system, {0, 0, 0}, x);
    CHECK(rounds_as_ever());
    guess.accept(one.system, {0, 0, 0}, x);
    CHECK(rounds_as_ever());
    PluginPreconditioner preconditioner(example("rounds"), one.scene.rods[0], 0, one.system);
    preconditioner.set_up(one.system.matrix());
    CHECK(rounds_as_ever());
    preconditioner.apply(r.data(), x.data());
    CHECK(rounds_as_ever());
  }
  CHECK(rounds_as_ever());
}

TEST_CASE("a call whose result is no longer wanted is interrupted, and it is said what ran") {
  OneRod one;
  VectorX x(one.size());
  PluginGuess guess(example("endless"), one.scene);
  const Interruptible interruptible([] { return true; });
  try {
    guess.propose(one.system, {7, 0, 0}, x);
    FAIL("nothing was thrown");
  } catch (const InterruptedComputation& interrupted) {
    CHECK(interrupted.where() == "plug-in example (given up in step 7)");
  }
}

TEST_CASE("a process that a plug-in forks ends with the call") {
  OneRod one;
  VectorX x(one.size());
  PluginGuess guess(example("forks"), one.scene);
  const Interruptible interruptible([] { return false; });
  guess.propose(one.system, {0, 0, 0}, x);
  CHECK(x[0] == EXIT_FAILURE);
}

TEST_CASE("a library that is none, or exports no plug-in, is refused") {
  OneRod one;
  CHECK_THROWS_WITH(Plugin({"missing.so", "", "mine"}), ContainsSubstring("mine: cannot be loaded"));
  CHECK_THROWS_WITH(Plugin({NO_PLUGIN, "", "mine"}), ContainsSubstring("mine: does not export rodsweep_plugin()"));
}

}  // namespace rodsweep::test_plugin
