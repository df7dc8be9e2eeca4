#include "solver/contact/contact_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <string>
#include <utility>

#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

constexpr double half_pi = 1.57079632679489661923;

/// In units of r_a + r_b: the search goes on beyond segments that are nearer at rest. In a fork of angle theta, the
/// path between two overlapping segments may reach 1 / sin(theta) away.
constexpr double far = 3;

/// The pose of a segment while no joint is strained.
struct RestPose {
  Vector3 centre{0, 0, 0};
  Quaternion orientation = Quaternion::Identity();
};

/// The rest pose of the other segment of a joint.
RestPose beyond(const Joint& joint, int from, const RestPose& pose) {
  const bool forwards = from == joint.a;
  const Quaternion turned = pose.orientation * (forwards ? joint.rest() : joint.rest().conjugate());
  const Vector3 &here = forwards ? joint.arm_a : joint.arm_b, &there = forwards ? joint.arm_b : joint.arm_a;
  return {pose.centre + pose.orientation * here - turned * there, turned};
}

CapsuleAxis axis(const RestPose& pose, const Segment& segment) {
  return {pose.centre, segment.length_m / 2 * director(pose.orientation)};
}

}  // namespace

ContactBodies::ContactBodies(const Scene& scene) {
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    const Rod& rod = scene.rods[r];
    const int first = count();
    for (int s = 0; s < rod.segment_count(); ++s) {
      const Segment& segment = rod.segments[static_cast<std::size_t>(s)];
      bodies_.push_back({static_cast<int>(r), s, segment.radius_m, segment.length_m / 2, segment.inverse_mass > 0});
    }
    excluded_.resize(bodies_.size());
    next_.resize(bodies_.size());
    connect(rod, first);
    exclude_neighbours(rod, first);
  }
  for (const Obstacle& obstacle : scene.obstacles) add(obstacle);
  next_.resize(bodies_.size());
}

void ContactBodies::connect(const Rod& rod, int first_body) {
  const auto place = [&rod](int segment, const Vector3& arm) {  // -1, 0, 1: first end, in between, last end
    const double quarter = rod.segments[static_cast<std::size_t>(segment)].length_m / 4;
    return arm.z() > quarter ? 1 : arm.z() < -quarter ? -1 : 0;
  };
  const auto connect = [&](int from, int end, int to, int there) {
    if (end == 0) return;
    for (const int into : {-1, 1})
      if (there != into) next_[static_cast<std::size_t>(first_body + from)].push_back({end, first_body + to, into});
  };
  std::map<int, std::vector<std::pair<int, int>>> at_point;  // segments that end at one without length, and which end
  const auto is_point = [&rod](int segment) { return rod.segments[static_cast<std::size_t>(segment)].length_m == 0; };
  for (const Joint& joint : rod.joints) {
    const int on_a = place(joint.a, joint.arm_a), on_b = place(joint.b, joint.arm_b);
    if (is_point(joint.a)) at_point[joint.a].emplace_back(joint.b, on_b);
    if (is_point(joint.b)) at_point[joint.b].emplace_back(joint.a, on_a);
    if (is_point(joint.a) || is_point(joint.b)) continue;
    connect(joint.a, on_a, joint.b, on_b);
    connect(joint.b, on_b, joint.a, on_a);
  }
  for (const auto& [point, ends] : at_point)
    for (const auto& [from, end] : ends)
      for (const auto& [to, there] : ends)
        if (from != to) connect(from, end, to, there);
}

void ContactBodies::add(const Obstacle& obstacle) {
  const auto add = [this](const Vector3& from, const Vector3& to, double radius, const Vector3& velocity) {
    if (!from.allFinite() || !to.allFinite()) throw SceneError("an obstacle's position is not finite");
    if (!velocity.allFinite()) throw SceneError("an obstacle's velocity is not finite");
    if (!(radius > 0) || !std::isfinite(radius))
      throw SceneError("an obstacle's radius is " + std::to_string(radius) + "; must be positive and finite");
    bodies_.push_back({-1, -1, radius, (to - from).norm() / 2, false});
    obstacles_.push_back({{(from + to) / 2, (to - from) / 2}, velocity});
  };
  if (const auto* ball = std::get_if<Ball>(&obstacle))
    add(ball->centre_m, ball->centre_m, ball->radius_m, ball->velocity_m_s);
  if (const auto* capsule = std::get_if<Capsule>(&obstacle))
    add(capsule->from_m, capsule->to_m, capsule->radius_m, capsule->velocity_m_s);
}

// Shortest paths (Dijkstra) over the joints from each segment, as long as the widest pair needs, and longer beyond
// segments that are near at rest. Rest poses are in the frame of the segment at which the paths start.
void ContactBodies::exclude_neighbours(const Rod& rod, int first_body) {
  struct Place {
    int joint;
    Vector3 arm;  ///< on the segment
  };
  std::vector<std::vector<Place>> joints_of(rod.segments.size());
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[static_cast<std::size_t>(k)];
    joints_of[static_cast<std::size_t>(joint.a)].push_back({k, joint.arm_a});
    joints_of[static_cast<std::size_t>(joint.b)].push_back({k, joint.arm_b});
  }
  double widest = 0;
  for (const Segment& segment : rod.segments) widest = std::max(widest, segment.radius_m);

  struct Reached {
    double way = HUGE_VAL;
    int from = 0;   ///< the last segment of the path
    RestPose pose;  ///< of that segment
  };
  using Way = std::pair<double, int>;  // length, joint
  std::priority_queue<Way, std::vector<Way>, std::greater<>> open;
  std::vector<Reached> known(rod.joints.size());
  std::vector<int> reached;
  for (int start = 0; start < rod.segment_count(); ++start) {
    const Segment& at_start = rod.segments[static_cast<std::size_t>(start)];
    const double farthest = half_pi * (at_start.radius_m + widest);
    const auto arrive = [&](int joint, double way, int from, const RestPose& pose) {
      Reached& there = known[static_cast<std::size_t>(joint)];
      if (way >= there.way) return;
      if (there.way == HUGE_VAL) reached.push_back(joint);
      there = {way, from, pose};
      open.push({way, joint});
    };
    for (const Place& place : joints_of[static_cast<std::size_t>(start)]) arrive(place.joint, 0, start, {});
    std::vector<int>& excluded = excluded_[static_cast<std::size_t>(first_body + start)];
    while (!open.empty()) {
      const auto [way, through] = open.top();
      open.pop();
      const Reached here = known[static_cast<std::size_t>(through)];
      if (way > here.way) continue;
      const Joint& joint = rod.joints[static_cast<std::size_t>(through)];
      for (const auto& [segment, arm] : {std::pair{joint.a, joint.arm_a}, std::pair{joint.b, joint.arm_b}}) {
        const Segment& found = rod.segments[static_cast<std::size_t>(segment)];
        const RestPose pose = segment == here.from ? here.pose : beyond(joint, here.from, here.pose);
        const double touching = at_start.radius_m + found.radius_m;
        const double apart = separation(axis({}, at_start), axis(pose, found)).norm();
        if (segment > start && (way < half_pi * touching || apart < touching)) excluded.push_back(first_body + segment);
        for (const Place& place : joints_of[static_cast<std::size_t>(segment)]) {
          const double next = way + (place.arm - arm).norm();
          if (next < farthest || apart < far * touching) arrive(place.joint, next, segment, pose);
        }
      }
    }
    std::sort(excluded.begin(), excluded.end());
    excluded.erase(std::unique(excluded.begin(), excluded.end()), excluded.end());
    for (const int joint : reached) known[static_cast<std::size_t>(joint)].way = HUGE_VAL;
    reached.clear();
  }
}

bool ContactBodies::matter(int a, int b) const {
  const Body &one = body(a), &other = body(b);
  if (!one.is_free && !other.is_free) return false;
  if (one.radius == 0 || other.radius == 0) return false;
  if (one.rod < 0) return true;
  const std::vector<int>& excluded = excluded_[static_cast<std::size_t>(a)];
  return !std::binary_search(excluded.begin(), excluded.end(), b);
}

void ContactBodies::place(const Scene& scene, double time_s, std::vector<CapsuleAxis>& axes) const {
  axes.resize(bodies_.size());
  auto out = axes.begin();
  for (const Rod& rod : scene.rods)
    for (std::size_t s = 0; s < rod.segments.size(); ++s)
      *out++ = {rod.position[s], rod.segments[s].length_m / 2 * director(rod.orientation[s])};
  for (const Moving& obstacle : obstacles_)
    *out++ = {obstacle.at_time_0.centre + time_s * obstacle.velocity, obstacle.at_time_0.half};
}

void ContactBodies::coast(const Scene& scene, const std::vector<CapsuleAxis>& start, double time_s, double dt,
                          std::vector<CapsuleAxis>& axes) const {
  axes = start;
  std::size_t i = 0;
  for (const Rod& rod : scene.rods)
    for (std::size_t s = 0; s < rod.segments.size(); ++s, ++i) {
      axes[i].centre += dt * rod.velocity[s];
      const Vector3 half = start[i].half + dt * rod.angular_velocity[s].cross(start[i].half);
      if (!half.isZero(0)) axes[i].half = bodies_[i].half_length / half.norm() * half;
    }
  for (const Moving& obstacle : obstacles_) axes[i++].centre = obstacle.at_time_0.centre + time_s * obstacle.velocity;
}

}  // namespace rodsweep
