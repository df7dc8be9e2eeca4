// Localised helical buckling of a long twisted rod whose clamped ends approach each other (Coyne 1990; van der
// Heijden & Thompson 2000). Away from the ends, the angle phi between tangent and axis obeys
//   (cos phi - cos phi0) / (1 - cos phi0) = tanh^2(s / s*),  s* = (2 EI / M) sqrt((1 + cos phi0) / (1 - cos phi0)),
//   M^2 = 2 EI T (1 + cos phi0),
// with the largest angle phi0 at s = 0, the twisting moment M and the tension T.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/numbers/rotation.hpp"
#include "solver/rod/linearization.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_buckling {

constexpr double length = 4, radius = 0.01, youngs_modulus = 1e9, torsion_modulus = 5e9;  // GJ = 10 EI
constexpr double shortening = 0.2, end_turn = 9.02;  // phi0 is near 60 degrees, s* = L / 20
// Newton ignores how forces turn with the rod: at steps of 3 ms the twisting moment spins the rod without end. The
// helix is free to move along the rod and creeps by micrometres a step, so a tolerance would not end the relaxation.
constexpr double loading_time = 2, step = 1e-3;
constexpr int settling_steps = 2000;

Scene twisted_rod(int n) {
  const double l = length / n;
  RodParameters p;
  p.radius_m = radius;
  p.youngs_modulus_pa = youngs_modulus;
  p.torsion_modulus_pa = torsion_modulus;
  Scene scene;
  scene.gravity_m_s2.setZero();
  scene.rods.push_back(rod_held_at_both_ends(n, length, p, 1000));
  const Vector3 end = scene.rods[0].position.back();
  const Quaternion along_x = scene.rods[0].orientation.back();
  // A small disturbance selects the side and the place of buckling.
  for (int i = 1; i < n - 1; ++i) scene.rods[0].position[i].y() = 1e-4 * std::exp(-std::pow((i - n / 2) * l / 0.2, 2));
  scene.clamps.push_back({0, n - 1, [=](double time) {
                            const double part = std::min(1.0, time / loading_time);
                            return Pose{end - part * shortening * Vector3::UnitX(),
                                        Quaternion(Eigen::AngleAxisd(part * end_turn, Vector3::UnitX())) * along_x};
                          }});
  return scene;
}

struct Buckled {
  double envelope_error;  ///< largest deviation from tanh^2
  double largest_angle;   ///< phi0
  double tension_error;   ///< relative error of M^2 = 2 EI T (1 + cos phi0)
};

Buckled buckled(int n) {
  const double l = length / n, stiffness = youngs_modulus * pi * std::pow(radius, 4) / 4;
  Simulation simulation(twisted_rod(n), step);
  for (int i = 0; i < static_cast<int>(loading_time / step); ++i) simulation.relax_once();
  for (int i = 0; i < settling_steps; ++i) simulation.relax_once();
  const Rod& rod = simulation.rod();
  std::vector<double> cosine;
  for (const Quaternion& q : rod.orientation) cosine.push_back(director(q).x());
  // The smallest cosine, by a parabola through the three smallest values.
  const auto lowest = std::min_element(cosine.begin() + 1, cosine.end() - 1);
  const double before = lowest[-1], here = lowest[0], after = lowest[1], bend = before - 2 * here + after;
  const double offset = (before - after) / (2 * bend);
  const double cosine0 = here - bend * offset * offset / 2;
  const double centre = static_cast<double>(lowest - cosine.begin()) + offset;

  Linearization at(rod);
  linearize(rod, at);
  double twist = 0;
  for (std::size_t k = 0; k < rod.joints.size(); ++k) twist += at.constraint[static_cast<Eigen::Index>(6 * k) + 5];
  const double moment = torsion_modulus * pi * std::pow(radius, 4) / 2 / l * twist / static_cast<double>(n - 1);
  const double scale = 2 * stiffness / std::abs(moment) * std::sqrt((1 + cosine0) / (1 - cosine0));
  const double tension = -to_world(rod, rod.joints.front(), rod.lambda.head<3>()).x() / l / (step * step);
  Buckled out{0, std::acos(cosine0), moment * moment / (2 * stiffness * std::abs(tension) * (1 + cosine0)) - 1};
  for (std::size_t s = 0; s < cosine.size(); ++s) {
    const double law = std::pow(std::tanh((static_cast<double>(s) - centre) * l / scale), 2);
    out.envelope_error = std::max(out.envelope_error, std::abs((cosine[s] - cosine0) / (1 - cosine0) - law));
  }
  return out;
}

TEST_CASE("A long twisted rod buckles into a localised helix, with an error of second order in 1/N", "[.long]") {
  const Buckled coarse = buckled(100), fine = buckled(200);
  CAPTURE(coarse.envelope_error, fine.envelope_error, fine.largest_angle, fine.tension_error);
  CHECK(fine.largest_angle == Approx(pi / 3).epsilon(0.03));
  CHECK(fine.envelope_error < 5e-3);
  CHECK(std::log2(coarse.envelope_error / fine.envelope_error) == Approx(2).margin(0.2));
  CHECK(std::abs(fine.tension_error) < 2e-3);
}

}  // namespace rodsweep::test_validation_buckling
