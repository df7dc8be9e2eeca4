#include <array>
#include <map>

#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// In halves of a cell's edge.
using LatticeNode = std::array<int, 3>;

LatticeNode moved(const LatticeNode& from, const LatticeNode& by, int times = 1) {
  return {from[0] + times * by[0], from[1] + times * by[1], from[2] + times * by[2]};
}

Vector3 vector(const LatticeNode& place, double mesh_m) { return mesh_m / 2 * Vector3(place[0], place[1], place[2]); }

bool all_even(const LatticeNode& p) { return p[0] % 2 == 0 && p[1] % 2 == 0 && p[2] % 2 == 0; }

/// From a node to the next, for every family of parallel rods. If possible, no two are more than a right angle apart.
std::vector<LatticeNode> directions(Lattice::Cell cell) {
  switch (cell) {
    case Lattice::Cell::cubic: return {{0, 0, 2}, {2, 0, 0}, {0, 2, 0}};
    case Lattice::Cell::body_centred: return {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
    case Lattice::Cell::octet: return {{1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, -1, 0}, {1, 0, -1}, {0, 1, -1}};
  }
  return {};
}

bool is_node(Lattice::Cell cell, const LatticeNode& p) {
  switch (cell) {
    case Lattice::Cell::cubic: return all_even(p);
    case Lattice::Cell::body_centred: return all_even(p) || all_even(moved(p, {1, 1, 1}));
    case Lattice::Cell::octet: return (p[0] + p[1] + p[2]) % 2 == 0;
  }
  return false;
}

/// Nodes that a straight rod goes through.
struct LatticeLine {
  LatticeNode first, direction;
  int nodes;
};

struct Layout {
  LatticeNode last;  ///< the corner of the box that is farthest from the first
  std::vector<LatticeLine> lines;
};

/// Corners of cells along x, y and z.
LatticeNode corner_nodes(const Lattice& p) {
  const auto or_x = [&](int nodes) { return nodes == 0 ? p.nodes_x : nodes; };
  return {p.nodes_x, or_x(p.nodes_y), or_x(p.nodes_z)};
}

Layout layout(const Lattice& p) {
  const LatticeNode nodes = corner_nodes(p);
  Layout out{{2 * (nodes[0] - 1), 2 * (nodes[1] - 1), 2 * (nodes[2] - 1)}, {}};
  const auto within = [&](const LatticeNode& at) {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] <= out.last[0] && at[1] <= out.last[1] &&
           at[2] <= out.last[2];
  };
  for (const LatticeNode& direction : directions(p.cell))
    for (int x = 0; x <= out.last[0]; ++x)
      for (int y = 0; y <= out.last[1]; ++y)
        for (int z = 0; z <= out.last[2]; ++z) {
          const LatticeNode at{x, y, z};
          if (!is_node(p.cell, at) || within(moved(at, direction, -1))) continue;
          int count = 1;
          while (within(moved(at, direction, count))) ++count;
          if (count > 1) out.lines.push_back({at, direction, count});
        }
  return out;
}

bool is_held(const Lattice& p, const LatticeNode& last, const LatticeNode& at) {
  const auto at_end = [&](std::size_t axis) { return at[axis] == 0 || at[axis] == last[axis]; };
  switch (p.held) {
    case Held::side: return at[0] == 0;
    case Held::corners: return at_end(0) && at_end(1) && at_end(2);
    case Held::free: return false;
  }
  return false;
}

int segments_of(const Lattice& p, const LatticeLine& line) { return (line.nodes - 1) * p.segments + 1; }

/// Calls held(s) for held segments, then joint(a, b) for neighbours along a rod and crossing(a, b) for joints of a
/// node, all with numbers of segments. Omits pairs of held segments.
template <class Held, class Joint, class Crossing>
void connect(const Lattice& p, const Layout& layout, const Held& held, const Joint& joint, const Crossing& crossing) {
  std::map<LatticeNode, std::vector<int>> nodes;  // segments at each
  std::vector<char> is_static;
  for (const LatticeLine& line : layout.lines)
    for (int i = 0; i < segments_of(p, line); ++i) {
      const auto s = static_cast<int>(is_static.size());
      const bool node = i % p.segments == 0;
      const LatticeNode at = moved(line.first, line.direction, i / p.segments);
      is_static.push_back(node && is_held(p, layout.last, at));
      if (is_static.back()) held(s);
      if (node) nodes[at].push_back(s);
    }
  const auto moves = [&](int a, int b) { return !(is_static[at(a)] && is_static[at(b)]); };
  int s = 0;
  for (const LatticeLine& line : layout.lines)
    for (int i = 0; i < segments_of(p, line); ++i, ++s)
      if (i > 0 && moves(s - 1, s)) joint(s - 1, s);
  for (const auto& [at, crossed] : nodes)
    for (std::size_t k = 1; k < crossed.size(); ++k)
      if (moves(crossed[0], crossed[k])) crossing(crossed[0], crossed[k]);
}

}  // namespace

void Lattice::check() const {
  const LatticeNode nodes = corner_nodes(*this);
  check_least("nodes_x", nodes[0], 2);
  check_least("nodes_y", nodes[1], 2);
  check_least("nodes_z", nodes[2], 2);
  check_least("segments", segments, 1);
  if (held == Held::corners && cell == Cell::cubic && nodes == LatticeNode{2, 2, 2})
    check_least("segments", segments, 2, ": between the held corners of a single cell nothing would be free");
  check_segments("a lattice", static_cast<double>(directions(cell).size()) * nodes[0] * nodes[1] * nodes[2] *
                                  (cell == Cell::cubic ? 1 : 2) * segments);
}

SceneSize Lattice::size() const {
  const Layout all = layout(*this);
  SceneSize out;
  for (const LatticeLine& line : all.lines) out.segments += segments_of(*this, line);
  const auto count = [&](int, int) { ++out.joints; };
  connect(
      *this, all, [](int) {}, count, count);
  return out;
}

void Lattice::build(Scene& scene) const {
  const Layout all = layout(*this);
  const Quaternion raised(Eigen::AngleAxisd(initial_angle_deg * pi / 180, Vector3::UnitZ()));
  const Vector3 first_axis = vector(all.lines.front().direction, 1).normalized();
  const Quaternion first_frame = turn_between(Vector3::UnitZ(), first_axis);
  std::vector<SegmentSpec> segments_;
  std::map<LatticeNode, std::vector<int>> loaded;
  for (const LatticeLine& line : all.lines) {
    const Vector3 strut = vector(line.direction, mesh_m), start = vector(line.first, mesh_m);
    const Quaternion frame = raised * turn_between(first_axis, strut) * first_frame;
    for (int i = 0; i < segments_of(*this, line); ++i) {
      const LatticeNode at = moved(line.first, line.direction, i / segments);
      if (i % segments == 0 && at[0] == all.last[0]) loaded[at].push_back(static_cast<int>(segments_.size()));
      segments_.push_back(segment_at(raised * (start + static_cast<double>(i) / segments * strut), frame,
                                     strut.norm() / segments, *this));
    }
  }
  const double force = weight(segments_, *this) + tip_force_n.norm();
  const Section rod = stiffness(*this);
  const double turning = node_stiffness * rod.bending_x_nm2 / (2 * radius_m);
  const double shifting = node_stiffness * rod.shear_n / (2 * radius_m);
  std::vector<JointSpec> joints;
  connect(
      *this, all, [&](int s) { segments_[at(s)].is_static = true; },
      [&](int a, int b) { joints.push_back(joint_between(segments_, a, b, *this, force)); },
      [&](int a, int b) {
        const double length = segments_[at(a)].length_m;
        const double soft =
            stretch == Stretch::physical ? 1 / (shifting * length * length) : stretch_compliance(length, force, *this);
        joints.push_back(crossing_between(a, b, turning, soft));
      });
  scene.rods.emplace_back(segments_, joints);
  if (tip_force_n.isZero()) return;
  for (const auto& [at, crossed] : loaded)
    for (const int s : crossed)
      scene.loads.push_back(
          {0, s, tip_force_n / static_cast<double>(loaded.size() * crossed.size()), Vector3::Zero(), Vector3::Zero()});
}

}  // namespace rodsweep
