#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_rods.hpp"

namespace rodsweep {

// Rods along x first, then those along z. Every rod goes half a segment beyond its outermost crossings, so that these
// are centres of segments too.
Rod build_rod(const Net& p) {
  const double length = p.mesh_m / p.segments;
  const int along_x = (p.columns - 1) * p.segments + 1, along_z = (p.rows - 1) * p.segments + 1;  // segments of a rod
  const Quaternion to_x = turn_between(Vector3::UnitZ(), Vector3::UnitX());
  std::vector<SegmentSpec> segments;
  for (int row = 0; row < p.rows; ++row)
    for (int i = 0; i < along_x; ++i)
      segments.push_back(segment_at(Vector3(i * length, 0, row * p.mesh_m), to_x, length, p));
  for (int column = 0; column < p.columns; ++column)
    for (int i = 0; i < along_z; ++i)
      segments.push_back(segment_at(Vector3(column * p.mesh_m, 0, i * length), Quaternion::Identity(), length, p));
  const auto on_x = [&](int row, int i) { return row * along_x + i; };
  const auto on_z = [&](int column, int i) { return p.rows * along_x + column * along_z + i; };

  if (p.held == Net::Held::side)
    for (int column = 0; column < p.columns; ++column)
      segments[static_cast<std::size_t>(on_z(column, 0))].is_static = true;
  if (p.held == Net::Held::corners)
    for (const int column : {0, p.columns - 1})
      for (const int end : {0, along_z - 1}) segments[static_cast<std::size_t>(on_z(column, end))].is_static = true;

  const double force = weight(segments, p);
  std::vector<JointSpec> joints;
  for (int row = 0; row < p.rows; ++row)
    for (int i = 1; i < along_x; ++i)
      joints.push_back(joint_between(segments, on_x(row, i - 1), on_x(row, i), p, force));
  for (int column = 0; column < p.columns; ++column)
    for (int i = 1; i < along_z; ++i)
      joints.push_back(joint_between(segments, on_z(column, i - 1), on_z(column, i), p, force));
  for (int row = 0; row < p.rows; ++row)
    for (int column = 0; column < p.columns; ++column) {
      JointSpec crossing =
          joint_between(segments, on_x(row, column * p.segments), on_z(column, row * p.segments), p, force);
      crossing.arm_a_m = crossing.arm_b_m = Vector3::Zero();
      crossing.axial_excess_per_j = 0;  // it has no direction of its own
      // EI / l about every axis. A joint that rests at a right angle about local y measures a further turn about it,
      // 2 Im(d) - 2 Im(d0), by 1 / sqrt 2 only.
      const double turning = crossing.compliance_per_j[3];
      crossing.compliance_per_j.tail<3>() = Vector3(turning, turning / 2, turning);
      joints.push_back(crossing);
    }
  return Rod(segments, joints);
}

}  // namespace rodsweep
