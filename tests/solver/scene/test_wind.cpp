// Wind: properties of the field, and drag on free and on elastic segments.
#include <cmath>

#include "solver/numbers/lane_math.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_wind {

WindParameters turbulence(int modes, std::uint64_t seed = 0) {
  WindParameters p;
  p.turbulence_m_s = 2;
  p.turbulence_length_m = 3;
  p.turbulence_modes = modes;
  p.seed = seed;
  return p;
}

WindParameters breeze(const Vector3& mean) {
  WindParameters p;
  p.mean_m_s = mean;
  return p;
}

/// One free weightless segment along x.
Scene floating_segment() {
  BendingRod p;
  p.segments = 1;
  p.length_m = 0.5;
  p.radius_m = 0.01;
  p.clamp = Clamp::free;
  p.gravity_m_s2.setZero();
  return build_scene(p);
}

/// 1/2 rho C_d d l / m.
double drag_per_mass(const Segment& s) { return 0.5 * 1.2 * 1.2 * 2 * s.radius_m * s.length_m / s.mass; }

/// Speed of a falling segment after a second over its terminal speed.
double falling(double dt, double terminal) {
  Scene scene = floating_segment();
  const double k = drag_per_mass(scene.rods[0].segments[0]);
  scene.gravity_m_s2 = {0, -k * terminal * terminal, 0};
  scene.wind.emplace(WindParameters{});
  Simulation simulation(scene, dt);
  simulation.run(static_cast<int>(std::lround(1 / dt)));
  return -simulation.rod().velocity[0].y() / terminal;
}

TEST_CASE("the mean wind grows with height by the power law and swells with the gusts") {
  WindParameters p = breeze({6, 0, 3});
  p.gust_strength = 0.5;
  p.gust_period_s = 4;
  p.profile_exponent = 0.25;
  p.reference_height_m = 16;
  const Wind wind(p);
  CHECK((wind.velocity({5, 16, 5}, 0) - Vector3(6, 0, 3)).norm() < 1e-14);
  CHECK((wind.velocity({5, 1, 5}, 0) - Vector3(3, 0, 1.5)).norm() < 1e-14);
  CHECK(wind.velocity({5, -1, 5}, 0).norm() == 0);
  CHECK((wind.velocity({0, 16, 0}, 1) - Vector3(9, 0, 4.5)).norm() < 1e-14);
  CHECK((wind.velocity({0, 16, 0}, 3) - Vector3(3, 0, 1.5)).norm() < 1e-14);
}

TEST_CASE("turbulence has no divergence") {
  const Wind wind(turbulence(16));
  test::Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Vector3 at = random.vector(20);
    double divergence = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
      const Vector3 h = 1e-4 * Vector3::Unit(k);
      const Vector3 slope = (wind.velocity(at + h, 7) - wind.velocity(at - h, 7)) / 2e-4;
      divergence += slope[k];
      size += slope.norm();
    }
    CHECK(std::abs(divergence) < 1e-6 * size);
  }
}

TEST_CASE("turbulence is as strong as asked for, and forgets over its length and time") {
  // Spatial means over many fields. In the moving air, time changes a mode's phase by w t: the mean of cos(w t) over w
  // and k is (1 + (sigma t / L)^2)^(-3/2).
  test::Random random(5);
  double size = 0, along[2] = {0, 0}, later = 0;
  Vector3 squares = Vector3::Zero();
  const double distances[2] = {1.5, 3}, time = 1;
  const Vector3 drift(4, 0, 1);
  int count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    WindParameters p = turbulence(64, seed);
    p.mean_m_s = drift;
    const Wind wind(p);
    for (int i = 0; i < 100; ++i, ++count) {
      const Vector3 at = random.vector(1000), here = wind.velocity(at, 0) - drift;
      size += here.squaredNorm();
      squares += here.cwiseAbs2();
      for (int d = 0; d < 2; ++d) {
        const Vector3 apart = distances[d] * random.vector(1).normalized();
        along[d] += here.dot(wind.velocity(at + apart, 0) - drift);
      }
      later += here.dot(wind.velocity(at + time * drift, time) - drift);
    }
  }
  CHECK(size / count == Approx(3 * 4).epsilon(0.03));
  for (int k = 0; k < 3; ++k) CHECK(squares[k] / count == Approx(4).epsilon(0.06));
  for (int d = 0; d < 2; ++d)
    CHECK(along[d] / size == Approx(std::exp(-distances[d] * distances[d] / (2 * 9))).margin(0.03));
  CHECK(later / size == Approx(std::pow(1 + std::pow(2 * time / 3, 2), -1.5)).margin(0.03));
}

TEST_CASE("cosines of eight angles at once are cosines") {
  test::Random random(1);
  for (int i = 0; i < 200; ++i) {
    Lane turns;
    for (int lane = 0; lane < lane_width; ++lane) turns[lane] = random.uniform(-3, 3);
    turns[0] = i / 8.0 - 12;
    const Lane cosine = cosine_of_turns(turns);
    for (int lane = 0; lane < lane_width; ++lane)
      CHECK(std::abs(cosine[lane] - std::cos(2 * pi * turns[lane])) < 1e-13);
  }
}

TEST_CASE("the same seed blows the same bits, another seed another wind") {
  const Vector3 at(1, 2, 3);
  CHECK(Wind(turbulence(16)).velocity(at, 5) == Wind(turbulence(16)).velocity(at, 5));
  CHECK((Wind(turbulence(16)).velocity(at, 5) - Wind(turbulence(16, 1)).velocity(at, 5)).norm() > 0.1);
}

TEST_CASE("a segment falling through still air tends to its terminal speed as tanh, to first order in the step") {
  const double exact = std::tanh(drag_per_mass(floating_segment().rods[0].segments[0]) * 20);
  CHECK(exact < 0.99);
  const double coarse = falling(0.02, 20) - exact, fine = falling(0.01, 20) - exact;
  CHECK(std::abs(fine) < 0.01);
  CHECK(std::log2(coarse / fine) == Approx(1).margin(0.1));
}

TEST_CASE("a segment takes the wind's speed as 1 - 1 / (1 + k U t) across it, and hardly along it") {
  for (const bool across : {true, false}) {
    Scene scene = floating_segment();
    const double k = drag_per_mass(scene.rods[0].segments[0]) * (across ? 1 : pi * 0.01 / 1.2);
    const Vector3 mean = across ? Vector3(0, 8, 6) : Vector3(10, 0, 0);
    scene.wind.emplace(breeze(mean));
    Simulation simulation(scene, 1e-3);
    simulation.run(2000);
    const Vector3 exact = (1 - 1 / (1 + k * 10 * 2)) * mean;
    CHECK((simulation.rod().velocity[0] - exact).norm() < 1e-3 * exact.norm());
  }
}

TEST_CASE("what is far too light for the step takes the wind's speed at once and keeps it") {
  Scene scene = floating_segment();
  Segment& segment = scene.rods[0].segments[0];
  segment.mass *= 1e-6;
  segment.inverse_mass *= 1e6;
  scene.wind.emplace(breeze({0, 8, 6}));
  Simulation simulation(scene, 0.1);
  for (int step = 0; step < 20; ++step) {
    simulation.step();
    CHECK((simulation.rod().velocity[0] - Vector3(0, 8, 6)).norm() < 1e-9);
  }
}

TEST_CASE("a cantilever in a steady wind rests as under a uniform load, whatever the step") {
  Tree p;
  p.shape.depth = 0;
  p.shape.segments = 32;
  p.radius_m = 0.02;
  p.youngs_modulus_pa = 1e9;
  p.torsion_modulus_pa = 4e8;
  p.gravity_m_s2.setZero();
  p.wind = breeze({10, 0, 0});
  const double load = 0.5 * 1.2 * 1.2 * 0.04 * 100, stiffness = 1e9 * pi * std::pow(0.02, 4) / 4;
  Simulation coarse(build_scene(p), 1), fine(build_scene(p), 0.25);
  coarse.relax(1e-10);
  fine.relax(1e-10);
  CHECK(tip(coarse.rod()).x() == Approx(load / (8 * stiffness)).epsilon(2e-3));
  CHECK(tip(fine.rod()).x() == Approx(tip(coarse.rod()).x()).epsilon(1e-6));
}

TEST_CASE("invalid winds are refused") {
  WindParameters p = turbulence(0);
  CHECK_THROWS_WITH(Wind(p), "wind: turbulence_modes is 0; must be at least 1");
  p.turbulence_length_m = 0;
  CHECK_THROWS_WITH(Wind(p), "wind: turbulence_length_m is 0; must be positive");
}

}  // namespace rodsweep::test_wind
