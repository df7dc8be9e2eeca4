#include <map>

#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// In lengths of a segment, from a rod's first crossing.
struct Piece {
  double centre, length;  ///< length 0: a held point
  int crossing;           ///< at its centre, or -1
};

/// Crossings are centres of segments, so a rod extends half a segment beyond its outermost crossings. At a held
/// crossing there is a point between half segments instead; a rod that is held at its end ends there.
template <class Held>
std::vector<Piece> pieces(int crossings, int segments, const Held& held) {
  const int last = (crossings - 1) * segments;
  std::vector<Piece> out;
  for (int i = 0; i <= last; ++i) {
    const int crossing = i % segments == 0 ? i / segments : -1;
    if (crossing < 0 || !held(crossing)) {
      out.push_back({static_cast<double>(i), 1, crossing});
      continue;
    }
    if (i > 0) out.push_back({i - 0.25, 0.5, -1});
    out.push_back({static_cast<double>(i), 0, crossing});
    if (i < last) out.push_back({i + 0.25, 0.5, -1});
  }
  return out;
}

bool is_held(const Net& p, int row, int column) {
  switch (p.held) {
    case Held::side: return row == 0;
    case Held::corners: return (row == 0 || row == p.rows - 1) && (column == 0 || column == p.columns - 1);
    case Held::free: return false;
  }
  return false;
}

std::vector<Piece> along_x(const Net& p, int row) {
  return pieces(p.columns, p.segments, [&](int column) { return is_held(p, row, column); });
}

std::vector<Piece> along_z(const Net& p, int column) {
  return pieces(p.rows, p.segments, [&](int row) { return is_held(p, row, column); });
}

}  // namespace

void Net::check() const {
  check_least("rows", rows, 2);
  check_least("columns", columns, 2);
  check_least("segments", segments, 1);
  check_segments("a net", 2.0 * rows * columns * (segments + 1));
}

SceneSize Net::size() const {
  int count = 0, held_nodes = 0;
  for (int row = 0; row < rows; ++row) count += static_cast<int>(along_x(*this, row).size());
  for (int column = 0; column < columns; ++column) count += static_cast<int>(along_z(*this, column).size());
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) held_nodes += is_held(*this, row, column);
  return {count - held_nodes, count - rows - columns + rows * columns - held_nodes};
}

// Rods along x first, then those along z. Both rods at a held crossing share its point.
void Net::build(Scene& scene) const {
  const double length = mesh_m / segments;
  const Quaternion to_x = turn_between(Vector3::UnitZ(), Vector3::UnitX()), to_z = Quaternion::Identity();
  std::vector<SegmentSpec> all;
  std::vector<std::vector<int>> rods;
  std::map<std::pair<int, int>, std::vector<int>> crossings;  // segments at each (row, column)
  const auto add_rod = [&](const std::vector<Piece>& rod, const Vector3& start, const Quaternion& orientation,
                           const auto& crossing_of) {
    const Vector3 step = length * (orientation * Vector3::UnitZ());
    std::vector<int>& line = rods.emplace_back();
    for (const Piece& piece : rod) {
      auto* here = piece.crossing < 0 ? nullptr : &crossings[crossing_of(piece.crossing)];
      if (piece.length == 0 && !here->empty()) {
        line.push_back(here->front());
        continue;
      }
      line.push_back(static_cast<int>(all.size()));
      if (here) here->push_back(line.back());
      const Vector3 centre = start + piece.centre * step;
      all.push_back(piece.length == 0 ? held_point(centre, orientation)
                                      : segment_at(centre, orientation, piece.length * length, *this));
    }
  };
  for (int row = 0; row < rows; ++row)
    add_rod(along_x(*this, row), Vector3(0, 0, row * mesh_m), to_x, [row](int at) { return std::pair(row, at); });
  for (int column = 0; column < columns; ++column)
    add_rod(along_z(*this, column), Vector3(column * mesh_m, 0, 0), to_z,
            [column](int at) { return std::pair(at, column); });

  const double force = weight(all, *this);
  std::vector<JointSpec> joints;
  for (const std::vector<int>& line : rods)
    for (std::size_t i = 1; i < line.size(); ++i) {
      const SegmentSpec &a = all[at(line[i - 1])], &b = all[at(line[i])];
      joints.push_back(joint_between(all, line[i - 1], line[i], *this, force));
      if (a.orientation.coeffs() == b.orientation.coeffs()) continue;
      // The axes of stiffness are those of the rod, not of the point.
      joints.back().frame = b.is_static ? Quaternion::Identity() : a.orientation.conjugate() * b.orientation;
    }
  const double turning = stiffness(*this).bending_x_nm2 / length;
  for (const auto& [at, crossed] : crossings) {
    if (is_held(*this, at.first, at.second)) continue;
    const double shifting = joint_between(all, crossed[0], crossed[1], *this, force).compliance_per_j[0];
    joints.push_back(crossing_between(crossed[0], crossed[1], turning, shifting));
  }
  scene.rods.emplace_back(all, joints);
}

}  // namespace rodsweep
