// A rope that slides over a drum: its tension grows by the law of Euler and Eytelwein, T_2 = T_1 exp(mu phi). Friction
// acts at the drum's radius R and the tension at R + r, so phi counts R / (R + r) times.
#include <cmath>

#include "solver/rod/joint_forces.hpp"
#include "tests/catch.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_validation_capstan {

constexpr double drum = 0.1, rope = 0.001;  // radii [m]
constexpr double load_n = 0.01;
constexpr int around = 24, straight = 8;  // segments over the drum, on either side

/// A thin rope over a drum about z, half around it. A load pulls at its first end, a clamp that sinks at its last one.
Scene rope_over_drum(double friction, double speed_m_s) {
  RodParameters p;
  p.radius_m = rope;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1e6;
  const double length = pi * (drum + rope) / around;
  const double out = (drum + rope) / std::cos(pi / around / 2);  // segments touch with their middles
  std::vector<Vector3> vertices;
  for (int i = straight; i > 0; --i) vertices.emplace_back(-out, -i * length, 0);
  for (int i = 0; i <= around; ++i) {
    const double angle = pi * (1 - static_cast<double>(i) / around);
    vertices.emplace_back(out * std::cos(angle), out * std::sin(angle), 0);
  }
  for (int i = 1; i <= straight; ++i) vertices.emplace_back(out, -i * length, 0);
  std::vector<SegmentSpec> segments = segments_through(vertices, p);
  segments.back().is_static = true;
  Scene scene = test::contact_scene({chain(segments, p, 10 * load_n)}, friction);
  scene.obstacles = {Capsule{{0, 0, -1}, {0, 0, 1}, drum}};
  scene.damping_per_s = 5;
  const SegmentSpec last = segments.back();
  const int clamp = static_cast<int>(segments.size()) - 1;
  scene.loads.push_back({0, 0, Vector3(0, -load_n, 0), Vector3::Zero(), Vector3::Zero()});
  scene.clamps.push_back({0, clamp, [=](double time_s) {
                            return Pose{last.position_m - Vector3(0, speed_m_s * time_s, 0), last.orientation};
                          }});
  return scene;
}

TEST_CASE("the tension of a rope that slides over a drum grows by exp(mu phi)") {
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const double friction : {0.0, 0.2, 0.4}) {
      INFO("friction " << friction);
      Scene scene = rope_over_drum(friction, 0.005);
      Simulation simulation(scene, StepSettings{0.01, 20, 1e-9, integrator}, 1e-8);
      double sum = 0;
      Vector3 on_drum = Vector3::Zero(), held = Vector3::Zero();
      constexpr int settling = 200, steps = 100;
      for (int step = 0; step < settling + steps; ++step) {
        simulation.step();
        if (step < settling) continue;
        const Rod& rod = simulation.rod();
        sum += joint_action(rod, rod.joint_count() - 1).force_n.norm() / joint_action(rod, 2).force_n.norm();
        on_drum += simulation.reactions().obstacles.force_n / steps;
        held += simulation.reactions().clamps.force_n / steps;
      }
      CHECK(sum / steps == Approx(std::exp(friction * pi * drum / (drum + rope))).epsilon(0.03));
      CHECK((on_drum + held - Vector3(0, load_n, 0)).norm() < 1e-3 * on_drum.norm());
    }
}

}  // namespace rodsweep::test_validation_capstan
