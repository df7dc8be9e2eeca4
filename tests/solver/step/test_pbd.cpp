// PBD's corrections in closed form. PBD rods are rigid in the limit of many iterations.
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "solver/numbers/rotation.hpp"
#include "solver/step/gauss_seidel.hpp"
#include "solver/step/observables.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_pbd {

/// Two free coaxial segments of 0.2 m and radius 0.05 m, joined end to end, at rest.
Scene pair() {
  SegmentSpec a{{0, 0, 0}, Quaternion::Identity(), 0.2, 0.05, 1000, false}, b = a;
  b.position_m.z() = 0.2;
  Scene scene;
  scene.rods.emplace_back(std::vector{a, b},
                          std::vector{JointSpec{0, 1, {0, 0, 0.1}, {0, 0, -0.1}, Vector6::Zero(), std::nullopt}});
  return scene;
}

/// One iteration on the first rod.
ProjectionReport iterate(Scene& scene, const PbdStiffness& stiffness) {
  return PbdProjection(scene, stiffness).project(scene.rods[0], {}, 0.02, 0);
}

TEST_CASE("a shear gap closes by its stiffness, a stretched joint by the share that positions have") {
  const double r2 = 0.05 * 0.05, l2 = 0.2 * 0.2;
  const double turning = 2 * 12 / (3 * r2 + l2) * l2 / 4;  // i arm^2 of both sides, per w
  for (const double stiffness : {0.25, 1.0}) {
    Scene sheared = pair(), stretched = pair();
    sheared.rods[0].position[1].x() += 1e-6;
    stretched.rods[0].position[1].z() += 1e-6;
    CHECK(iterate(sheared, {stiffness, 0}).newton_residual == Approx(1e-6 / 0.2));
    iterate(stretched, {stiffness, 0});
    CHECK(0.2 * joint_gap(sheared.rods[0]) == Approx(1e-6 * (1 - stiffness)).margin(1e-11));
    CHECK(0.2 * joint_gap(stretched.rods[0]) == Approx(1e-6 * (1 - stiffness * 2 / (2 + turning))));
  }
}

TEST_CASE("bend and twist are undone by their stiffness") {
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 0, 1)})
    for (const double stiffness : {0.25, 1.0}) {
      Scene scene = pair();
      const double angle = 1e-3;
      scene.rods[0].orientation[1] = Quaternion(Eigen::AngleAxisd(angle, axis));
      CHECK(iterate(scene, {0, stiffness}).newton_residual == Approx(2 * std::sin(angle / 2)));
      const Quaternion& a = scene.rods[0].orientation[0];
      CHECK(a.angularDistance(scene.rods[0].orientation[1]) == Approx(angle * (1 - stiffness)).margin(1e-8));
      CHECK(a.angularDistance(Quaternion::Identity()) == Approx(angle * stiffness / 2).epsilon(1e-5));
    }
}

TEST_CASE("a heavy segment keeps its place") {
  Scene scene = pair();
  scene.rods[0].segments[0].inverse_mass = scene.rods[0].segments[0].inverse_inertia_transverse = 0;
  scene.rods[0].position[1].x() += 1e-6;
  iterate(scene, {1, 0});
  CHECK(scene.rods[0].position[0] == Vector3::Zero());
  CHECK(joint_gap(scene.rods[0]) < 1e-10);
}

TEST_CASE("without stiffness PBD does nothing") {
  const Scene start = test::moving_scene(6);
  const double dt = 0.02;
  const Scene scene = test::after<PbdProjection>(start, dt, 10, PbdStiffness{0, 0});
  for (std::size_t s = 1; s < scene.rods[0].segments.size(); ++s) {
    const Vector3 flown = start.rods[0].position[s] + dt * (start.rods[0].velocity[s] + dt * start.gravity_m_s2);
    CHECK((scene.rods[0].position[s] - flown).norm() < 1e-15);
  }
}

TEST_CASE("PBD knows no moduli: it is Newton's step only as they and the stretching stiffness grow without bound") {
  const double dt = 0.01;
  const auto cantilever = [](double modulus_pa) {
    BendingRod spec = test::bending_rod(4);
    spec.youngs_modulus_pa = spec.torsion_modulus_pa = modulus_pa;
    spec.stretch_compliance_per_j = 0;
    return build_scene(spec);
  };
  const Scene pbd = test::after<PbdProjection>(cantilever(1e4), dt, 20000, PbdStiffness{});
  const auto apart = [&](double modulus_pa) {
    return test::distance(pbd, test::after_newton(cantilever(modulus_pa), dt), &Rod::position);
  };
  CHECK(apart(1e4) > 1e-4);
  for (const double modulus : {1e13, 1e14}) CHECK(apart(modulus) / apart(10 * modulus) == Approx(10).epsilon(0.01));
  CHECK(apart(1e17) < 1e-9);
}

TEST_CASE("a free rigid rod moves under PBD as under Newton") {
  Scene start = pair();
  start.rods[0].velocity[1] = {0.3, 0.2, 0};
  start.rods[0].angular_velocity[0] = {1, 0, 0};
  double before = 0;
  for (const double dt : {0.004, 0.002, 0.001}) {
    const Scene pbd = test::after<PbdProjection>(start, dt, 5000, PbdStiffness{});
    const double apart = test::distance(pbd, test::after_newton(start, dt), &Rod::position);
    CHECK(joint_gap(pbd.rods[0]) < 1e-12);
    if (before > 0) CHECK(std::log2(before / apart) > 1.9);
    before = apart;
  }
}

TEST_CASE("more iterations make a PBD rod stiffer") {
  double sag = 3;
  for (const int iterations : {1, 4, 16, 64}) {
    Scene scene = build_scene(test::bending_rod(8));
    const double height = scene.rods[0].position.back().y();
    PbdProjection pbd(scene, {});
    TimeStepper stepper(scene, {0.02, iterations, 0});
    for (int step = 0; step < 400; ++step) stepper.step(pbd);
    const double now = height - scene.rods[0].position.back().y();
    CHECK(now < 0.9 * sag);
    sag = now;
  }
}

}  // namespace rodsweep::test_pbd
