// Sections other than solid circles, torques on tips and prescribed tips, against closed forms.
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_sections {

constexpr double momentum_tolerance = 1e-10;

BendingRod bar(int segments, const SectionShape& section) {
  BendingRod p;
  p.segments = segments;
  p.clamp = Clamp::wall;
  p.youngs_modulus_pa = 1e9;
  p.torsion_modulus_pa = 4e8;
  p.section = section;
  return p;
}

/// The same rod as without a section.
GivenSection numbers_of_circle(const RodParameters& p) {
  const CrossSection c = circle(p.radius_m, poisson_number(p.youngs_modulus_pa, p.torsion_modulus_pa));
  return {c.area_m2, c.second_moment_y_m4, c.second_moment_x_m4, c.torsion_constant_m4, c.shear_coefficient};
}

TEST_CASE("A cantilever of any section sags by w L^4 / 8 EI, upright in its height, sideways in its width") {
  const double angle = GENERATE(0.0, 35.0), g = 9.81 / 300, n = 20;
  for (const SectionShape& section :
       {SectionShape(Tube{0.004}), SectionShape(Ellipse{0.04, 0.09}), SectionShape(Rectangle{0.09, 0.04}),
        SectionShape(Rectangle{0.03, 0.08}), SectionShape(GivenSection{0.002, 3e-7, 5e-7, 6e-7, 0.8})}) {
    BendingRod p = bar(static_cast<int>(n), section);
    p.initial_angle_deg = angle;
    const CrossSection of = cross_section(p);
    const Vector3 along = p.vertex_m(p.segments).normalized(), up(-along.y(), along.x(), 0);
    for (const auto& [direction, moment] :
         {std::pair{up, of.second_moment_x_m4}, std::pair{Vector3(0, 0, 1), of.second_moment_y_m4}}) {
      p.gravity_m_s2 = -g * direction;
      Simulation simulation(build_scene(p), 1);
      simulation.relax();
      const double law = p.density_kg_m3 * of.area_m2 * g * std::pow(p.length_m, 4) / (8 * 1e9 * moment);
      const Vector3 sag = tip(simulation.rod()) - p.vertex_m(p.segments);
      CHECK(-sag.dot(direction) == Approx(law * (1 + 1 / (n * n))).epsilon(5e-5));
      CHECK(sag.cross(direction).norm() < 2e-2 * sag.norm());
    }
  }
}

TEST_CASE("A section with the numbers of a circle moves as a circle, whatever its frames") {
  BendingRod rod;
  rod.initial_angle_deg = 30;
  Helix helix;
  helix.segments = 40;
  Ring ring;
  ring.twist_deg = 300;
  ring.youngs_modulus_pa = 1e6;
  const auto positions = [](const SceneSpec& spec) {
    Simulation simulation(build_scene(spec), 0.01);
    simulation.run(20);
    return simulation.rod().position;
  };
  const auto check_same = [&](auto scene) {
    const std::vector<Vector3> plain = positions(scene);
    scene.section = numbers_of_circle(scene);
    const std::vector<Vector3> given = positions(scene);
    REQUIRE((plain.back() - build_scene(scene).rods.front().position.back()).norm() > 1e-3);
    for (std::size_t s = 0; s < plain.size(); ++s) CHECK((plain[s] - given[s]).norm() < 1e-9);
  };
  SECTION("rod") check_same(rod);
  SECTION("helix") check_same(helix);
  SECTION("ring") check_same(ring);
}

TEST_CASE("The heights of sections point upwards in a rod, outwards in a helix and a ring") {
  const auto height = [](const Rod& rod, std::size_t s) { return Vector3(rod.orientation[s] * Vector3::UnitY()); };
  BendingRod rod = bar(5, Rectangle{0.01, 0.02});
  rod.initial_angle_deg = 90;
  CHECK((height(build_scene(rod).rods.front(), 3) - Vector3(-1, 0, 0)).norm() < 1e-12);
  Helix helix;
  helix.section = Rectangle{0.01, 0.02};
  const Rod wound = build_scene(helix).rods.front();
  Ring ring;
  ring.section = Rectangle{0.01, 0.02};
  const Rod closed = build_scene(ring).rods.front();
  const Vector3 centre = (closed.position[0] + closed.position[15]) / 2;
  for (std::size_t s = 0; s < 30; ++s) {
    const Vector3 out(wound.position[s].x(), 0, wound.position[s].z());
    CHECK((height(wound, s) - out.normalized()).norm() < 1e-12);
    CHECK((height(closed, s) - (closed.position[s] - centre).normalized()).norm() < 1e-12);
  }
}

TEST_CASE("A torque twists a rod by T L / GJ") {
  const Integrator integrator = GENERATE(Integrator::euler, Integrator::bdf2);
  const int n = 20;
  BendingRod p = bar(n, Rectangle{0.05, 0.03});
  p.gravity_m_s2.setZero();
  p.damping_per_s = 15;  // twice the frequency of the first mode
  const double angle = 0.4;
  p.tip_torque_nm.x() = angle * stiffness(p).torsion_nm2 / p.length_m;
  const Scene scene = build_scene(p);
  Simulation simulation(scene, {0.02, 30, 1e-12, integrator}, momentum_tolerance);
  simulation.run(300);
  const Rod& rod = simulation.rod();
  REQUIRE(rod.velocity.back().norm() < 1e-9);
  CHECK((tip(rod) - p.vertex_m(p.segments)).norm() < 1e-9);
  const double joints = p.length_m * (1 - 0.5 / n);  // the last half segment bears no joint
  const Quaternion turn = rod.orientation.back() * scene.rods.front().orientation.back().conjugate();
  CHECK(2 * std::atan2(turn.x(), turn.w()) == Approx(angle * joints / p.length_m).epsilon(1e-3));
}

/// Deflection at the middle of a clamped rod whose ends were moved together by a fraction of its length, over L.
double buckled(double fraction, int segments) {
  BendingRod p;
  p.segments = segments;
  p.clamp = Clamp::wall;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1e7;
  p.radius_m = 0.02;
  p.gravity_m_s2 = Vector3(0, -1e-3, 0);
  p.damping_per_s = 3;
  p.tip_motion = TipMotion{Vector3(-fraction * p.length_m, 0, 0), Vector3::Zero(), 1};
  Simulation simulation(build_scene(p), 0.02, 30);
  simulation.run(600);
  CHECK((tip(simulation.rod()) - Vector3((1 - fraction) * p.length_m, 0, 0)).norm() < 1e-12);
  return std::abs(simulation.rod().position[static_cast<std::size_t>(segments + 1) / 2].y()) / p.length_m;
}

TEST_CASE("A rod with slack between clamped ends has the shape of the elastica") {
  // Four equal quarters between inflections and clamps: ends 2 E / K - 1 of the length apart, middle at k / K.
  const double fraction = 0.3;
  const auto apart = [&](double k) {
    return 2 * boost::math::ellint_2(k) / boost::math::ellint_1(k) - 1 - (1 - fraction);
  };
  boost::uintmax_t most = 100;
  const auto [low, high] =
      boost::math::tools::toms748_solve(apart, 1e-3, 0.99, boost::math::tools::eps_tolerance<double>(40), most);
  const double k = (low + high) / 2, middle = k / boost::math::ellint_1(k);
  const double coarse = buckled(fraction, 15) - middle, fine = buckled(fraction, 31) - middle;
  CAPTURE(middle, coarse, fine);
  CHECK(std::abs(fine) < 1e-3 * middle);
  CHECK(coarse / fine > 3.5);
}

TEST_CASE("A light, stiff rod whose ends are pushed together does not stretch") {
  BendingRod wire;
  wire.segments = 20;
  wire.clamp = Clamp::wall;
  wire.length_m = 0.1;
  wire.radius_m = 1e-3;
  wire.density_kg_m3 = 7850;
  wire.youngs_modulus_pa = 2e11;
  wire.torsion_modulus_pa = 8e10;
  wire.damping_per_s = 20;
  wire.tip_motion = TipMotion{Vector3(-0.06, 0, 0), Vector3::Zero(), 0.5};
  Simulation simulation(build_scene(wire), 0.01, 30);
  simulation.run(100);
  CHECK(joint_gap(simulation.rod()) < 1e-6);
}

TEST_CASE("Sections and tips that cannot be are refused by what is wrong with them") {
  BendingRod p = bar(10, Tube{0.06});
  CHECK_THROWS_WITH(validate(p), "section.wall_m is 0.06; must be at most radius_m, 0.050000");
  p.section = Rectangle{1e-200, 1e-200};
  CHECK_THROWS_WITH(validate(p), Catch::Matchers::StartsWith("section: the area [m^2] is 0; must be a number"));
  p.section = Tube{1e-19};  // thin, but its area is not lost in the difference of two circles
  CHECK_NOTHROW(validate(p));
  Ring ring;
  ring.section = Rectangle{0.01, 0.02};
  ring.twist_deg = 90;
  CHECK_THROWS_WITH(validate(ring),
                    Catch::Matchers::StartsWith("twist_deg is 90.000000; must be 0 for a \"section\" that bends"));
  p.section.reset();
  p.tip_motion = TipMotion{Vector3(0, 0.1, 0), Vector3::Zero(), 1};
  CHECK_THROWS_WITH(validate(p), Catch::Matchers::StartsWith("tip_motion moves the ends of the free part 2.002") &&
                                     Catch::Matchers::ContainsSubstring("at most its length, 2.0"));
  BendingRod folded = p;
  folded.clamp = Clamp::segment;
  folded.tip_motion = TipMotion{Vector3::Zero(), Vector3(0, 0, 360), 1};  // the tip returns, but half-way it is folded
  CHECK_THROWS_WITH(validate(folded), Catch::Matchers::ContainsSubstring("free part 2.0") &&
                                          Catch::Matchers::ContainsSubstring("at most its length, 1.6"));
  folded.tip_motion = TipMotion{Vector3(-0.4, 0, 0), Vector3(360, 0, 0), 1};
  CHECK_NOTHROW(validate(folded));
  Helix far;
  far.tip_motion = TipMotion{Vector3(100, 0, 0), Vector3::Zero(), 1};
  CHECK_THROWS_WITH(validate(far), Catch::Matchers::ContainsSubstring("free part 99.1"));
  p.stretch = Stretch::physical;
  CHECK_NOTHROW(validate(p));
  p.tip_torque_nm.x() = 1;
  CHECK_THROWS_WITH(validate(p), Catch::Matchers::ContainsSubstring("tip_motion is given with a load on the tip"));
  p.tip_torque_nm.setZero();
  p.clamp = Clamp::segment;
  p.segments = 2;
  CHECK_THROWS_WITH(validate(p),
                    Catch::Matchers::StartsWith("segments is 2; must be at least 3: the clamp \"segment\""));
}

}  // namespace rodsweep::test_validation_sections
