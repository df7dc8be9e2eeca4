// Numerical extremes: signs of quaternions, extreme moduli.

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_extremes {

/// The scene with every second quaternion negated, which is the same orientation.
Scene with_signs_flipped(Scene scene) {
  Rod& rod = scene.rods.front();
  for (std::size_t s = 0; s < rod.orientation.size(); s += 2) rod.orientation[s].coeffs() *= -1;
  return scene;
}

TEST_CASE("neighbouring quaternions in opposite hemispheres give the same motion, bit for bit") {
  Ring ring;
  ring.segments = 10;
  for (const SceneSpec& spec : {SceneSpec(test::bending_rod(9)), SceneSpec(Helix{}), SceneSpec(ring)}) {
    const Scene scene = build_scene(spec);
    Simulation plain(scene, 0.02), flipped(with_signs_flipped(scene), 0.02);
    plain.run(30);
    flipped.run(30);
    CHECK(plain.rod().position == flipped.rod().position);
    CHECK(plain.rod().angular_velocity == flipped.rod().angular_velocity);
    CHECK(plain.rod().lambda == flipped.rod().lambda);
  }
}

TEST_CASE("moduli from 1 Pa to 1e15 Pa keep rods together and Newton converging") {
  for (const double modulus : {1.0, 1e3, 1e9, 1e12, 1e15})
    for (const Stretch stretch : {Stretch::inextensible, Stretch::physical}) {
      if (stretch == Stretch::physical && modulus < 1e6) continue;  // its own weight tears such a rod
      BendingRod p = test::bending_rod(12);
      p.youngs_modulus_pa = p.torsion_modulus_pa = modulus;
      p.stretch = stretch;
      Simulation simulation(build_scene(p), {0.02, 20, 1e-9});
      INFO("modulus " << modulus << (stretch == Stretch::physical ? ", physical" : ""));
      for (int i = 0; i < 100; ++i) {
        simulation.step();
        REQUIRE(newton_residual(simulation.rod(), simulation.constraint_dt()) < 1e-8);
      }
      CHECK(is_finite(simulation.rod()));
      CHECK(joint_gap(simulation.rod()) < 1e-4);
      if (modulus >= 1e12)  // almost rigid
        CHECK((tip(simulation.rod()) - tip(build_scene(p).rods.front())).norm() < 1e-4);
    }
}

}  // namespace rodsweep::test_extremes
