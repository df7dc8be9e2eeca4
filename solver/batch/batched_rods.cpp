#include "solver/batch/batched_rods.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "solver/step/time_step.hpp"

namespace rodsweep {
namespace {

void check_alone(const Scene& scene, const std::string& name) {
  if (scene.rods.size() != 1)
    throw SceneError(name + " has " + std::to_string(scene.rods.size()) + " rods; must have one");
  if (!scene.clamps.empty())
    throw SceneError(name + " has a moving clamp; a batched step does not support moving clamps");
  if (!scene.gravity_changes.empty())
    throw SceneError(name + " has gravity that changes; a batched step does not support it");
  if (!scene.loads.empty()) throw SceneError(name + " has a point load; a batched step does not support point loads");
  if (scene.contact) throw SceneError(name + " has contact; a batched step does not support contact");
  if (scene.wind) throw SceneError(name + " has wind; a batched step does not support wind");
  const Rod& rod = scene.rods.front();
  if (rod.joint_count() != rod.segment_count() - 1)
    throw SceneError(name + " has " + std::to_string(rod.joint_count()) + " joints for " +
                     std::to_string(rod.segment_count()) + " segments; a chain has one less");
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[static_cast<std::size_t>(k)];
    if (joint.a != k || joint.b != k + 1)
      throw SceneError(name + ": joint " + std::to_string(k) + " joins segments " + std::to_string(joint.a) + " and " +
                       std::to_string(joint.b) + "; in a chain it joins " + std::to_string(k) + " and " +
                       std::to_string(k + 1));
    if (rod.segments[static_cast<std::size_t>(k)].is_static && rod.segments[static_cast<std::size_t>(k) + 1].is_static)
      throw SceneError(name + ": joint " + std::to_string(k) +
                       " joins two static segments; remove it or free one of them");
  }
}

void check_equal(const Rod& first, const Rod& rod, const std::string& name) {
  if (rod.segment_count() != first.segment_count())
    throw SceneError(name + " has " + std::to_string(rod.segment_count()) + " segments; the first one has " +
                     std::to_string(first.segment_count()));
  for (std::size_t s = 0; s < rod.segments.size(); ++s)
    if (rod.segments[s].is_static != first.segments[s].is_static)
      throw SceneError(name + ": segment " + std::to_string(s) + " is " +
                       (rod.segments[s].is_static ? "static" : "free") + "; in the first scene it is not");
}

void put(LaneVector& out, int lane, const Vector3& v) {
  out.x[lane] = v.x();
  out.y[lane] = v.y();
  out.z[lane] = v.z();
}

void put(LaneQuaternion& out, int lane, const Quaternion& q) {
  out.w[lane] = q.w();
  out.x[lane] = q.x();
  out.y[lane] = q.y();
  out.z[lane] = q.z();
}

Vector3 lane_of(const LaneVector& v, int lane) { return {v.x[lane], v.y[lane], v.z[lane]}; }
Quaternion lane_of(const LaneQuaternion& q, int lane) { return {q.w[lane], q.x[lane], q.y[lane], q.z[lane]}; }

void put(BatchedSegment& out, int lane, const Rod& rod, std::size_t s) {
  const Segment& segment = rod.segments[s];
  out.is_static = segment.is_static;
  out.inverse_mass[lane] = segment.inverse_mass;
  out.turn_mobility[lane] = segment.inverse_inertia_transverse;
  out.inverse_inertia_axial[lane] = segment.inverse_inertia_axial;
  out.root_turn_mobility[lane] = std::sqrt(segment.inverse_inertia_transverse);
  out.root_inverse_inertia_axial[lane] = std::sqrt(segment.inverse_inertia_axial);
  out.gyration[lane] = (segment.inertia_axial - segment.inertia_transverse) * segment.inverse_inertia_transverse;
  put(out.position, lane, rod.position[s]);
  put(out.velocity, lane, rod.velocity[s]);
  put(out.angular_velocity, lane, rod.angular_velocity[s]);
  put(out.orientation, lane, rod.orientation[s]);
}

}  // namespace

BatchedRods::BatchedRods(const std::vector<Scene>& scenes, double h) : rods(static_cast<int>(scenes.size())) {
  if (scenes.empty() || rods > lanes)
    throw SceneError("a batch of " + std::to_string(scenes.size()) + " scenes; must be from 1 to " +
                     std::to_string(lanes));
  for (int r = 0; r < rods; ++r) {
    const std::string name = "scene " + std::to_string(r) + " of a batch";
    check_alone(scenes[static_cast<std::size_t>(r)], name);
    check_equal(scenes.front().rods.front(), scenes[static_cast<std::size_t>(r)].rods.front(), name);
  }
  segments.resize(scenes.front().rods.front().segments.size());
  joints.resize(segments.size() - 1);
  alpha.resize(joints.size());
  free.resize(segments.size());
  for (int lane = 0; lane < lanes; ++lane) {
    const Scene& scene = scenes[static_cast<std::size_t>(std::min(lane, rods - 1))];
    for (std::size_t s = 0; s < segments.size(); ++s) put(segments[s], lane, scene.rods.front(), s);
    for (std::size_t k = 0; k < joints.size(); ++k)
      for (int row = 0; row < 6; ++row) {
        alpha[k][row][lane] = scene.rods.front().joints[k].compliance[row];
        joints[k].lambda[row][lane] = scene.rods.front().lambda[static_cast<Eigen::Index>(6 * k) + row];
      }
    put(gravity, lane, scene.gravity_m_s2);
    damping_per_s[lane] = scene.damping_per_s;
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    std::array<const Joint*, lanes> group{};
    for (int lane = 0; lane < lanes; ++lane)
      group[static_cast<std::size_t>(lane)] =
          &scenes[static_cast<std::size_t>(std::min(lane, rods - 1))].rods.front().joints[k];
    joints[k].shape = joint_shape(group, kinks);
  }
  set_step(h);
  for (std::size_t s = 0; s < segments.size(); ++s) free[s] = {segments[s].position, segments[s].orientation};
  stretches_evenly = std::all_of(alpha.begin(), alpha.end(),
                                 [](const LaneVector6& c) { return !any((c[0] != c[1]) | (c[0] != c[2])); });
}

void BatchedRods::set_step(double h) {
  damping = 1 / (1 + damping_per_s * h);
  for (int lane = 0; lane < lanes; ++lane) constraint_dt[lane] = rodsweep::constraint_dt(damping_per_s[lane], h);
  for (std::size_t k = 0; k < joints.size(); ++k)
    for (int row = 0; row < 6; ++row) joints[k].compliance[row] = alpha[k][row] / (constraint_dt * constraint_dt);
}

void BatchedRods::write(int lane, Scene& scene) const {
  Rod& rod = scene.rods.front();
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const BatchedSegment& segment = segments[s];
    rod.position[s] = lane_of(segment.position, lane);
    rod.velocity[s] = lane_of(segment.velocity, lane);
    rod.angular_velocity[s] = lane_of(segment.angular_velocity, lane);
    rod.orientation[s] = lane_of(segment.orientation, lane);
    rod.free_position[s] = lane_of(free[s].position, lane);
    rod.free_orientation[s] = lane_of(free[s].orientation, lane);
  }
  rod.constraint_dt = constraint_dt[lane];
  for (std::size_t k = 0; k < joints.size(); ++k)
    for (int row = 0; row < 6; ++row) rod.lambda[static_cast<Eigen::Index>(6 * k) + row] = joints[k].lambda[row][lane];
}

}  // namespace rodsweep
