#include <algorithm>
#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

SegmentSpec wall(const Vector3& at, const Quaternion& orientation) {
  SegmentSpec out;
  out.position_m = at;
  out.orientation = orientation;
  out.is_static = true;
  return out;
}

/// Moves the end of the last segment. Velocity and acceleration are continuous.
MovingClamp tip_clamp(const TipMotion& motion, const SegmentSpec& last, int segment) {
  const Vector3 half(0, 0, last.length_m / 2), axis = motion.rotation_deg.normalized();
  const double angle = motion.rotation_deg.norm() * pi / 180;
  const Quaternion turned = last.orientation;
  return {0, segment, [=, end = Vector3(last.position_m + turned * half)](double time_s) {
            const double u = std::min(time_s / motion.duration_s, 1.0);
            const double done = u * u * u * (10 - 15 * u + 6 * u * u);
            const Quaternion orientation = (Quaternion(Eigen::AngleAxisd(done * angle, axis)) * turned).normalized();
            return Pose{end + done * motion.displacement_m - orientation * half, orientation};
          }};
}

/// A rod whose joints lie on `vertices`, with what holds, loads or moves its tip. `height`: the direction of each
/// segment's height, for sections other than circles.
template <class Height>
void add_rod(const std::vector<Vector3>& vertices, const Height& height, const OpenRod& p, Scene& scene) {
  std::vector<SegmentSpec> segments = segments_through(vertices, p);
  if (p.section)
    for (std::size_t i = 0; i < segments.size(); ++i) set_height(segments[i], height(static_cast<double>(i) + 0.5));
  segments.front().is_static = p.clamp == Clamp::segment;
  if (p.clamp == Clamp::wall) segments.insert(segments.begin(), wall(vertices.front(), segments.front().orientation));
  if (p.has_end_wall()) segments.push_back(wall(vertices.back(), segments.back().orientation));
  segments.back().is_static |= p.tip_motion.has_value();
  scene.rods.push_back(chain(segments, p, weight(segments, p) + p.tip_force_n.norm()));

  const int last = static_cast<int>(segments.size()) - 1;
  if (p.tip_motion) scene.clamps.push_back(tip_clamp(*p.tip_motion, segments.back(), last));
  if (p.has_tip_load())
    scene.loads.push_back({0, last, p.tip_force_n, p.tip_torque_nm, Vector3(0, 0, segments.back().length_m / 2)});
}

}  // namespace

void OpenRod::check() const {
  if (tip_motion && has_tip_load())
    throw SceneError("tip_motion is given with a load on the tip; remove tip_motion, or tip_force_n and tip_torque_nm");
  if (tip_motion && clamp == Clamp::segment)
    check_least("segments", segments, 3, ": the clamp \"segment\" holds the first and, for tip_motion, the last");
  else if (clamp == Clamp::segment)
    check_least("segments", segments, 2, ": the clamp \"segment\" holds the first one");
  else
    check_least("segments", segments, 1);
}

SceneSize OpenRod::size() const {
  const int count = segments + (clamp == Clamp::wall ? 1 : 0) + (has_end_wall() ? 1 : 0);
  return {count, count - 1};
}

Vector3 BendingRod::end_m() const {
  const double angle = initial_angle_deg * pi / 180;
  return length_m * Vector3(std::cos(angle), std::sin(angle), 0);
}

void BendingRod::check() const {
  OpenRod::check();
  if (!tip_motion || clamp == Clamp::free || stretch == Stretch::physical || stretch_compliance_per_j) return;
  const double apart = (end_m() + tip_motion->displacement_m).norm();
  constexpr double rounding = 1e-9;
  if (apart > (1 + rounding) * length_m)
    throw SceneError("tip_motion.displacement_m moves the ends " + std::to_string(apart) +
                     " m apart; must be at most length_m (" + std::to_string(length_m) +
                     "), or \"stretch\" must be \"physical\"");
}

void BendingRod::build(Scene& scene) const {
  const Vector3 end = end_m();
  add_rod(
      straight_line(Vector3::Zero(), end, segments), [&](double) { return Vector3(-end.y(), end.x(), 0); }, *this,
      scene);
}

void Helix::build(Scene& scene) const {
  const auto angle = [this](double joint) { return 2 * pi * windings * joint / segments; };
  std::vector<Vector3> vertices;
  for (int i = 0; i <= segments; ++i) {
    const double t = angle(i);
    vertices.emplace_back(helix_radius_m * std::cos(t), -helix_height_m * i / segments, helix_radius_m * std::sin(t));
  }
  const auto outwards = [&](double joint) { return Vector3(std::cos(angle(joint)), 0, std::sin(angle(joint))); };
  add_rod(vertices, outwards, *this, scene);
}

}  // namespace rodsweep
