// Geometry of cross-sections, and the mass of their segments.
#include <cmath>

#include "solver/rod/rod.hpp"
#include "tests/catch.hpp"

namespace rodsweep::test_cross_section {

void check_equal(const CrossSection& a, const CrossSection& b, double epsilon) {
  CHECK(a.area_m2 == Approx(b.area_m2).epsilon(epsilon));
  CHECK(a.second_moment_x_m4 == Approx(b.second_moment_x_m4).epsilon(epsilon));
  CHECK(a.second_moment_y_m4 == Approx(b.second_moment_y_m4).epsilon(epsilon));
  CHECK(a.torsion_constant_m4 == Approx(b.torsion_constant_m4).epsilon(epsilon));
  CHECK(a.shear_coefficient == Approx(b.shear_coefficient).epsilon(epsilon));
}

TEST_CASE("Timoshenko's shear coefficient of a circle is that of Poisson's number, kept within 0 and 1/2") {
  const auto coefficient = [](double e, double g) { return circle(0.3, poisson_number(e, g)).shear_coefficient; };
  CHECK(coefficient(2.6, 1) == Approx(10.14 / 10.96).epsilon(1e-12));  // nu = 0.3
  CHECK(coefficient(2, 1) == Approx(6.0 / 7));
  CHECK(coefficient(1e4, 1e6) == Approx(6.0 / 7));
  CHECK(coefficient(3, 1) == Approx(13.5 / 14));
  CHECK(coefficient(1e9, 1e4) == Approx(13.5 / 14));
}

TEST_CASE("a tube is a circle less its hole; thin walls have the limits of thin walls") {
  const double nu = 0.3, outer = 0.05;
  check_equal(tube(outer, outer, nu), circle(outer, nu), 1e-14);
  const CrossSection hollow = tube(outer, 0.02, nu), whole = circle(outer, nu), hole = circle(0.03, nu);
  CHECK(hollow.area_m2 == Approx(whole.area_m2 - hole.area_m2));
  CHECK(hollow.second_moment_x_m4 == Approx(whole.second_moment_x_m4 - hole.second_moment_x_m4));
  CHECK(hollow.torsion_constant_m4 == Approx(whole.torsion_constant_m4 - hole.torsion_constant_m4));
  const double wall = 1e-6, middle = outer - wall / 2;
  check_equal(tube(outer, wall, nu),
              {2 * pi * middle * wall, pi * std::pow(middle, 3) * wall, pi * std::pow(middle, 3) * wall,
               2 * pi * std::pow(middle, 3) * wall, (1 + nu) / (2 + nu)},
              1e-8);
}

TEST_CASE("an ellipse with equal axes is a circle; its moments are those of its axes") {
  check_equal(ellipse(0.04, 0.04, 0.2), circle(0.02, 0.2), 1e-14);
  const CrossSection flat = ellipse(0.06, 0.02, 0.2);
  CHECK(flat.area_m2 == Approx(pi * 3e-4));
  CHECK(flat.second_moment_x_m4 == Approx(pi * 0.03 * 1e-6 / 4));
  CHECK(flat.second_moment_y_m4 == Approx(pi * 0.01 * 27e-6 / 4));
  CHECK(flat.torsion_constant_m4 == Approx(pi * 27e-6 * 1e-6 / (9e-4 + 1e-4)));
}

TEST_CASE("a rectangle has Saint-Venant's torsion, whichever side is longer") {
  // Roark's table of J / (long short^3).
  for (const auto& [ratio, factor] : {std::pair{1.0, 0.140577}, {2.0, 0.228682}, {10.0, 0.312325}, {100.0, 0.331233}}) {
    const CrossSection lying = rectangle(0.01 * ratio, 0.01, 0.3), standing = rectangle(0.01, 0.01 * ratio, 0.3);
    CHECK(lying.torsion_constant_m4 == Approx(factor * ratio * 1e-8).epsilon(1e-5));
    CHECK(standing.torsion_constant_m4 == lying.torsion_constant_m4);
    CHECK(lying.second_moment_x_m4 == Approx(ratio * 1e-8 / 12));
    CHECK(lying.second_moment_y_m4 == Approx(std::pow(ratio, 3) * 1e-8 / 12));
    CHECK(standing.second_moment_y_m4 == Approx(lying.second_moment_x_m4));
  }
  CHECK(rectangle(1, 2, 0).shear_coefficient == Approx(5.0 / 6));
}

TEST_CASE("a segment's mass and inertia are those of its section") {
  SegmentSpec spec;
  spec.length_m = 0.2;
  spec.radius_m = 0.05;
  spec.density_kg_m3 = 700;
  const Segment solid = Rod({spec}, {}).segments[0];
  CHECK(solid.mass == Approx(700 * pi * 0.0025 * 0.2));
  CHECK(solid.inertia_axial == Approx(solid.mass * 0.0025 / 2));
  CHECK(solid.inverse_mass * solid.mass == Approx(1));
  CHECK(solid.inverse_inertia_transverse * solid.inertia_transverse == Approx(1));
  CHECK(solid.inverse_inertia_axial * solid.inertia_axial == Approx(1));
  CHECK(solid.inertia_transverse == Approx(solid.mass * (3 * 0.0025 + 0.04) / 12));
  spec.section = rectangle(0.03, 0.06, 0.3);
  const Segment bar = Rod({spec}, {}).segments[0];
  CHECK(bar.mass == Approx(700 * 0.0018 * 0.2));
  CHECK(bar.inertia_axial == Approx(bar.mass * (9e-4 + 36e-4) / 12));
  CHECK(bar.inertia_transverse == Approx(bar.mass * 0.04 / 12 + bar.inertia_axial / 2));
  CHECK(bar.radius_m == 0.05);
}

}  // namespace rodsweep::test_cross_section
