#include "solver/contact/contact_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_set>
#include <utility>

#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

/// The rest pose of the other segment of a joint.
Pose beyond(const Joint& joint, int from, const Pose& pose) {
  const bool forwards = from == joint.a;
  const Quaternion turned = pose.orientation * (forwards ? joint.rest() : joint.rest().conjugate());
  const Vector3 &here = forwards ? joint.arm_a : joint.arm_b, &there = forwards ? joint.arm_b : joint.arm_a;
  return {pose.position + pose.orientation * here - turned * there, turned};
}

/// A pose in the frame of another.
Pose relative(const Pose& frame, const Pose& pose) {
  const Quaternion back = frame.orientation.conjugate();
  return {back * (pose.position - frame.position), back * pose.orientation};
}

CapsuleAxis axis(const Pose& pose, const Segment& segment) {
  return {pose.position, segment.length_m / 2 * director(pose.orientation)};
}

}  // namespace

ContactBodies::ContactBodies(const Scene& scene) {
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    const Rod& rod = scene.rods[r];
    const int first = count();
    for (int s = 0; s < rod.segment_count(); ++s) {
      const Segment& segment = rod.segments[at(s)];
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
    const double quarter = rod.segments[at(segment)].length_m / 4;
    return arm.z() > quarter ? 1 : arm.z() < -quarter ? -1 : 0;
  };
  const auto connect = [&](int from, int end, int to, int there) {
    if (end == 0) return;
    for (const int into : {-1, 1})
      if (there != into) next_[at(first_body + from)].push_back({end, first_body + to, into});
  };
  std::map<int, std::vector<std::pair<int, int>>> at_point;  // segments that end at one without length, and which end
  const auto is_point = [&rod](int segment) { return rod.segments[at(segment)].length_m == 0; };
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

void ContactBodies::exclude_neighbours(const Rod& rod, int first_body) {
  JointWays ways(rod);
  exclude_near(rod, first_body, ways);
  exclude_overlapping(rod, first_body, ways);
  for (int s = first_body; s < first_body + rod.segment_count(); ++s) {
    std::vector<int>& excluded = excluded_[at(s)];
    std::sort(excluded.begin(), excluded.end());
    excluded.erase(std::unique(excluded.begin(), excluded.end()), excluded.end());
  }
}

// Searches as far from each segment as the widest pair needs.
void ContactBodies::exclude_near(const Rod& rod, int first_body, JointWays& ways) {
  double widest = 0;
  for (const Segment& segment : rod.segments) widest = std::max(widest, segment.radius_m);
  for (int start = 0; start < rod.segment_count(); ++start) {
    const double radius = rod.segments[at(start)].radius_m;
    const auto exclude = [&](int joint, const JointWays::Way& way) {
      const Joint& through = rod.joints[at(joint)];
      for (const int segment : {through.a, through.b}) {
        const double touching = radius + rod.segments[at(segment)].radius_m;
        if (segment > start && way.length_m < pi / 2 * touching)
          excluded_[at(first_body + start)].push_back(first_body + segment);
      }
    };
    ways.from(
        ways.joints_of(start), pi / 2 * (radius + widest), [](int) { return true; }, exclude);
  }
}

// From every two segments that meet in a point, outwards along both, as long as they overlap at rest.
void ContactBodies::exclude_overlapping(const Rod& rod, int first_body, const JointWays& ways) {
  using Meeting = JointWays::Meeting;
  /// Two segments, where their path arrives on each, and the rest pose of b in the frame of a.
  struct Meet {
    int a, b;
    Vector3 arm_a, arm_b;
    Pose pose;
  };
  const auto segment = [&rod](int i) -> const Segment& { return rod.segments[at(i)]; };
  const auto joint = [&rod](const Meeting& of) -> const Joint& { return rod.joints[at(of.joint)]; };
  const auto beside = [](const Vector3& arm, const Vector3& other, double length) {
    return (arm - other).norm() <= 1e-9 * length;
  };
  std::vector<Meet> open;
  std::unordered_set<std::uint64_t> known;
  const auto add = [&](const Meet& pair) {
    if (pair.a == pair.b) return;
    const Segment &a = segment(pair.a), &b = segment(pair.b);
    const double apart = separation(axis({}, a), axis(pair.pose, b)).norm();
    const bool is_point = a.length_m == 0 || b.length_m == 0;  // whose branches are pairs of their own
    if (is_point || apart >= a.radius_m + b.radius_m) return;
    const auto [low, high] = std::minmax(pair.a, pair.b);
    if (!known.insert(static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high)).second) return;
    excluded_[at(first_body + low)].push_back(first_body + high);
    open.push_back(pair);
  };
  /// The segment on the other side of a joint of `from`.
  const auto across = [&](int from, const Meeting& at) {
    const Joint& by = joint(at);
    return by.a == from ? std::pair(by.b, by.arm_b) : std::pair(by.a, by.arm_a);
  };
  for (int s = 0; s < rod.segment_count(); ++s)
    for (const Meeting& one : ways.joints_of(s)) {
      const auto [a, arm_a] = across(s, one);
      if (s < a) add({s, a, one.arm, arm_a, beyond(joint(one), s, {})});
      for (const Meeting& other : ways.joints_of(s)) {
        if (other.joint <= one.joint || !beside(one.arm, other.arm, segment(s).length_m)) continue;
        const auto [b, arm_b] = across(s, other);
        add({a, b, arm_a, arm_b, relative(beyond(joint(one), s, {}), beyond(joint(other), s, {}))});
      }
    }
  /// Calls visit(next, its arm, its rest pose) beyond the far end of b; a point between them is passed.
  const auto outwards = [&](int b, const Vector3& arm_b, const Pose& pose, const auto& visit) {
    for (const Meeting& at : ways.joints_of(b)) {
      if (beside(at.arm, arm_b, segment(b).length_m)) continue;
      const auto [next, arm] = across(b, at);
      const Pose there = beyond(joint(at), b, pose);
      if (segment(next).length_m > 0) {
        visit(next, arm, there);
        continue;
      }
      for (const Meeting& on : ways.joints_of(next))
        if (on.joint != at.joint) {
          const auto [after, arm_after] = across(next, on);
          visit(after, arm_after, beyond(joint(on), next, there));
        }
    }
  };
  while (!open.empty()) {
    const Meet pair = open.back();
    open.pop_back();
    outwards(pair.b, pair.arm_b, pair.pose, [&](int next, const Vector3& arm, const Pose& pose) {
      add({pair.a, next, pair.arm_a, arm, pose});
    });
    outwards(pair.a, pair.arm_a, {}, [&](int next, const Vector3& arm, const Pose& pose) {
      add({next, pair.b, arm, pair.arm_b, relative(pose, pair.pose)});
    });
  }
}

bool ContactBodies::matter(int a, int b) const {
  const Body &one = body(a), &other = body(b);
  if (!one.is_free && !other.is_free) return false;
  if (one.radius == 0 || other.radius == 0) return false;
  if (one.rod < 0) return true;
  const std::vector<int>& excluded = excluded_[at(a)];
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
