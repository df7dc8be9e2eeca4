// Large static shapes: a bent rod, a rolled-up one, curved rest shapes, a section askew to its load, a hanging chain.
// Rods come to rest by relaxation (simulation.hpp), in balance.
#include <algorithm>
#include <cmath>

#include "solver/rod/joint_forces.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/static_rod.hpp"
#include "tests/solver/support.hpp"
#include "tests/solver/turned.hpp"

namespace rodsweep::test_validation_shapes {

/// The scene's rod at rest. Loads with this schedule grow within ten steps.
Rod at_rest(const Scene& scene, double dt, double motion = 1e-9) {
  Simulation simulation(scene, dt, 40, 1e-10);
  simulation.relax(motion);
  return simulation.rod();
}
Schedule growing(double dt) { return {{0, 10 * dt}, {0, 1}}; }

/// The bend of Bathe & Bolourchi 1979: an eighth of a circle from the origin along y towards x, clamped there, with a
/// force along z at its end. The section is a square of side 1.
struct Bend {
  double torsion_constant;
  Stretch stretch;
  static constexpr double radius = 100, force = 600, e = 1e7, g = 5e6, second_moment = 1.0 / 12, kappa = 5.0 / 6;

  Vector3 tip(int segments) const {
    RodParameters p;
    p.section = GivenSection{1, second_moment, second_moment, torsion_constant, kappa};
    p.density_kg_m3 = 1;
    p.youngs_modulus_pa = e;
    p.torsion_modulus_pa = g;
    p.stretch = stretch;
    std::vector<Vector3> vertices;
    for (int i = 0; i <= segments; ++i) {
      const double angle = pi / 4 * i / segments;
      vertices.emplace_back(radius * (1 - std::cos(angle)), radius * std::sin(angle), 0);
    }
    std::vector<SegmentSpec> specs = segments_through(vertices, p);
    specs.insert(specs.begin(), held_point(vertices.front(), specs.front().orientation));
    Scene scene = test::scene_of(chain(specs, p, force));
    scene.gravity_m_s2.setZero();
    const double dt = 1;
    const Vector3 arm(0, 0, specs.back().length_m / 2);
    scene.loads.push_back({0, segments, {0, 0, force}, Vector3::Zero(), arm, growing(dt)});
    return rodsweep::tip(at_rest(scene, dt, 1e-8));
  }

  Vector3 exact_tip() const {
    StaticRod rod;
    rod.length_m = radius * pi / 4;
    rod.clamp << 0, 1, 0, 0, 0, 1, 1, 0, 0;  // z along y, y along x
    if (stretch == Stretch::physical) rod.stretch_per_n = {1 / (kappa * g), 1 / (kappa * g), 1 / e};
    rod.bend_per_nm2 = {1 / (e * second_moment), 1 / (e * second_moment), 1 / (g * torsion_constant)};
    rod.rest_curvature_per_m = {-1 / radius, 0, 0};
    rod.tip_force_n = {0, 0, force};
    return rod.tip();
  }

  double error(int segments) const { return (tip(segments) - exact_tip()).norm() / radius; }
};

TEST_CASE("The 45 degree bend of Bathe and Bolourchi has its end where the theory of rods has it") {
  const Bend published{1.0 / 6, Stretch::physical};  // with GJ = EI as Simo & Vu-Quoc 1986
  CHECK((published.exact_tip() - Vector3(15.685, 47.150, 53.475)).norm() < 1e-3);
  CHECK(published.error(64) < 1.2e-4);
  CHECK(Bend{0.141, Stretch::physical}.error(64) < 1.2e-4);  // J of a square
  const Bend inextensible{1.0 / 6, Stretch::inextensible};
  const double coarse = inextensible.error(32), fine = inextensible.error(64);
  CAPTURE(coarse, fine);
  CHECK(fine < 1.2e-4);
  CHECK(order(coarse, fine) == Approx(2).margin(0.1));
}

/// The end of a flat rod, over its length, that an end moment rolls up by whole turns: zero in the limit.
double rolled_up(int segments, double turns) {
  BendingRod p = weightless_cantilever(segments, 1e9, 4e8, 1);
  p.section = Rectangle{0.05, 0.005};
  Scene scene = build_scene(p);
  const double dt = 0.5, moment = 2 * pi * turns * stiffness(p).bending_x_nm2 / p.length_m;
  scene.loads.push_back({0, segments, Vector3::Zero(), {0, 0, moment}, Vector3::Zero(), growing(dt)});
  const Vector3 end = tip(at_rest(scene, dt)) / p.length_m;
  CHECK(std::abs(end.z()) < 1e-12);
  return end.norm();
}

TEST_CASE("An end moment rolls a flat cantilever up to one full turn and to two, with an error of second order") {
  for (const int turns : {1, 2}) {
    const double coarse = rolled_up(40 * turns, turns), fine = rolled_up(80 * turns, turns);
    CAPTURE(turns, coarse, fine);
    CHECK(fine < 1.1e-3);
    CHECK(order(coarse, fine) == Approx(2).margin(0.05));
  }
}

/// How far the end leaves the plane, over the length, as an end moment rolls a rod up by a full turn in four seconds and
/// holds it there for four. A small force across the plane disturbs it meanwhile.
double out_of_plane(BendingRod p) {
  p.damping_per_s = 1;
  Scene scene = build_scene(p);
  const double moment = 2 * pi * stiffness(p).bending_x_nm2 / p.length_m;
  const int last = p.segments;
  scene.loads.push_back({0, last, Vector3::Zero(), {0, 0, moment}, Vector3::Zero(), {{0, 4}, {0, 1}}});
  scene.loads.push_back({0, last, {0, 0, 1e-4 * moment}, Vector3::Zero(), Vector3::Zero(), {{4, 4.01}, {1, 0}}});
  Simulation simulation(scene, StepSettings{0.01, 30, 1e-12, Integrator::bdf2}, 1e-9);
  double farthest = 0;
  for (int step = 0; step < 800; ++step) {
    simulation.step();
    farthest = std::max(farthest, std::abs(tip(simulation.rod()).z()) / p.length_m);
  }
  return farthest;
}

TEST_CASE("A moment of fixed axis that rolls up a flat rod throws a round one out of the plane") {
  BendingRod flat = weightless_cantilever(40, 1e9, 4e8, 1), round = flat;
  flat.section = Rectangle{0.05, 0.005};
  round.radius_m = 0.0029;
  CHECK(out_of_plane(flat) < 2e-4);
  CHECK(out_of_plane(round) > 0.3);
}

TEST_CASE("A straight rod with a curved rest shape curls into an arc of that curvature") {
  const double curvature = 0.9;
  const BendingRod p = weightless_cantilever(20, 1e7, 4e6);
  Scene scene = build_scene(p);
  const Quaternion clamp = scene.rods.front().orientation.front();
  for (Joint& joint : scene.rods.front().joints)
    set_rest(joint, Quaternion(Eigen::AngleAxisd(curvature * joint.length, Vector3::UnitX())));
  const Rod arc = at_rest(scene, 0.05, 1e-12);
  double heading = 0;
  for (const Joint& joint : arc.joints) {
    heading += curvature * joint.length;
    const Vector3 expected = clamp * Vector3(0, -std::sin(heading), std::cos(heading));
    CHECK((director(arc.orientation[at(joint.b)]) - expected).norm() < 1e-9);
  }
  CHECK(heading == Approx(curvature * p.length_m * (1 - 0.5 / p.segments)));
}

TEST_CASE("A cantilever whose section is askew to its weight sags sideways too, as unsymmetric bending says") {
  const double n = 40;
  BendingRod p = weightless_cantilever(static_cast<int>(n), 1e9, 4e8);
  p.section = Rectangle{0.03, 0.08};
  p.gravity_m_s2.y() = -9.81 / 300;
  Scene scene = build_scene(p);
  Rod& rod = scene.rods.front();
  rod = test::rolled(rod, 0.5);
  const Vector3 width = rod.orientation[0] * Vector3::UnitX(), height = rod.orientation[0] * Vector3::UnitY();
  const Section section = stiffness(p);
  const Vector3 load = p.density_kg_m3 * cross_section(p).area_m2 * p.gravity_m_s2;
  const Vector3 expected =
      std::pow(p.length_m, 4) / 8 * (1 + 1 / (n * n)) *
      (load.dot(height) / section.bending_x_nm2 * height + load.dot(width) / section.bending_y_nm2 * width);
  REQUIRE(std::abs(expected.z()) > std::abs(expected.y()));
  const Vector3 sag = tip(at_rest(scene, 1)) - p.vertex_m(p.segments);
  CAPTURE(sag.transpose(), expected.transpose());
  CHECK((sag - expected).cross(Vector3::UnitX()).norm() < 1e-5 * expected.norm());
}

struct Hanging {
  double sag_m, end_tension_m;  ///< the tension over the weight per length
};

/// A chain without stiffness between two points at one height, relaxed from a V.
Hanging hanging_chain(double span, double length, int segments) {
  RodParameters p;
  p.radius_m = 0.01;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1;  // EI / w L^3 < 3e-9
  const Vector3 end(span, 0, 0), lowest = end / 2 - std::sqrt(length * length - span * span) / 2 * Vector3::UnitY();
  const int half = segments / 2;
  std::vector<Vector3> vertices = straight_line(Vector3::Zero(), lowest, half);
  for (int i = 1; i <= half; ++i) vertices.push_back(lowest + static_cast<double>(i) / half * (end - lowest));
  std::vector<SegmentSpec> specs = segments_through(vertices, p);
  specs.insert(specs.begin(), held_point(vertices.front(), specs.front().orientation));
  specs.push_back(held_point(vertices.back(), specs.back().orientation));
  const Rod rod = at_rest(test::scene_of(chain(specs, p, weight(specs, p), true)), 0.02);
  return {-point_on_a(rod, rod.joints[at(half)]).y(),
          joint_action(rod, 0).force_n.norm() / (p.density_kg_m3 * cross_section(p).area_m2 * 9.81)};
}

TEST_CASE("A chain between two points hangs in a catenary, with an error of second order") {
  for (const double a : {0.3, 1.0}) {  // y = a cosh(x / a), tension w y
    const double span = 1, high = a * std::cosh(span / 2 / a), length = 2 * a * std::sinh(span / 2 / a);
    const Hanging coarse = hanging_chain(span, length, 40), fine = hanging_chain(span, length, 80);
    const auto check = [&](double Hanging::*of, double expected) {
      const double error = coarse.*of / expected - 1, finer = fine.*of / expected - 1;
      CAPTURE(a, error, finer);
      CHECK(std::abs(finer) < 1.2e-4);
      CHECK(order(error, finer) == Approx(2).margin(0.05));
    };
    check(&Hanging::sag_m, high - a);
    check(&Hanging::end_tension_m, high);
  }
}

}  // namespace rodsweep::test_validation_shapes
