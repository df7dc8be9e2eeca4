// Physical stretching and shearing: compliance, energy, closed forms for pulled and sheared rods.
#include <cmath>

#include "solver/step/gauss_seidel.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_physical_stretch {

BendingRod rod_of(int segments, double youngs_modulus, double torsion_modulus, Stretch stretch) {
  BendingRod p = weightless_cantilever(segments, youngs_modulus, torsion_modulus);
  p.stretch = stretch;
  return p;
}

/// The tip at rest under a force on the last segment's centre. The prediction of such a force turns no segment.
Vector3 settled_tip(const BendingRod& p, const Vector3& force) {
  Scene scene = build_scene(p);
  scene.loads.push_back({0, scene.rods.front().segment_count() - 1, force, Vector3::Zero(), Vector3::Zero()});
  Simulation simulation(std::move(scene), 1);
  simulation.relax(1e-11);
  return tip(simulation.rod());
}

TEST_CASE("elastic energy of physical stretch is EA and kappa G A times half the squared strains") {
  BendingRod p = rod_of(2, 3e6, 1e6, Stretch::physical);
  p.clamp = Clamp::free;
  Rod rod = build_scene(p).rods.front();  // joint of length 1
  const double area = pi * 0.0025;
  rod.position[1] += Vector3(3e-3, 0, 0);
  CHECK(elastic_energy(rod) == Approx(3e6 * area * 9e-6 / 2).epsilon(1e-10));
  rod.position[1] += Vector3(-3e-3, 0, 4e-3);
  CHECK(elastic_energy(rod) == Approx(circle(1, 0.5).shear_coefficient * 1e6 * area * 16e-6 / 2).epsilon(1e-10));
}

TEST_CASE("a pulled rod stretches by F L / EA, but for half a segment at its end that is rigid") {
  const double e = 1e7, area = pi * 0.0025, force = 1e-3 * e * area;
  for (const int n : {1, 5, 40}) {
    const double law =
        force / (e * area) * (2 - 1.0 / n);  // lengths of the joints: half a segment at the wall, then one each
    const Vector3 end = settled_tip(rod_of(n, e, 4e6, Stretch::physical), force * Vector3::UnitX());
    CHECK(end.x() - 2 == Approx(law).epsilon(1e-8));
    CHECK(std::abs(end.y()) + std::abs(end.z()) < 1e-10);
  }
}

TEST_CASE("a transverse force shears a rod by F L / kappa G A beyond its bending") {
  const double e = 1e8, g = 2e6, stiffness = circular_section(0.05, e, g).shear_n;
  const double force = 1e-4 * stiffness;
  for (const int n : {5, 20}) {
    const Vector3 pushed = settled_tip(rod_of(n, e, g, Stretch::physical), force * Vector3::UnitY());
    const Vector3 bent = settled_tip(rod_of(n, e, g, Stretch::inextensible), force * Vector3::UnitY());
    CHECK(pushed.y() - bent.y() == Approx(force * (2 - 1.0 / n) / stiffness).epsilon(2e-3));
  }
}

}  // namespace rodsweep::test_physical_stretch
