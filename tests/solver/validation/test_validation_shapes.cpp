// Curved rest shapes and non-circular cross-sections: closed forms and invariances.
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/step/observables.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_validation_shapes {

/// A wall-clamped straight rod of n segments along +x with this section and this rest curvature (radians per metre of
/// joint, local frame). Local x is along `local_x`.
Rod rod_with(int n, double length, const Section& section, const Vector3& rest_curvature,
             const Vector3& local_x = Vector3::UnitY()) {
  BendingRod p;
  p.segments = n;
  p.length_m = length;
  p.clamp = Clamp::wall;
  Rod rod = build_scene(p).rods.front();
  Matrix3 frame;
  frame << local_x, Vector3::UnitX().cross(local_x), Vector3::UnitX();
  for (Quaternion& q : rod.orientation) q = Quaternion(frame);
  for (Joint& joint : rod.joints) {
    joint.compliance = joint_compliance(joint.length, section, inextensible_compliance(joint.length, 1000));
    const double turn = rest_curvature.norm() * joint.length;
    set_rest(joint,
             turn > 0 ? Quaternion(Eigen::AngleAxisd(turn, rest_curvature.normalized())) : Quaternion::Identity());
  }
  return rod;
}

Scene scene_of(const Rod& rod, const Vector3& gravity) {
  Scene scene = test::scene_of(rod);
  scene.gravity_m_s2 = gravity;
  return scene;
}

TEST_CASE("A straight rod with a curved rest shape curls into an arc of that curvature, and stays there") {
  const double curvature = 0.9, l = 2.0 / 20;
  const Section section = circular_section(0.05, 1e7, 4e6);
  Simulation simulation(scene_of(rod_with(20, 2, section, {curvature, 0, 0}), Vector3::Zero()), 0.05);
  simulation.relax(1e-12);
  const Rod arc = simulation.rod();
  CHECK(elastic_energy(arc) < 1e-12);
  for (std::size_t s = 2; s < arc.position.size(); ++s) {
    const double turn = std::acos(director(arc.orientation[s]).dot(director(arc.orientation[s - 1])));
    CHECK(turn == Approx(curvature * l).epsilon(1e-6));
    CHECK(director(arc.orientation[s]).dot(arc.orientation[0] * Vector3::UnitX()) == Approx(0).margin(1e-9));  // planar
  }
  simulation.run(100);
  for (std::size_t s = 0; s < arc.position.size(); ++s)
    CHECK((simulation.rod().position[s] - arc.position[s]).norm() < 1e-10);
}

TEST_CASE("A cantilever whose axes are askew to its weight sags sideways too, as unsymmetric bending says") {
  const Section flat = stiffness(ellipse(0.16, 0.08, 0.25), 1e9, 4e8);
  const double area = pi * 0.05 * 0.05, w = 1000 * area * 9.81 / 300, length = 2;
  const int n = 40;
  const double law = 1 + 1.0 / (n * n);
  const double angle = 0.5;  // of local x from +z, about the rod
  const Vector3 local_x(0, std::sin(angle), std::cos(angle)), local_y = Vector3::UnitX().cross(local_x);
  Simulation simulation(scene_of(rod_with(n, length, flat, Vector3::Zero(), local_x), Vector3(0, -9.81 / 300, 0)), 1);
  simulation.relax();
  // A load along local y bends about local x, and vice versa.
  const Vector3 load = w * std::pow(length, 4) / 8 * law * -Vector3::UnitY();
  const Vector3 expected =
      load.dot(local_y) / flat.bending_x_nm2 * local_y + load.dot(local_x) / flat.bending_y_nm2 * local_x;
  REQUIRE(std::abs(expected.z()) > 0.1 * std::abs(expected.y()));
  CHECK(tip(simulation.rod()).y() == Approx(expected.y()).epsilon(1e-3));
  CHECK(tip(simulation.rod()).z() == Approx(expected.z()).epsilon(1e-3));
}

}  // namespace rodsweep::test_validation_shapes
