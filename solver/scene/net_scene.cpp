#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {

void Net::check() const {
  check_least("rows", rows, 2);
  check_least("columns", columns, 2);
  check_least("segments", segments, 1);
  if (held == Held::corners && rows == 2)
    check_least("segments", segments, 2, ": between the held ends of two rows nothing would be free");
  check_segments("a net", 2.0 * rows * columns * segments);
}

SceneSize Net::size() const {
  const int count = rows * ((columns - 1) * segments + 1) + columns * ((rows - 1) * segments + 1);
  return {count, count - rows - columns + rows * columns};
}

// Rods along x first, then those along z. Every rod goes half a segment beyond its outermost crossings, so that these
// are centres of segments too.
void Net::build(Scene& scene) const {
  const double length = mesh_m / segments;
  const int along_x = (columns - 1) * segments + 1, along_z = (rows - 1) * segments + 1;  // segments of a rod
  const Quaternion to_x = turn_between(Vector3::UnitZ(), Vector3::UnitX());
  std::vector<SegmentSpec> all;
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < along_x; ++i)
      all.push_back(segment_at(Vector3(i * length, 0, row * mesh_m), to_x, length, *this));
  for (int column = 0; column < columns; ++column)
    for (int i = 0; i < along_z; ++i)
      all.push_back(segment_at(Vector3(column * mesh_m, 0, i * length), Quaternion::Identity(), length, *this));
  const auto on_x = [&](int row, int i) { return row * along_x + i; };
  const auto on_z = [&](int column, int i) { return rows * along_x + column * along_z + i; };

  if (held == Held::side)
    for (int column = 0; column < columns; ++column) all[static_cast<std::size_t>(on_z(column, 0))].is_static = true;
  if (held == Held::corners)
    for (const int column : {0, columns - 1})
      for (const int end : {0, along_z - 1}) all[static_cast<std::size_t>(on_z(column, end))].is_static = true;

  const double force = weight(all, *this);
  std::vector<JointSpec> joints;
  for (int row = 0; row < rows; ++row)
    for (int i = 1; i < along_x; ++i)
      joints.push_back(joint_between(all, on_x(row, i - 1), on_x(row, i), *this, force));
  for (int column = 0; column < columns; ++column)
    for (int i = 1; i < along_z; ++i)
      joints.push_back(joint_between(all, on_z(column, i - 1), on_z(column, i), *this, force));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int a = on_x(row, column * segments), b = on_z(column, row * segments);
      const JointSpec along = joint_between(all, a, b, *this, force);
      joints.push_back(crossing_between(a, b, 1 / along.compliance_per_j[3], along.compliance_per_j[0]));
    }
  scene.rods.emplace_back(all, joints);
}

}  // namespace rodsweep
