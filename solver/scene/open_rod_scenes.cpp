#include <algorithm>
#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// Moves the end of the last segment. Velocity and acceleration are continuous.
MovingClamp tip_clamp(const TipMotion& motion, const SegmentSpec& last, int segment) {
  const Vector3 half(0, 0, last.length_m / 2);
  const Quaternion at_first = last.orientation;
  const Schedule progress{{0, motion.duration_s}, {0, 1}, true};
  return {0, segment,
          [=, end = Vector3(last.position_m + at_first * half)](double time_s) {
            const double done = progress.at(time_s);
            const Quaternion orientation = (motion.rotation(done) * at_first).normalized();
            return Pose{end + done * motion.displacement_m - orientation * half, orientation};
          },
          motion.duration_s};
}

/// Throws SceneError if a rod between two ends cannot follow the motion of its tip (see check_reach() of prescribed.cpp).
template <class RodScene>
void check_tip_motion(const RodScene& p) {
  if (!p.tip_motion || p.clamp == Clamp::free) return;
  const int joints = p.size().joints;
  if (const double turned = p.tip_motion->rotation_deg.norm(); turned > 90.0 * joints)
    throw SceneError("tip_motion turns the end by " + std::to_string(turned) +
                     " degrees; must be at most 90 for each of " + std::to_string(joints) +
                     " joints: use more segments");
  if (p.may_stretch()) return;
  const int held = p.clamp == Clamp::segment ? 1 : 0, n = p.segments;
  const Vector3 from = p.vertex_m(held), end = p.vertex_m(n), arm = p.vertex_m(n - held) - end;
  const double length = (n - 2 * held) * (p.vertex_m(1) - p.vertex_m(0)).norm();
  constexpr int looks = 100;
  constexpr double tolerance = 1e-5;
  double apart = 0;
  for (int i = 0; i <= looks; ++i) {
    const double done = static_cast<double>(i) / looks;
    apart =
        std::max(apart, (end + done * p.tip_motion->displacement_m + p.tip_motion->rotation(done) * arm - from).norm());
  }
  if (apart > (1 + tolerance) * length)
    throw SceneError("tip_motion moves the ends of the free part " + std::to_string(apart) +
                     " m apart; must be at most its length, " + std::to_string(length) +
                     " m, or \"stretch\" must be \"physical\"");
}

/// What an "inextensible" rod has to hold if both ends are prescribed: it buckles at 4 pi^2 EI / L^2; bends of half that
/// radius need four times as much.
double prescribed_force(const std::vector<SegmentSpec>& segments, const RodParameters& p) {
  double length = 0;
  for (const SegmentSpec& segment : segments) length += segment.length_m;
  const Section rod = stiffness(p);
  return 16 * pi * pi * std::max(rod.bending_x_nm2, rod.bending_y_nm2) / (length * length);
}

template <class RodScene>
std::vector<Vector3> vertices_of(const RodScene& p) {
  std::vector<Vector3> vertices;
  for (int i = 0; i <= p.segments; ++i) vertices.push_back(p.vertex_m(i));
  return vertices;
}

/// A rod whose joints lie on `vertices`, with what holds, loads or moves its tip. `height`: the direction of each
/// segment's height, for sections other than circles.
template <class Height>
void add_rod(const std::vector<Vector3>& vertices, const Height& height, const OpenRod& p, Scene& scene) {
  std::vector<SegmentSpec> segments = segments_through(vertices, p);
  if (p.section)
    for (std::size_t i = 0; i < segments.size(); ++i) set_height(segments[i], height(static_cast<double>(i) + 0.5));
  segments.front().is_static = p.clamp == Clamp::segment;
  if (p.clamp == Clamp::wall)
    segments.insert(segments.begin(), held_point(vertices.front(), segments.front().orientation));
  if (p.has_end_wall()) segments.push_back(held_point(vertices.back(), segments.back().orientation));
  segments.back().is_static |= p.tip_motion.has_value();
  const double of_tip = p.tip_motion ? prescribed_force(segments, p) : p.tip_force_n.norm();
  scene.rods.push_back(chain(segments, p, weight(segments, p) + of_tip));

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

Quaternion TipMotion::rotation(double done) const {
  return Quaternion(Eigen::AngleAxisd(done * rotation_deg.norm() * pi / 180, rotation_deg.normalized()));
}

Vector3 BendingRod::vertex_m(int joint) const {
  const double angle = initial_angle_deg * pi / 180;
  return joint * (length_m / segments) * Vector3(std::cos(angle), std::sin(angle), 0);
}

void BendingRod::check() const {
  OpenRod::check();
  check_tip_motion(*this);
}

void BendingRod::build(Scene& scene) const {
  const Vector3 along = vertex_m(1);
  add_rod(
      vertices_of(*this), [&](double) { return Vector3(-along.y(), along.x(), 0); }, *this, scene);
}

double Helix::turned(double joint) const { return 2 * pi * windings * joint / segments; }

Vector3 Helix::vertex_m(int joint) const {
  const double t = turned(joint);
  return {helix_radius_m * std::cos(t), -helix_height_m * joint / segments, helix_radius_m * std::sin(t)};
}

void Helix::check() const {
  OpenRod::check();
  check_tip_motion(*this);
}

void Helix::build(Scene& scene) const {
  const auto outwards = [this](double joint) { return Vector3(std::cos(turned(joint)), 0, std::sin(turned(joint))); };
  add_rod(vertices_of(*this), outwards, *this, scene);
}

}  // namespace rodsweep
