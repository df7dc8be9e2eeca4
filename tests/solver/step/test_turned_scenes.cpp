// A scene that is turned and shifted as a whole has the same linear systems, up to rounding, and moves alike by
// Gauss-Seidel. tests/laws/every_scene.cpp has the same law for every scene by direct solves.

#include "solver/step/gauss_seidel.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/turned.hpp"

namespace rodsweep::test_turned_scenes {

using test::RigidMotion, test::TurnedCase;

struct System {
  test::MatrixX a;
  VectorX b;
};

std::vector<System> systems_of(Scene& scene) {
  std::vector<System> out;
  test::observe(scene, [&](const LinearSystem& system) { out.push_back({system.matrix().dense(), system.rhs()}); });
  return out;
}

TEST_CASE("a turned scene has the same systems, entry by entry") {
  for (const TurnedCase& each : test::turned_cases()) {
    INFO(each.name);
    Scene scene = each.scene;
    const std::vector<System> original = systems_of(scene);
    for (const RigidMotion& motion : test::motions) {
      Scene turned = moved(each.scene, motion);
      const std::vector<System> systems = systems_of(turned);
      REQUIRE(systems.size() == original.size());
      for (std::size_t i = 0; i < systems.size(); ++i) {
        CHECK(test::scaled_difference(systems[i].a, original[i].a) < 1e-9);
        CHECK((systems[i].b - original[i].b).lpNorm<Eigen::Infinity>() < 1e-9);
      }
      for (int s = 0; s < scene.rods[0].segment_count(); ++s)
        CHECK((turned.rods[0].position[s] - motion(scene.rods[0].position[s])).norm() < 1e-9);
      CHECK((turned.rods[0].lambda - scene.rods[0].lambda).norm() < 1e-7 * scene.rods[0].lambda.norm());
    }
  }
}

TEST_CASE("a mirrored scene has the same systems, but for the signs of rows") {
  for (const TurnedCase& each : test::turned_cases()) {
    INFO(each.name);
    Scene scene = each.scene, image = test::mirrored(each.scene);
    const std::vector<System> original = systems_of(scene), systems = systems_of(image);
    REQUIRE(systems.size() == original.size());
    for (std::size_t i = 0; i < systems.size(); ++i) {
      const VectorX signs = test::mirrored_rows.replicate(systems[i].b.size() / 6, 1);
      CHECK(test::scaled_difference(signs.asDiagonal() * systems[i].a * signs.asDiagonal(), original[i].a) < 1e-9);
      CHECK((systems[i].b.cwiseProduct(signs) - original[i].b).lpNorm<Eigen::Infinity>() < 1e-9);
    }
  }
}

/// The scene after ten steps.
template <class GaussSeidel, class... Settings>
Scene stepped(Scene scene, const Settings&... settings) {
  GaussSeidel projection(scene, settings...);
  TimeStepper stepper(scene, {0.01, 20, 0});
  for (int step = 0; step < 10; ++step) stepper.step(projection);
  return scene;
}

TEST_CASE("turned scenes move alike by XPBD and by PBD") {
  const PbdStiffness stiffness;
  for (const TurnedCase& each : test::turned_cases())
    for (const RigidMotion& motion : test::motions) {
      INFO(each.name);
      const Scene turned = moved(each.scene, motion), xpbd = moved(stepped<XpbdProjection>(each.scene), motion),
                  pbd = moved(stepped<PbdProjection>(each.scene, stiffness), motion);
      CHECK(test::distance(stepped<XpbdProjection>(turned), xpbd, &Rod::position) < 1e-9);
      CHECK(test::distance(stepped<PbdProjection>(turned, stiffness), pbd, &Rod::position) < 1e-9);
    }
}

}  // namespace rodsweep::test_turned_scenes
