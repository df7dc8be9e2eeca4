// A guess from a shared library: what it sees, what it proposes, and its errors.
#include <catch2/catch.hpp>

#include "solver/guess/plugin_guess.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_plugin_guess {

using Catch::Contains, test::OneRod;

constexpr const char* library = PLUGIN_EXAMPLE;

TEST_CASE("a plug-in that keeps the last solution proposes what `previous` does") {
  OneRod one;
  test::Random random(4);
  PluginGuess plugin(library, "", one.scene);
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
      plugin.accept(at, solution);
      previous.accept(at, solution);
    }
}

TEST_CASE("a plug-in sees A and b, and its products are counted") {
  OneRod one;
  PluginGuess plugin(library, "b", one.scene);
  VectorX x0(one.size());
  const Proposal proposal = plugin.propose(one.system, {0, 0, 0}, x0);
  CHECK(proposal.products == 1);
  CHECK(proposal.start_products() == 2);
  CHECK((x0 - one.a * one.system.rhs()).norm() < 1e-13 * x0.norm());
}

TEST_CASE("what a plug-in says of an error is the text of the exception") {
  OneRod one;
  VectorX x0(one.size());
  CHECK_THROWS_WITH(PluginGuess(library, "create", one.scene), Contains("plug-in ") && Contains("no guess for 1 rods"));
  PluginGuess proposes(library, "propose", one.scene), accepts(library, "accept", one.scene),
      nan(library, "nan", one.scene);
  CHECK_THROWS_WITH(proposes.propose(one.system, {7, 0, 0}, x0), Contains("no guess in step 7"));
  accepts.propose(one.system, {3, 0, 0}, x0);
  CHECK_THROWS_WITH(accepts.accept({3, 0, 0}, x0), Contains("the solution of step 3 is not wanted"));
  nan.propose(one.system, {0, 0, 0}, x0);
  nan.accept({0, 0, 0}, x0);
  CHECK_THROWS_WITH(nan.propose(one.system, {1, 0, 0}, x0), Contains("not finite"));
}

TEST_CASE("a library that is none, or exports no plug-in, is refused") {
  OneRod one;
  CHECK_THROWS_WITH(Plugin("missing.so"), Contains("plug-in missing.so") && Contains("cannot be loaded"));
  CHECK_THROWS_WITH(Plugin(NO_PLUGIN), Contains("does not export rodsweep_plugin()"));
}

}  // namespace rodsweep::test_plugin_guess
