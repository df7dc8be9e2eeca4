// Rods at and beyond the loads at which they buckle, in balance: a heavy column, a twisted rod, a long twisted rod whose
// ends approach each other.
#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "solver/rod/joint_forces.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/static_rod.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_validation_buckling {

/// Gravity on a column of EI = 1 and L = 1, for w L^3 / EI; it leans by .01 rad towards x.
Vector3 leaning_load(double gamma) { return gamma * Vector3(std::sin(0.01), -std::cos(0.01), 0); }

Vector3 column_tip(double gamma, int segments) {
  BendingRod p = weightless_cantilever(segments, 1e7, 4e6, 1, 0.01);
  p.initial_angle_deg = 90;
  const double line_density = p.density_kg_m3 * cross_section(p).area_m2;
  p.gravity_m_s2 = leaning_load(gamma) * stiffness(p).bending_x_nm2 / line_density;
  Simulation simulation(build_scene(p), 1, 40, 1e-10);
  simulation.relax();
  return tip(simulation.rod());
}

TEST_CASE("A heavy column bends as the theory of rods says, below its own buckling weight and beyond it") {
  for (const double gamma : {7.5, 9.0, 12.0}) {  // critical at 7.837 (Greenhill 1881)
    StaticRod column;
    column.clamp << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // z along y
    column.force_per_m = leaning_load(gamma);
    const Vector3 exact = column.tip();
    const double coarse = (column_tip(gamma, 30) - exact).norm(), fine = (column_tip(gamma, 60) - exact).norm();
    CAPTURE(gamma, exact.transpose(), coarse, fine);
    CHECK(fine < 1.2e-3);
    CHECK(order(coarse, fine) == Approx(2).margin(0.05));
  }
}

constexpr double greenhill = 8.98682;  // buckling moment of a clamped rod, times L / EI (Greenhill 1883)

/// Relative change in a step of a small disturbance of a rod twisted by `part` of Greenhill's moment between two clamps:
/// -dt^2 k / m of its softest mode, which is zero where the straight rod becomes unstable.
double growth(int segments, double part) {
  RodParameters p;
  p.radius_m = 0.005;
  p.youngs_modulus_pa = 1e9;
  p.torsion_modulus_pa = 5e8;  // EI = GJ
  std::vector<SegmentSpec> specs = segments_through(straight_line(Vector3::Zero(), Vector3::UnitX(), segments), p);
  specs.insert(specs.begin(), held_point(Vector3::Zero(), specs.front().orientation));
  specs.push_back(held_point(Vector3::UnitX(), specs.back().orientation));
  for (SegmentSpec& s : specs)
    s.orientation = Eigen::AngleAxisd(part * greenhill * s.position_m.x(), Vector3::UnitX()) * s.orientation;
  Scene scene = test::scene_of(chain(specs, p, 1, true));
  scene.gravity_m_s2.setZero();
  for (Vector3& x : scene.rods.front().position) x.y() = 1e-6 * std::pow(std::sin(pi * x.x()), 2);
  Simulation simulation(scene, 0.02, 40, 1e-12);
  const auto deflection = [&] {
    double most = 0;
    for (const Vector3& x : simulation.rod().position) most = std::max(most, std::hypot(x.y(), x.z()));
    return most;
  };
  for (int i = 0; i < 60; ++i) simulation.relax_once();
  const double before = deflection();
  for (int i = 0; i < 10; ++i) simulation.relax_once();
  return 1 - std::pow(before / deflection(), 0.1);
}

/// The critical twist over Greenhill's.
double critical_part(int segments) {
  boost::uintmax_t most = 20;
  const auto [low, high] = boost::math::tools::toms748_solve([&](double part) { return growth(segments, part); }, 0.99,
                                                             1.01, boost::math::tools::eps_tolerance<double>(20), most);
  return (low + high) / 2;
}

TEST_CASE("A clamped rod buckles at Greenhill's twist, with an error of second order") {
  const double coarse = critical_part(30) - 1, fine = critical_part(60) - 1;
  CAPTURE(coarse, fine);
  CHECK(std::abs(fine) < 3e-4);
  CHECK(order(coarse, fine) == Approx(2).margin(0.1));
}

/// Localised helical buckling (Coyne 1990; van der Heijden & Thompson 2000): away from the ends, the angle phi between
/// the tangent and the axis obeys
///   (cos phi - cos phi0) / (1 - cos phi0) = tanh^2(s / s*),  s* = (2 EI / M) sqrt((1 + cos phi0) / (1 - cos phi0)),
///   M^2 = 2 EI T (1 + cos phi0),
/// with the largest angle phi0 at s = 0, the twisting moment M and the tension T.
struct Localised {
  double largest_angle;   ///< phi0
  double envelope_error;  ///< largest deviation from tanh^2
  double tension_error;   ///< relative error of M^2
};

/// Ends approach by a twentieth and turn by 9.02 rad; s* is about a twentieth of the length.
Localised localised(int n) {
  const double length = 4, l = length / n, loading_s = 2, shortening = 0.2, end_turn = 9.02;
  RodParameters p;
  p.radius_m = 0.01;
  p.youngs_modulus_pa = 1e9;
  p.torsion_modulus_pa = 5e9;  // GJ = 10 EI
  std::vector<SegmentSpec> specs = segments_through(straight_line(Vector3::Zero(), length * Vector3::UnitX(), n), p);
  specs.front().is_static = specs.back().is_static = true;
  Scene scene = test::scene_of(chain(specs, p, 1000));
  scene.gravity_m_s2.setZero();
  scene.damping_per_s = 5;
  Rod& start = scene.rods.front();
  for (std::size_t s = 1; s + 1 < specs.size(); ++s)  // where it buckles, and to which side
    start.position[s].y() = 1e-4 * std::exp(-std::pow((start.position[s].x() - length / 2) / 0.2, 2));
  scene.clamps.push_back({0, n - 1, [=, last = specs.back()](double time_s) {
                            const double part = std::min(1.0, time_s / loading_s);
                            return Pose{last.position_m - part * shortening * Vector3::UnitX(),
                                        Eigen::AngleAxisd(part * end_turn, Vector3::UnitX()) * last.orientation};
                          }});
  Simulation simulation(scene, 0.002, 40, 1e-8);  // at 4 ms, 200 segments do not reach the balance
  for (int step = 0; step < 2000; ++step) REQUIRE(simulation.step().balanced);
  const Rod& rod = simulation.rod();
  std::vector<double> cosine;
  for (const Quaternion& q : rod.orientation) cosine.push_back(director(q).x());
  const auto lowest = std::min_element(cosine.begin() + 1, cosine.end() - 1);
  const double before = lowest[-1], here = lowest[0], after = lowest[1], bend = before - 2 * here + after;
  const double offset = (before - after) / (2 * bend), cosine0 = here - bend * offset * offset / 2;
  const double centre = static_cast<double>(lowest - cosine.begin()) + offset;

  const double stiffness_nm2 = stiffness(p).bending_x_nm2;
  const Action end = joint_action(rod, 0);
  const double moment = end.moment_nm.x(), tension = end.force_n.x();
  const double scale = 2 * stiffness_nm2 / std::abs(moment) * std::sqrt((1 + cosine0) / (1 - cosine0));
  Localised out{std::acos(cosine0), 0, moment * moment / (2 * stiffness_nm2 * tension * (1 + cosine0)) - 1};
  for (std::size_t s = 0; s < cosine.size(); ++s) {
    const double law = std::pow(std::tanh((static_cast<double>(s) - centre) * l / scale), 2);
    out.envelope_error = std::max(out.envelope_error, std::abs((cosine[s] - cosine0) / (1 - cosine0) - law));
  }
  return out;
}

// Long: at 2 ms it takes 4000 steps, and both numbers of segments show the order.
TEST_CASE("A long twisted rod buckles into a localised helix, with an error of second order", "[.long]") {
  const Localised coarse = localised(100), fine = localised(200);
  CAPTURE(coarse.envelope_error, fine.envelope_error, fine.largest_angle, fine.tension_error);
  CHECK(fine.largest_angle > 1);
  CHECK(fine.envelope_error < 5e-3);
  CHECK(order(coarse.envelope_error, fine.envelope_error) == Approx(2).margin(0.2));
  CHECK(std::abs(fine.tension_error) < 2e-3);
}

}  // namespace rodsweep::test_validation_buckling
