// Lattices: nodes and rods against nearest neighbours; rest state, held and loaded segments, stiffness of nodes,
// refusals.
#include <cmath>
#include <map>
#include <set>

#include "solver/linear/linear_system.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/lattice_nodes.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_lattices {

using Cell = Lattice::Cell;

using test::cells, test::constraint_of, test::is_crossing, test::nodes_of, test::Place, test::point;

Place opposite(const Place& p) { return {-p[0], -p[1], -p[2]}; }

Lattice lattice(Cell cell, int x, int y, int z, int segments, Held held = Held::free) {
  Lattice p;
  p.cell = cell;
  p.nodes_x = x;
  p.nodes_y = y;
  p.nodes_z = z;
  p.segments = segments;
  p.held = held;
  p.mesh_m = 0.5;
  p.radius_m = 0.02;
  return p;
}

const std::vector<Lattice>& shapes() {
  static const std::vector<Lattice> all = [] {
    std::vector<Lattice> out;
    for (const Cell cell : cells)
      for (const int segments : {1, 2, 3})
        for (const Place& nodes : {Place{2, 2, 2}, Place{3, 0, 0}, Place{4, 2, 3}, Place{2, 3, 0}})
          out.push_back(lattice(cell, nodes[0], nodes[1], nodes[2], segments));
    return out;
  }();
  return all;
}

/// Number of rods through a node; opposite directions belong to one rod.
int rods_through(const std::set<Place>& ways) {
  int rods = 0;
  for (const Place& way : ways) rods += !ways.count(opposite(way)) || way < opposite(way);
  return rods;
}

bool in_interior(const Lattice& p, const Place& at) {
  const Place last = test::last_corner(p);
  for (std::size_t k = 0; k < 3; ++k)
    if (at[k] == 0 || at[k] == last[k]) return false;
  return true;
}

/// Segments with their centre within 1e-6 m of a point.
std::vector<int> segments_at(const Rod& rod, const Vector3& at) {
  std::vector<int> out;
  for (int s = 0; s < rod.segment_count(); ++s)
    if ((rod.position[s] - at).norm() < 1e-6) out.push_back(s);
  return out;
}

TEST_CASE("the nodes of a lattice are where its cell has them, with a rod for every pair of opposite neighbours") {
  for (const Lattice& p : shapes()) {
    const Rod rod = build_scene(p).rods.front();
    const auto nodes = nodes_of(p);
    int between = 0, at_nodes = 0, joints = 0;  // segments of struts without their ends, segments at nodes
    for (const auto& [at, ways] : nodes) {
      const int rods = rods_through(ways);
      const std::vector<int> segments = segments_at(rod, point(at, p));
      REQUIRE(static_cast<int>(segments.size()) == rods);
      std::set<Place> unseen = ways;
      for (const int s : segments) {
        const Vector3 along = director(rod.orientation[s]);
        for (const Place& way : ways)
          if (std::abs(along.dot(point(way, p).normalized())) > 1 - 1e-12) unseen.erase(way);
      }
      CHECK(unseen.empty());
      if (in_interior(p, at)) CHECK(rods == (p.cell == Cell::cubic ? 3 : p.cell == Cell::body_centred ? 4 : 6));
      between += static_cast<int>(ways.size()) * (p.segments - 1);
      joints += static_cast<int>(ways.size()) * p.segments;
      at_nodes += rods;
    }
    const int crossings = at_nodes - static_cast<int>(nodes.size());
    CHECK(rod.segment_count() == at_nodes + between / 2);
    CHECK(rod.joint_count() == joints / 2 + crossings);
  }
}

TEST_CASE("a lattice holds its nodes at x = 0, at its corners, or none, and joins nothing that is held to what is") {
  for (Lattice p : shapes()) {
    const Rod free = build_scene(p).rods.front();
    for (const Held held : {Held::side, Held::corners, Held::free}) {
      if (held == Held::corners && p.cell == Cell::cubic && p.nodes_x * p.nodes_y * p.nodes_z == 8 && p.segments == 1)
        continue;  // refused
      p.held = held;
      const Rod rod = build_scene(p).rods.front();
      CHECK(segment_count(p) == rod.segment_count());
      CHECK(joint_count(p) == rod.joint_count());
      std::set<int> expected;
      for (const auto& [at, ways] : nodes_of(p)) {
        const Place last = test::last_corner(p);
        const bool corner = at[0] % last[0] == 0 && at[1] % last[1] == 0 && at[2] % last[2] == 0;
        if (held == Held::side ? at[0] == 0 : held == Held::corners && corner)
          for (const int s : segments_at(rod, point(at, p))) expected.insert(s);
      }
      int joints = 0;
      for (const Joint& joint : free.joints) joints += !expected.count(joint.a) || !expected.count(joint.b);
      CHECK(rod.joint_count() == joints);
      for (int s = 0; s < rod.segment_count(); ++s) CHECK(rod.segments[s].is_static == (expected.count(s) > 0));
      CHECK_NOTHROW(refuse_static_joints(rod));
    }
  }
}

TEST_CASE("the load of a lattice is shared evenly by the nodes with the greatest x") {
  for (Lattice p : shapes()) {
    p.held = Held::side;
    CHECK(build_scene(p).loads.empty());
    p.tip_force_n = Vector3(1, -2, 3);
    const Scene scene = build_scene(p);
    const auto nodes = nodes_of(p);
    std::map<Place, Vector3> on;
    for (const auto& [at, ways] : nodes)
      if (at[0] == 2 * p.nodes_x - 2) on[at] = Vector3::Zero();
    Vector3 sum = Vector3::Zero();
    for (const PointLoad& load : scene.loads) {
      sum += load.force_n;
      for (auto& [at, force] : on)
        if ((scene.rods.front().position[load.segment] - point(at, p)).norm() < 1e-6) force += load.force_n;
      CHECK(load.arm_m.isZero());
      CHECK(load.torque_nm.isZero());
    }
    CHECK((sum - p.tip_force_n).norm() < 1e-13);
    for (const auto& [at, force] : on) CHECK((force - p.tip_force_n / static_cast<double>(on.size())).norm() < 1e-13);
  }
}

TEST_CASE("a lattice is at rest as it is built, and a raised one is the level one turned about z") {
  for (Lattice p : shapes()) {
    const Rod level = build_scene(p).rods.front();
    CHECK(constraint_of(level).lpNorm<Eigen::Infinity>() < 1e-13);
    CHECK(elastic_energy(level) < 1e-18);
    p.initial_angle_deg = 35;
    const Rod raised = build_scene(p).rods.front();
    const Quaternion turn(Eigen::AngleAxisd(35 * pi / 180, Vector3::UnitZ()));
    CHECK(constraint_of(raised).lpNorm<Eigen::Infinity>() < 1e-13);
    for (int s = 0; s < level.segment_count(); ++s) {
      CHECK((raised.position[s] - turn * level.position[s]).norm() < 1e-13);
      CHECK(raised.orientation[s].angularDistance(turn * level.orientation[s]) < 1e-7);
    }
  }
}

/// Stiffness of a joint against small rotations of its second segment, in the frame of that segment [Nm].
Matrix3 turning_stiffness(const Rod& rod, const Joint& joint) {
  JointJacobian jacobian;
  double constraint[6];
  linearize(rod, joint, jacobian, constraint);
  Matrix3 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      out(i, j) = 0;
      for (int row = 3; row < 6; ++row)
        out(i, j) += jacobian.rotation_b[i][row] * jacobian.rotation_b[j][row] / joint.compliance[row];
    }
  return out;
}

TEST_CASE("a node turns against EI / 2r of each of its joints, on the mean over all axes; in cubic cells about each") {
  // Bounds of the relative stiffness about any axis. Nodes on the boundary are farthest from 1.
  const std::map<Cell, std::pair<double, double>> bounds{
      {Cell::cubic, {1, 1}}, {Cell::body_centred, {0.358, 1.5}}, {Cell::octet, {0.308, 1.576}}};
  for (Lattice p : shapes()) {
    p.node_stiffness = 1.5;
    const Rod rod = build_scene(p).rods.front();
    const double stiffness = 1.5 * p.youngs_modulus_pa * pi * std::pow(p.radius_m, 4) / 4 / (2 * p.radius_m);
    const auto [least, most] = bounds.at(p.cell);
    for (const Joint& joint : rod.joints)
      if (is_crossing(joint)) {
        const VectorX values = test::eigenvalues(turning_stiffness(rod, joint) / stiffness);
        CHECK(values.mean() == Approx(1).epsilon(1e-12));
        CHECK(values[0] > least - 1e-9);
        CHECK(values[2] < most + 1e-9);
      }
  }
}

TEST_CASE("a node gives way to shifting by kappa G A / 2r, or as little as an inextensible rod") {
  Lattice p = lattice(Cell::body_centred, 3, 2, 2, 2);
  p.node_stiffness = 3;
  const Section section = circular_section(p.radius_m, p.youngs_modulus_pa, p.torsion_modulus_pa);
  for (const Stretch stretch : {Stretch::physical, Stretch::inextensible}) {
    p.stretch = stretch;
    const Rod rod = build_scene(p).rods.front();
    for (const Joint& joint : rod.joints) {
      if (!is_crossing(joint)) continue;
      const double soft = stretch == Stretch::physical
                              ? 2 * p.radius_m / (3 * section.shear_n * joint.length * joint.length)
                              : rod.joints.front().compliance[0];
      CHECK((joint.compliance.head<3>().array() / soft - 1).matrix().norm() < 1e-12);
    }
  }
}

TEST_CASE("lattices that cannot be are refused by what is wrong with them") {
  CHECK_THROWS_WITH(build_scene(lattice(Cell::cubic, 1, 2, 2, 1)), "nodes_x is 1; must be at least 2");
  CHECK_THROWS_WITH(build_scene(lattice(Cell::cubic, 2, 1, 2, 1)), "nodes_y is 1; must be at least 2");
  CHECK_THROWS_WITH(build_scene(lattice(Cell::octet, 2, 0, 1, 1)), "nodes_z is 1; must be at least 2");
  CHECK_THROWS_WITH(build_scene(lattice(Cell::octet, 2, 2, 2, 0)), "segments is 0; must be at least 1");
  CHECK_THROWS_WITH(build_scene(lattice(Cell::cubic, 2, 2, 2, 1, Held::corners)),
                    Catch::Matchers::StartsWith("segments is 1; must be at least 2: between the held corners"));
  CHECK_NOTHROW(build_scene(lattice(Cell::cubic, 2, 2, 2, 2, Held::corners)));
  CHECK_NOTHROW(build_scene(lattice(Cell::octet, 2, 2, 2, 1, Held::corners)));
  CHECK_THROWS_WITH(validate(lattice(Cell::cubic, 1000, 1000, 1000, 1)), Catch::Matchers::EndsWith(" 10000000"));
}

}  // namespace rodsweep::test_lattices
