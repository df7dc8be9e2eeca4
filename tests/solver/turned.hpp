// Scenes that turn and shift as a whole, loads, clamps and floors included, and the systems of their steps.
#pragma once

#include <variant>
#include <vector>

#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test {

struct RigidMotion {
  Quaternion turn;
  Vector3 shift;

  Vector3 operator()(const Vector3& point) const { return turn * point + shift; }
};

// Mirror image across x = 0. It mirrors the segments' frames too: R' = S R S, S = diag(-1, 1, 1).
inline Vector3 mirrored(const Vector3& v) { return {-v.x(), v.y(), v.z()}; }
inline Vector3 mirrored_axis(const Vector3& v) { return {v.x(), -v.y(), -v.z()}; }  ///< an axis of rotation
inline Quaternion mirrored(const Quaternion& q) { return {q.w(), q.x(), -q.y(), -q.z()}; }
/// Signs of a joint's six rows in its frame: a vector, then an axis.
inline const Vector6 mirrored_rows = (Vector6() << -1, 1, 1, 1, -1, -1).finished();

/// The image of a scene under maps of the world's points, vectors, axes of rotation and orientations.
template <class Point, class Vector, class Axis, class Turn>
Scene image_of(Scene scene, const Point& point, const Vector& vector, const Axis& axis, const Turn& turn) {
  for (Rod& rod : scene.rods)
    for (int s = 0; s < rod.segment_count(); ++s) {
      rod.position[s] = point(rod.position[s]);
      rod.orientation[s] = turn(rod.orientation[s]);
      rod.velocity[s] = vector(rod.velocity[s]);
      rod.angular_velocity[s] = axis(rod.angular_velocity[s]);
    }
  scene.gravity_m_s2 = vector(scene.gravity_m_s2);
  for (GravityChange& change : scene.gravity_changes) change.by_m_s2 = vector(change.by_m_s2);
  for (PointLoad& load : scene.loads) {
    load.force_n = vector(load.force_n);
    load.torque_nm = axis(load.torque_nm);
  }
  for (MovingClamp& clamp : scene.clamps)
    clamp.pose = [point, turn, before = clamp.pose](double time_s) {
      const Pose pose = before(time_s);
      return Pose{point(pose.position), turn(pose.orientation)};
    };
  for (Obstacle& obstacle : scene.obstacles) {
    if (auto* plane = std::get_if<HalfSpace>(&obstacle)) {
      plane->point_m = point(plane->point_m);
      plane->normal = vector(plane->normal);
    } else if (auto* ball = std::get_if<Ball>(&obstacle)) {
      ball->centre_m = point(ball->centre_m);
    } else {
      auto& capsule = std::get<Capsule>(obstacle);
      capsule.from_m = point(capsule.from_m);
      capsule.to_m = point(capsule.to_m);
    }
    std::visit([&](auto& any) { any.velocity_m_s = vector(any.velocity_m_s); }, obstacle);
  }
  return scene;
}

inline Scene moved(const Scene& scene, const RigidMotion& to) {
  const auto turn = [q = to.turn](const Vector3& v) -> Vector3 { return q * v; };
  return image_of(scene, to, turn, turn, [q = to.turn](const Quaternion& of) { return q * of; });
}

inline Scene mirrored(const Scene& scene) {
  const auto image = [](const auto& of) { return mirrored(of); };
  Scene out = image_of(scene, image, image, mirrored_axis, image);
  for (Rod& rod : out.rods)  // what is fixed in the frames of segments
    for (Joint& joint : rod.joints) {
      joint.arm_a = mirrored(joint.arm_a);
      joint.arm_b = mirrored(joint.arm_b);
      joint.frame_a = mirrored(joint.frame_a);
      joint.frame_b = mirrored(joint.frame_b);
    }
  for (PointLoad& load : out.loads) load.arm_m = mirrored(load.arm_m);
  return out;
}

/// The same rod with all segments' frames rolled about their axes by one angle. Different angles would twist joints at
/// rest, and finite and small twists are not measured alike.
inline Rod rolled(Rod rod, double angle) {
  const Quaternion roll(Eigen::AngleAxisd(angle, Vector3::UnitZ()));
  for (Quaternion& q : rod.orientation) q = q * roll;
  for (Joint& joint : rod.joints) {
    joint.arm_a = roll.conjugate() * joint.arm_a;
    joint.arm_b = roll.conjugate() * joint.arm_b;
    joint.frame_a = roll.conjugate() * joint.frame_a * roll;
    joint.frame_b = roll.conjugate() * joint.frame_b * roll;
  }
  return rod;
}

/// Six steps of three Newton iterations; calls `look` with every system.
template <class Look>
void observe(Scene& scene, const Look& look) {
  rodsweep::observe(scene, {0.02, 3, 0}, 6,
                    [&](const LinearSystem& system, const SolvePosition&, const VectorX&) { look(system); });
}

struct TurnedCase {
  const char* name;
  Scene scene;
};

inline std::vector<TurnedCase> turned_cases() {
  std::vector<TurnedCase> out;
  BendingRod bending = bending_rod(12, Clamp::wall);
  out.push_back({"bending rod", build_scene(bending)});
  bending.tip_force_n = {1, 2, -20};
  bending.stretch = Stretch::physical;
  out.push_back({"rod that stretches and shears", build_scene(bending)});
  Helix helix;
  helix.segments = 24;
  out.push_back({"helix", build_scene(helix)});
  Ring ring;
  ring.segments = 10;
  out.push_back({"ring", build_scene(ring)});
  out.push_back({"lattice", build_scene(lattice_of(Lattice::Cell::body_centred, 2, 1, Held::side))});
  Tree tree;
  tree.shape.depth = 2;
  tree.youngs_modulus_pa = tree.torsion_modulus_pa = 1e7;
  tree.gravity_m_s2 = {3, -9, 1};
  out.push_back({"tree", build_scene(tree)});
  return out;
}

inline const RigidMotion motions[] = {
    {Quaternion(Eigen::AngleAxisd(1.1, Vector3(1, 2, -1).normalized())), {0.3, -1, 2}},
    {Quaternion(Eigen::AngleAxisd(3.1, Vector3(0, 1, 0.2).normalized())), {0, 0, 0}},
    {Quaternion(Eigen::AngleAxisd(-2.0, Vector3(1, 0, 0.7).normalized())), {-2, 5, 1}},
};

}  // namespace rodsweep::test
