// Mechanics of the time step: free bodies, loads and clamps against closed forms. Free fall, momenta and the order of
// the motion are in validation/test_validation_motion.cpp.
#include <cmath>

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_time_step {

TEST_CASE("a body spinning about a principal axis keeps its spin, whatever the step") {
  for (const double dt : {0.001, 0.1})
    for (const bool axial : {true, false}) {
      Simulation sim(test::free_body(), dt);
      const Vector3 axis = sim.rod().orientation[0] * (axial ? Vector3::UnitZ() : Vector3::UnitX());
      sim.rod().angular_velocity[0] = 5 * axis;
      sim.run(50);
      CHECK((sim.rod().angular_velocity[0] - 5 * axis).norm() < 1e-11);
      // Each step turns by 2 atan(w dt / 2).
      const double angle = 50 * 2 * std::atan(5 * dt / 2);
      const Quaternion expected = Eigen::AngleAxisd(angle, axis) * test::free_body().rods[0].orientation[0];
      CHECK(sim.rod().orientation[0].angularDistance(expected) < 1e-7);
    }
}

TEST_CASE(
    "a torque-free top precesses about its angular momentum at |L| / I_t, with an error of the integrator's order") {
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2}) {
    const bool is_euler = integrator == Integrator::euler;
    double error[3];
    for (int i = 0; i < 3; ++i) {
      const int steps = 100 << i;
      const double duration = 0.5;
      Simulation sim(test::free_body(), {duration / steps, 40, 1e-14, integrator});
      Rod& rod = sim.rod();
      const Vector3 axis = director(rod.orientation[0]), across = rod.orientation[0] * Vector3::UnitX();
      rod.angular_velocity[0] = 6 * axis + 2 * across;
      const Vector3 spin = angular_momentum(rod);  // no orbital part, since the centre is at rest
      const double rate = spin.norm() / rod.segments[0].inertia_transverse;
      REQUIRE(rate * duration > 1);
      sim.run(steps);
      error[i] = (director(rod.orientation[0]) - Eigen::AngleAxisd(rate * duration, spin.normalized()) * axis).norm();
    }
    CAPTURE(is_euler, error[0], error[1], error[2]);
    CHECK(error[2] < (is_euler ? 0.02 : 1e-4));
    CHECK(std::log2(error[0] / error[1]) == Approx(is_euler ? 1 : 2).margin(is_euler ? 0.15 : 0.1));
    CHECK(std::log2(error[1] / error[2]) == Approx(is_euler ? 1 : 2).margin(0.1));
  }
}

TEST_CASE("drag slows a free body by (1 + c dt)^-n, in flight and in spin") {
  Scene scene = test::free_body();
  scene.damping_per_s = 3;
  const double dt = 0.05;
  Simulation sim(scene, dt);
  const Vector3 v0(1, -2, 3), w0 = 4 * director(sim.rod().orientation[0]);
  sim.rod().velocity[0] = v0;
  sim.rod().angular_velocity[0] = w0;
  for (int n = 1; n <= 30; ++n) {
    sim.run(1);
    const double left = std::pow(1 + 3 * dt, -n);
    REQUIRE((sim.rod().velocity[0] - left * v0).norm() < 1e-12);
    REQUIRE((sim.rod().angular_velocity[0] - left * w0).norm() < 1e-12);
  }
}

TEST_CASE("forces on a free body give it F / m, and I^-1 (tau + arm x F); loads on one segment add up") {
  const double dt = 0.01;
  Scene scene = test::free_body();
  const Vector3 force(3, -1, 2), torque(0.1, 0.2, -0.3), arm(0.05, 0, 0.2);
  scene.loads.push_back({0, 0, force / 2, torque, 2 * arm});
  scene.loads.push_back({0, 0, force / 2, Vector3::Zero(), Vector3::Zero()});
  Simulation sim(scene, dt);
  const Segment& segment = sim.rod().segments[0];
  const Matrix3 r = sim.rod().orientation[0].toRotationMatrix();
  const Vector3 inverse(segment.inverse_inertia_transverse, segment.inverse_inertia_transverse,
                        segment.inverse_inertia_axial);
  sim.run(1);
  CHECK((sim.rod().velocity[0] - dt * force / segment.mass).norm() < 1e-12);
  const Vector3 all = torque + (r * arm).cross(force), expected = dt * (r * inverse.asDiagonal() * r.transpose() * all);
  CHECK((sim.rod().angular_velocity[0] - expected).norm() < 1e-11);
  sim.run(9);
  CHECK((sim.rod().velocity[0] - 10 * dt * force / segment.mass).norm() < 1e-12);
}

TEST_CASE("a moving clamp is where its pose says at the end of every step, and the rod follows") {
  const double dt = 0.01;
  Scene scene = build_scene(test::bending_rod(6));
  const Pose start{scene.rods[0].position[0], scene.rods[0].orientation[0]};
  scene.time_s = 2;
  const auto pose = [start](double t) {
    Pose p;
    p.position = start.position + Vector3(0.5 * (t - 2) * (t - 2), 0.1 * std::sin(5 * (t - 2)), 0);
    p.orientation = Eigen::AngleAxisd(t - 2, Vector3::UnitY()) * start.orientation;
    return p;
  };
  scene.clamps.push_back({0, 0, [pose](double t) {
                            Pose p = pose(t);
                            p.orientation.coeffs() *= 3;  // the step normalises it
                            return p;
                          }});
  Simulation sim(scene, dt);
  Vector3 before = start.position;
  for (int n = 1; n <= 50; ++n) {
    sim.run(1);
    const Pose now = pose(2 + n * dt);
    REQUIRE(sim.scene.time_s == 2 + n * dt);
    REQUIRE((sim.rod().position[0] - now.position).norm() == 0);
    REQUIRE(sim.rod().orientation[0].angularDistance(now.orientation) < 1e-7);
    REQUIRE((sim.rod().velocity[0] - (now.position - before) / dt).norm() < 1e-12);
    REQUIRE(joint_gap(sim.rod()) < 1e-5);
    before = now.position;
  }
  CHECK((sim.rod().position.back() - scene.rods[0].position.back()).norm() > 0.1);
}

TEST_CASE("rods of one or two segments move under every clamp") {
  for (const Clamp clamp : {Clamp::segment, Clamp::wall, Clamp::free})
    for (const int segments : {1, 2}) {
      if (clamp == Clamp::segment && segments == 1) continue;
      INFO("clamp " << static_cast<int>(clamp) << ", " << segments << " segments");
      BendingRod spec = test::bending_rod(segments, clamp);
      spec.tip_force_n = {0, 0, 5};
      Simulation sim(build_scene(spec), 0.01);
      const Vector3 start = sim.rod().position.back();
      sim.run(40);
      CHECK(is_finite(sim.rod()));
      CHECK(joint_gap(sim.rod()) < 1e-5);
      CHECK(rod_length(sim.rod()) == Approx(2).epsilon(1e-5));
      CHECK((sim.rod().position.back() - start).z() > 1e-4);
      CHECK((sim.rod().position.back() - start).y() < -1e-3);
    }
}

}  // namespace rodsweep::test_time_step
