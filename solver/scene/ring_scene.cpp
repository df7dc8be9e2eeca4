#include <cmath>

#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_rods.hpp"

namespace rodsweep {
namespace {

constexpr double pi = 3.14159265358979323846;

Quaternion about_rod(double angle) { return Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitZ())); }

}  // namespace

// The frames are those of the untwisted polygon, in which every joint turns alike. The twist is in the rest shape: the
// material of segment i stands turned back by i times the twist of a joint against its frame, so that the rest rotation
// of a joint stays small, also where the ends were joined. For a circular cross-section that is the same rod.
Rod build_rod(const Ring& p) {
  const double side = p.length_m / p.segments, turn = 2 * pi / p.segments, twist = p.twist_deg * pi / 180 / p.segments;
  const Quaternion top = turn_between(Vector3::UnitZ(), Vector3::UnitX());
  const double apothem = side / 2 / std::tan(turn / 2);
  std::vector<SegmentSpec> segments;
  for (int i = 0; i < p.segments; ++i) {
    const Quaternion about_centre(Eigen::AngleAxisd(-i * turn, Vector3::UnitZ()));
    const Vector3 centre = about_centre * Vector3(0, apothem, 0) - Vector3(0, apothem, 0);
    segments.push_back(segment_at(centre, (about_centre * top).normalized(), side, p));
  }
  segments.front().is_static = p.clamp == Clamp::segment;

  const Section section = circular_section(p.radius_m, p.youngs_modulus_pa, p.torsion_modulus_pa);
  const double force = weight(segments, p) + section.bending_x_nm2 / (apothem * apothem);
  std::vector<JointSpec> joints;
  for (int i = 0; i < p.segments; ++i) {
    const int next = (i + 1) % p.segments;
    JointSpec joint = joint_between(segments, i, next, p, force);
    const Quaternion circular = segments[static_cast<std::size_t>(i)].orientation.conjugate() *
                                segments[static_cast<std::size_t>(next)].orientation;
    const bool straight = p.rest_shape == Ring::RestShape::straight;
    joint.rest = (about_rod(i * twist) * (straight ? Quaternion::Identity() : circular) * about_rod(-(i + 1) * twist))
                     .normalized();
    joints.push_back(joint);
  }
  return Rod(segments, joints);
}

}  // namespace rodsweep
