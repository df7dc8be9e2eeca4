// Lattices against frames of Timoshenko beams (timoshenko_frame.hpp): cantilevers with stiff nodes under end loads,
// their first bending frequency, an exact state of strain. The frame includes the rods' half segments beyond the last
// nodes as beams, so that both have the same mass.
#include <cmath>
#include <map>

#include "tests/catch.hpp"
#include "tests/solver/lattice_nodes.hpp"
#include "tests/solver/oscillation.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"
#include "tests/solver/timoshenko_frame.hpp"

namespace rodsweep::test_validation_lattices {

using Cell = Lattice::Cell;
using test::cells, test::constraint_of, test::is_crossing, test::moved, test::nodes_of, test::Place, test::point;
using test::TimoshenkoFrame;

/// A weightless lattice with stiff nodes, held at one side.
Lattice cantilever(Cell cell, int nodes_x, int across, int segments) {
  Lattice p = test::lattice_of(cell, nodes_x, segments, Held::side);
  p.nodes_y = p.nodes_z = across;
  p.radius_m = 0.02;
  p.youngs_modulus_pa = 1e7;
  p.torsion_modulus_pa = 4e6;
  p.node_stiffness = 1e6;
  p.gravity_m_s2.setZero();
  return p;
}

/// The frame of a lattice and the frame's number of each lattice node.
struct LatticeFrame {
  TimoshenkoFrame frame;
  std::map<Place, int> nodes;

  LatticeFrame(const Lattice& p, int beams_of_strut)
      : frame(test::round_beam(p.radius_m, p.density_kg_m3, p.youngs_modulus_pa, p.torsion_modulus_pa)) {
    for (const auto& [at, ways] : nodes_of(p)) {
      nodes[at] = frame.add_node(point(at, p));
      if (at[0] == 0) frame.hold(nodes[at]);
    }
    for (const auto& [at, node] : nodes)
      for (const Place& way : test::ways_of(p.cell)) {
        if (way < Place{}) continue;  // one of two opposite directions
        const bool there = nodes.count(moved(at, way)), before = nodes.count(moved(at, way, -1));
        if (there) {
          int last = node;
          for (int i = 1; i < beams_of_strut; ++i) {
            const int next = frame.add_node(point(at, p) + static_cast<double>(i) / beams_of_strut * point(way, p));
            frame.add_beam(last, next);
            last = next;
          }
          frame.add_beam(last, nodes[moved(at, way)]);
        }
        if (there != before && at[0] > 0)
          frame.add_beam(node, frame.add_node(point(at, p) + (there ? -0.5 : 0.5) / p.segments * point(way, p)));
      }
    frame.assemble();
  }

  /// A force shared by the nodes with the largest x.
  VectorX end_load(const Lattice& p, const Vector3& force) {
    VectorX loads = frame.no_load();
    int count = 0;
    for (const auto& [at, node] : nodes) count += at[0] == 2 * p.nodes_x - 2;
    for (const auto& [at, node] : nodes)
      if (at[0] == 2 * p.nodes_x - 2) frame.of(loads, node).head<3>() += force / count;
    return loads;
  }
};

/// The face with the largest x: its mean deflection, and the slope of its best straight line.
struct End {
  double sinking = 0, slope = 0;
};

/// `shift_of` maps a place to its displacement.
template <class Shift>
End end_of(const Lattice& p, const Shift& shift_of) {
  double count = 0, sinking = 0, height = 0, height_square = 0, along = 0, product = 0;
  for (const auto& [at, ways] : nodes_of(p)) {
    if (at[0] != 2 * p.nodes_x - 2) continue;
    const Vector3 shift = shift_of(at);
    const double y = point(at, p).y();
    count += 1;
    sinking -= shift.y();
    height += y;
    height_square += y * y;
    along += shift.x();
    product += y * shift.x();
  }
  return {sinking / count, (product - height * along / count) / (height_square - height * height / count)};
}

/// The segment at each node.
std::map<Place, int> segments_at_nodes(const Lattice& p, const Rod& rod) {
  std::map<Place, int> out;
  for (const auto& [at, ways] : nodes_of(p))
    for (int s = 0; s < rod.segment_count(); ++s)
      if ((rod.position[s] - point(at, p)).norm() < 1e-9) out[at] = s;
  return out;
}

/// Relative error of the lattice's end against its frame's, under a transverse end load that deflects it by a
/// thousandth of its length.
End static_error(Lattice p) {
  LatticeFrame frame(p, 1);
  const Vector3 down(0, -1, 0);
  const VectorX unit = frame.frame.displacements(frame.end_load(p, down));
  const End expected =
      end_of(p, [&](const Place& at) { return Vector3(frame.frame.at(unit, frame.nodes[at]).head<3>()); });
  const double force = 1e-3 * (p.nodes_x - 1) * p.mesh_m / expected.sinking;
  p.tip_force_n = force * down;
  Scene scene = build_scene(p);
  const Rod start = scene.rods.front();
  const auto segments = segments_at_nodes(p, start);
  Simulation simulation(std::move(scene), 5);
  simulation.relax(1e-10);
  const End found = end_of(p, [&](const Place& at) {
    const auto s = static_cast<std::size_t>(segments.at(at));
    return Vector3(simulation.rod().position[s] - start.position[s]);
  });
  return {found.sinking / (force * expected.sinking) - 1, found.slope / (force * expected.slope) - 1};
}

/// Relative error of the first bending frequency against the frame's, from a small free oscillation in the frame's mode
/// shape.
double frequency_error(const Lattice& p) {
  LatticeFrame frame(p, p.segments);  // frame nodes at the centres of segments
  const TimoshenkoFrame::Mode mode = frame.frame.lowest_mode(frame.end_load(p, Vector3(0, -1, 0)));
  const double w = mode.angular_frequency, dt = 2 * pi / w / 200;
  Scene scene = build_scene(p);
  Rod& start = scene.rods.front();
  const double amplitude = 1e-5 * p.mesh_m;  // of the mode's largest entry [m, rad]
  for (std::size_t s = 0; s < start.segments.size(); ++s) {
    if (start.segments[s].is_static) continue;
    const Vector6 shape = amplitude * w * frame.frame.at(mode.shape, frame.frame.node_at(start.position[s]));
    start.velocity[s] = shape.head<3>();
    start.angular_velocity[s] = shape.tail<3>();
  }
  const std::complex<double> z = factor_per_step(std::move(scene), dt, 200, 40);
  return std::tan(std::arg(z)) / dt / w - 1;
}

/// Order of convergence from the errors of N and 2 N segments.
double order(double coarse, double fine) { return std::log2(coarse / fine); }
/// Limit for infinitely many segments of an error in 1 / N^2 and 1 / N^4.
double limit(double coarse, double fine) { return (4 * fine - coarse) / 3; }

/// A free cubic lattice with three nodes along every edge.
Lattice block() {
  Lattice p = cantilever(Cell::cubic, 3, 3, 2);
  p.held = Held::free;
  p.node_stiffness = 1;
  return p;
}

/// The largest force or moment (over a radius) in a joint, but for the axial force between crossings [N].
double not_tension(const Rod& rod, const Lattice& p) {
  const VectorX c = constraint_of(rod);
  double most = 0;
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[k];
    Vector6 load = c.segment<6>(6 * k).cwiseQuotient(joint.compliance);
    load.head<3>() /= joint.length;
    load.tail<3>() /= p.radius_m;
    if (!is_crossing(joint)) load[2] = 0;
    most = std::max(most, load.lpNorm<Eigen::Infinity>());
  }
  return most;
}

TEST_CASE("A cantilever of a lattice sinks and tilts as a frame of Timoshenko beams, with an error of second order") {
  for (const Cell cell : cells) {
    const End coarse = static_error(cantilever(cell, 4, 2, 8)), fine = static_error(cantilever(cell, 4, 2, 16));
    CAPTURE(cell, coarse.sinking, fine.sinking, coarse.slope, fine.slope);
    CHECK(std::abs(fine.sinking) < 4e-3);
    CHECK(std::abs(fine.slope) < 4e-3);
    CHECK(order(coarse.sinking, fine.sinking) == Approx(2).margin(0.05));
    CHECK(order(coarse.slope, fine.slope) == Approx(2).margin(0.05));
    CHECK(std::abs(limit(coarse.sinking, fine.sinking)) < 1e-4);
    CHECK(std::abs(limit(coarse.slope, fine.slope)) < 1e-4);
  }
}

TEST_CASE("A cantilever of a lattice swings as a frame of Timoshenko beams, with an error of second order") {
  for (const Cell cell : cells) {
    const double coarse = frequency_error(cantilever(cell, 4, 2, 8)),
                 fine = frequency_error(cantilever(cell, 4, 2, 16));
    CAPTURE(cell, coarse, fine);
    CHECK(std::abs(fine) < 2e-3);
    CHECK(order(coarse, fine) == Approx(2).margin(0.05));
    CHECK(std::abs(limit(coarse, fine)) < 1e-4);
  }
}

TEST_CASE("A cantilever of two by two by four cells sinks, tilts and swings as a frame does", "[.long]") {
  for (const Cell cell : cells) {
    const Lattice p = cantilever(cell, 5, 3, 16);
    const End end = static_error(p);
    const double frequency = frequency_error(p);
    CAPTURE(cell, end.sinking, end.slope, frequency);
    CHECK(std::abs(end.sinking) < 5e-3);
    CHECK(std::abs(end.slope) < 5e-3);
    CHECK(std::abs(frequency) < 3e-3);
  }
}

TEST_CASE("A lattice pulled at both ends of its rods along x comes to rest stretched evenly") {
  const Lattice p = block();
  Scene scene = build_scene(p);
  const Rod start = scene.rods.front();
  const double axial = p.youngs_modulus_pa * pi * p.radius_m * p.radius_m, strain = 1e-3, end = 2 * p.mesh_m;
  for (int s = 0; s < start.segment_count(); ++s) {
    const auto i = static_cast<std::size_t>(s);
    const double x = start.position[i].x();
    if (director(start.orientation[i]).x() > 0.5 && (x < 1e-9 || x > end - 1e-9))
      scene.loads.push_back(
          {0, s, Vector3(x < 1e-9 ? -1 : 1, 0, 0) * strain * axial, Vector3::Zero(), Vector3::Zero()});
  }
  REQUIRE(scene.loads.size() == 18);
  Simulation simulation(std::move(scene), 0.2);
  simulation.relax(1e-11);
  const Vector3 middle(p.mesh_m, p.mesh_m, p.mesh_m);
  for (std::size_t s = 0; s < start.position.size(); ++s) {
    const Vector3 from = start.position[s] - middle;
    CHECK((simulation.rod().position[s] - middle - from - Vector3(strain * from.x(), 0, 0)).norm() < 1e-8 * p.mesh_m);
  }
  CHECK(not_tension(simulation.rod(), p) < 1e-6 * strain * axial);
}

}  // namespace rodsweep::test_validation_lattices
