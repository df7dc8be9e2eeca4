// A straight rod held at both ends, of which one moves: pure bending, pure torsion, helices. Both ends are static
// segments. After the motion the rod relaxes (simulation.hpp). No gravity.
#include <algorithm>
#include <cmath>

#include "solver/numbers/rotation.hpp"
#include "solver/rod/linearization.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_clamps {

constexpr int count = 20;
constexpr double segment_length = 0.1, radius = 0.05, torsion_modulus = 4e6;
constexpr double turning_time = 10, step = 0.5;

/// A straight rod along +x from the origin; its first and last segments are held.
Rod held_rod() {
  RodParameters p;
  p.radius_m = radius;
  p.youngs_modulus_pa = 1e7;
  p.torsion_modulus_pa = torsion_modulus;
  const Vector3 end(count * segment_length, 0, 0);
  std::vector<SegmentSpec> specs = segments_through(straight_line(Vector3::Zero(), end, count), p);
  specs.front().is_static = specs.back().is_static = true;
  return chain(specs, p, 100);
}

/// Moves the last segment to `pose_at(angle)`, from zero up to `angle`, and relaxes.
template <typename PoseAt>
Rod turned(double angle, const PoseAt& pose_at) {
  Scene scene;
  scene.gravity_m_s2.setZero();
  scene.rods.push_back(held_rod());
  scene.clamps.push_back(
      {0, count - 1, [&](double time) { return pose_at(angle * std::min(1.0, time / turning_time)); }});
  Simulation simulation(std::move(scene), step);
  for (int i = 0; i < static_cast<int>(turning_time / step); ++i) simulation.relax_once();
  simulation.relax(1e-12);
  return simulation.rod();
}

/// conj(q_a) q_b as a rotation vector in the frame of a.
Vector3 joint_turn(const Rod& rod, const Joint& j) {
  const Eigen::AngleAxisd turn(rod.orientation[j.a].conjugate() * rod.orientation[j.b]);
  return turn.angle() * turn.axis();
}

TEST_CASE("A rod bent by its end turns by the same angle in every joint") {
  const double angle = GENERATE(0.3, pi / 2, pi);
  const Quaternion along_x = turn_between(Vector3::UnitZ(), Vector3::UnitX());
  // The end of a polygon with equal sides and equal turns.
  const auto end_of_polygon = [&](double total) {
    Vector3 vertex(0, 0, 0), side(0, 0, 0);
    for (int i = 0; i < count; ++i) {
      const double heading = total * i / (count - 1);
      side = segment_length * Vector3(std::cos(heading), std::sin(heading), 0);
      vertex += side;
    }
    return Pose{vertex - side / 2, Quaternion(Eigen::AngleAxisd(total, Vector3::UnitZ())) * along_x};
  };
  const Rod rod = turned(angle, end_of_polygon);
  for (const Joint& j : rod.joints) {
    const Vector3 turn = rod.orientation[j.a] * joint_turn(rod, j);
    CHECK((turn - angle / (count - 1) * Vector3::UnitZ()).norm() < 1e-8);
  }
}

TEST_CASE("A rod twisted by its end has uniform twist and the torque of its joints") {
  const double angle = GENERATE(0.3, 2.0);
  const Rod straight = held_rod();
  const auto twisted_end = [&](double total) {
    return Pose{straight.position.back(),
                Quaternion(Eigen::AngleAxisd(total, Vector3::UnitX())) * straight.orientation.back()};
  };
  const Rod rod = turned(angle, twisted_end);
  const double joint_angle = angle / (count - 1);
  const double second_moment = pi * std::pow(radius, 4) / 2, free_length = (count - 1) * segment_length;
  const double torque = torsion_modulus * second_moment / segment_length * std::sin(joint_angle);
  Linearization at(rod);
  linearize(rod, at);
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    CHECK((joint_turn(rod, rod.joints[k]) - joint_angle * Vector3::UnitZ()).norm() < 1e-8);
    // J^T lambda / dt^2 is the torque of the joint on its second segment. It opposes the turn.
    Vector3 on_b(0, 0, 0);
    for (int c = 0; c < 3; ++c)
      for (int row = 0; row < 6; ++row)
        on_b[c] += at.joints[k].rotation_b[c][row] * rod.lambda[static_cast<Eigen::Index>(6 * k) + row] / (step * step);
    CHECK((on_b + torque * Vector3::UnitZ()).norm() < 1e-8 * torque);  // in the frame of b
    CHECK(-on_b.z() ==
          Approx(torsion_modulus * second_moment * angle / free_length).epsilon(joint_angle * joint_angle));
  }
}

/// The largest distance of a joint from the helix that a straight rod of 1 m along x becomes whose ends are prescribed:
/// the tangent at s is x turned by s w. Each such helix is an equilibrium (Kirchhoff 1859).
double distance_from_helix(int segments, const Vector3& w) {
  const double rate = w.norm();
  const Vector3 axis = w / rate, x = Vector3::UnitX();
  const auto point = [&](double s) -> Vector3 {  // the integral of Rodrigues' formula
    return axis.dot(x) * s * axis + std::sin(rate * s) / rate * (x - axis.dot(x) * axis) +
           (1 - std::cos(rate * s)) / rate * axis.cross(x);
  };
  BendingRod p = weightless_cantilever(segments, 1e7, 4e6, 1, 0.01);
  p.tip_motion = TipMotion{point(1) - x, w * 180 / pi, 2};
  Simulation simulation(build_scene(p), 0.05, 30, 1e-8);
  for (int i = 0; i < 40; ++i) simulation.relax_once();
  simulation.relax();
  double farthest = 0;
  for (int i = 1; i < segments; ++i) {
    const auto& rod = simulation.rod();
    const std::size_t s = static_cast<std::size_t>(i);  // behind the wall
    const Vector3 joint = rod.position[s] + rod.segments[s].length_m / 2 * director(rod.orientation[s]);
    farthest = std::max(farthest, (joint - point(static_cast<double>(i) / segments)).norm());
  }
  return farthest;
}

TEST_CASE("A straight rod between two ends prescribed in space becomes a helix, to second order") {
  for (const Vector3& w : {Vector3(1, 0, 1.5), Vector3(-0.5, 2, 0.5)}) {
    const double coarse = distance_from_helix(20, w), fine = distance_from_helix(40, w);
    CAPTURE(coarse, fine);
    CHECK(coarse < 1e-3);
    CHECK(std::log2(coarse / fine) == Approx(2).margin(0.15));
  }
}

}  // namespace rodsweep::test_validation_clamps
