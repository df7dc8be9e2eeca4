// CG takes as many iterations on the systems of a scene that is turned and shifted as a whole.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "solver/cg/conjugate_gradient.hpp"
#include "tests/solver/turned.hpp"

namespace rodsweep::test_turned_iterations {

struct Solves {
  double rhs_norm;
  std::vector<int> iterations;  // from zero, to each tolerance
};

std::vector<Solves> solves_of(Scene& scene) {
  std::vector<Solves> out;
  test::observe(scene, [&](const LinearSystem& system) {
    out.push_back({system.rhs().norm(), {}});
    ConjugateGradient cg(system.matrix(), {});
    VectorX x(system.rhs().size());
    for (const double tolerance : {1e-1, 1e-2, 1e-3})
      out.back().iterations.push_back(
          cg.solve(system.rhs(), x.setZero(), false, tolerance, out.back().rhs_norm).iterations);
  });
  return out;
}

TEST_CASE("CG takes as many iterations on a turned scene, give or take one that rounding decides") {
  for (const test::TurnedCase& each : test::turned_cases()) {
    INFO(each.name);
    Scene scene = each.scene;
    const std::vector<Solves> original = solves_of(scene);
    for (const test::RigidMotion& motion : test::motions) {
      Scene turned = moved(each.scene, motion);
      const std::vector<Solves> solves = solves_of(turned);
      REQUIRE(solves.size() == original.size());
      for (std::size_t i = 0; i < solves.size(); ++i) {
        if (original[i].rhs_norm < 1e-8) continue;  // noise beside what b is made of
        for (std::size_t t = 0; t < solves[i].iterations.size(); ++t)
          CHECK(std::abs(solves[i].iterations[t] - original[i].iterations[t]) <= 1);
      }
    }
  }
}

}  // namespace rodsweep::test_turned_iterations
