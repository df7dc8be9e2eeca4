#include "tests/solver/support.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solver/numbers/rotation.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test {
namespace {

/// The rod after a change of degree of freedom `dof` of one segment, applied as a Newton update.
Rod nudged(Rod rod, int segment, int dof, double by) {
  if (dof < 3)
    rod.position[segment][dof] += by;
  else
    rod.orientation[segment] = rotated(rod.orientation[segment], by * Vector3::Unit(dof - 3));
  return rod;
}

}  // namespace

VectorX Random::entries(int count) {
  VectorX out(count);
  for (double& entry : out) entry = uniform(-1, 1);
  return out;
}

Quaternion Random::quaternion() {
  std::normal_distribution<double> normal;
  const double w = normal(engine_), x = normal(engine_), y = normal(engine_), z = normal(engine_);
  return Quaternion(w, x, y, z).normalized();
}

Edges chain(int segments) {
  Edges out;
  for (int i = 1; i < segments; ++i) out.emplace_back(i - 1, i);
  return out;
}

Edges tree(int depth, int branching) {
  Edges out;
  int first = 0, last = 0;  // of the previous level
  for (int level = 0; level < depth; ++level) {
    int next = last + 1;
    for (int parent = first; parent <= last; ++parent)
      for (int child = 0; child < branching; ++child) out.emplace_back(parent, next++);
    first = last + 1;
    last = next - 1;
  }
  return out;
}

Edges ring(int segments) {
  Edges out = chain(segments);
  out.emplace_back(segments - 1, 0);
  return out;
}

Edges net(int rows, int columns) {
  Edges out;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (c + 1 < columns) out.emplace_back(r * columns + c, r * columns + c + 1);
      if (r + 1 < rows) out.emplace_back(r * columns + c, (r + 1) * columns + c);
    }
  return out;
}

Edges random_couplings(int rows, int count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_int_distribution<int> any(0, rows - 1);
  Edges couplings;
  for (int i = 0; i < count; ++i) couplings.emplace_back(any(engine), any(engine));
  return couplings;
}

int segments_of(const Edges& edges) {
  int most = 0;
  for (const auto& [a, b] : edges) most = std::max({most, a, b});
  return most + 1;
}

std::vector<int> shuffled(int count, unsigned seed) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

Rod random_rod(const Edges& edges, const std::vector<int>& static_segments, unsigned seed) {
  Random random(seed);
  std::vector<SegmentSpec> segments;
  for (int i = 0; i < segments_of(edges); ++i) {
    SegmentSpec s;
    s.position_m = random.vector(1);
    s.orientation = random.quaternion();
    s.length_m = random.uniform(0.05, 0.2);
    s.radius_m = random.uniform(0.02, 0.06);
    s.density_kg_m3 = random.uniform(500, 2000);
    segments.push_back(s);
  }
  for (const int i : static_segments) segments[i].is_static = true;
  std::vector<JointSpec> joints;
  for (const auto& [a, b] : edges) {
    JointSpec j;
    j.a = a;
    j.b = b;
    j.arm_a_m = random.vector(0.1);
    j.arm_b_m = random.vector(0.1);
    for (double& row : j.compliance_per_j) row = std::pow(10, random.uniform(-6, -3));
    // Away from the boundary between the hemispheres, where finite differences would jump.
    const Quaternion d = segments[a].orientation.conjugate() * segments[b].orientation;
    do j.rest = random.quaternion();
    while (std::abs(d.dot(*j.rest)) < 0.1);
    if (joints.size() % 2 == 0) j.frame = random.quaternion();
    joints.push_back(j);
  }
  Rod rod(segments, joints);
  rod.lambda = 1e-3 * random.entries(6 * rod.joint_count());
  return rod;
}

Scene scene_of(const Rod& rod) {
  Scene scene;
  scene.rods.push_back(rod);
  return scene;
}

LinearSystem assembled(const Rod& rod, double dt) {
  LinearSystem system(rod);
  system.assemble(rod, dt);
  return system;
}

VectorX constraint_of(const Rod& rod) {
  Linearization at(rod);
  linearize(rod, at);
  return at.constraint;
}

void move_rigidly(Rod& rod, const Quaternion& turn, const Vector3& shift) {
  for (int s = 0; s < rod.segment_count(); ++s) {
    rod.position[s] = turn * rod.position[s] + shift;
    rod.orientation[s] = turn * rod.orientation[s];
  }
}

void set_rigid_velocity(Rod& rod, const Vector3& v, const Vector3& w) {
  for (int s = 0; s < rod.segment_count(); ++s) {
    rod.velocity[s] = v + w.cross(rod.position[s]);
    rod.angular_velocity[s] = w;
  }
}

BendingRod bending_rod(int segments, Clamp clamp) {
  BendingRod rod;
  rod.segments = segments;
  rod.clamp = clamp;
  rod.initial_angle_deg = 20;
  rod.youngs_modulus_pa = 1e6;
  return rod;
}

Rod shaken(Rod rod, unsigned seed, double shift) {
  Random random(seed);
  const auto angle = [&] { return random.uniform(-.1, .1); };
  for (int s = 0; s < rod.segment_count(); ++s) {
    if (rod.segments[s].is_static) continue;
    rod.position[s] += random.vector(shift);
    rod.orientation[s] = (rod.orientation[s] * Quaternion(1, angle(), angle(), angle())).normalized();
  }
  return rod;
}

Lattice lattice_of(Lattice::Cell cell, int nodes, int segments, Held held) {
  Lattice p;
  p.cell = cell;
  p.nodes_x = nodes;
  p.segments = segments;
  p.held = held;
  return p;
}

Lattice slender_lattice(Lattice::Cell cell, int nodes, int segments, Held held, double modulus) {
  Lattice p = lattice_of(cell, nodes, segments, held);
  p.radius_m = 0.01;
  p.youngs_modulus_pa = modulus;
  p.torsion_modulus_pa = 0.4 * modulus;
  return p;
}

VectorX residual(const BlockMatrix& a, const VectorX& b, const VectorX& x) {
  VectorX product(x.size());
  a.multiply(x.data(), product.data());
  return b - product;
}

Scene moving_scene(int segments, int steps) {
  Simulation simulation(build_scene(bending_rod(segments)), StepSettings{});
  simulation.run(steps);
  return simulation.scene;
}

namespace {

/// From the frame of segment a, turned into the joint's, to that of segment b.
Quaternion rotation_from_rest(const Rod& rod, const Joint& joint) {
  const Quaternion a = rod.orientation[joint.a] * joint.frame_a, b = rod.orientation[joint.b] * joint.frame_b;
  const Quaternion e = a.conjugate() * b;
  return e.w() < 0 ? Quaternion(-e.w(), -e.x(), -e.y(), -e.z()) : e;
}

Matrix3 half_way(const Rod& rod, const Joint& joint) {
  const Quaternion e = rotation_from_rest(rod, joint);
  const double half_turn = std::atan2(e.vec().norm(), e.w());
  return rod.orientation[joint.a] * joint.frame_a *
         Eigen::AngleAxisd(half_turn, e.vec().normalized()).toRotationMatrix();
}

std::vector<Matrix3> joint_frames(const Rod& rod) {
  std::vector<Matrix3> out;
  for (const Joint& joint : rod.joints) out.push_back(half_way(rod, joint));
  return out;
}

}  // namespace

VectorX constraint(const Rod& rod) { return constraint(rod, joint_frames(rod)); }

VectorX constraint(const Rod& rod, const std::vector<Matrix3>& frames) {
  VectorX out(6 * rod.joint_count());
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& j = rod.joints[k];
    const double length = (rod.segments[j.a].length_m + rod.segments[j.b].length_m) / 2;
    const Matrix3 ra = rod.orientation[j.a].toRotationMatrix(), rb = rod.orientation[j.b].toRotationMatrix();
    out.segment<3>(6 * k) =
        frames[k].transpose() * (rod.position[j.a] + ra * j.arm_a - rod.position[j.b] - rb * j.arm_b) / length;
    out.segment<3>(6 * k + 3) = 2 * rotation_from_rest(rod, j).vec();
  }
  return out;
}

DenseSystem dense_system(const Rod& rod, double dt) {
  const int m = 6 * rod.joint_count(), n = 6 * rod.segment_count();
  const std::vector<Matrix3> frames = joint_frames(rod);
  DenseSystem out{MatrixX::Zero(m, n), MatrixX::Zero(n, n), {}, {}};
  for (int s = 0; s < rod.segment_count(); ++s) {
    for (int dof = 0; dof < 6; ++dof) {
      const double h = dof < 3 ? 1e-3 : 3e-3;
      const auto at = [&](double steps) { return constraint(nudged(rod, s, dof, steps * h), frames); };
      out.jacobian.col(6 * s + dof) = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
    }
    const Segment& segment = rod.segments[s];
    if (segment.is_static) continue;
    const double r2 = segment.radius_m * segment.radius_m, l = segment.length_m;
    const double mass = segment.density_kg_m3 * pi * r2 * l;
    const Vector3 principal(mass * (3 * r2 + l * l) / 12, mass * (3 * r2 + l * l) / 12, mass * r2 / 2);
    const Matrix3 r = rod.orientation[s].toRotationMatrix();
    out.inverse_mass.block<3, 3>(6 * s, 6 * s) = Matrix3::Identity() / mass;
    out.inverse_mass.block<3, 3>(6 * s + 3, 6 * s + 3) = r * principal.cwiseInverse().asDiagonal() * r.transpose();
  }
  out.a = out.jacobian * out.inverse_mass * out.jacobian.transpose();
  out.b = -constraint(rod);
  for (int k = 0; k < rod.joint_count(); ++k)
    for (int row = 0; row < 6; ++row) {
      const double alpha = rod.joints[k].compliance[row] / (dt * dt);
      out.a(6 * k + row, 6 * k + row) += alpha;
      out.b[6 * k + row] -= alpha * rod.lambda[6 * k + row];
    }
  return out;
}

BlockMatrix random_matrix(const Edges& joints_coupled, int block_rows, unsigned seed) {
  Random random(seed);
  BlockMatrix a(block_rows, joints_coupled);
  for (int row = 0; row < block_rows; ++row)
    for (int k = a.row_begin(row); k < a.row_end(row); ++k) {
      const int column = a.column(k);
      if (column < row) continue;
      const MatrixX block = 0.5 * random.entries(36).reshaped(6, 6);
      const MatrixX here =
          column == row
              ? MatrixX(block + block.transpose() + 6.0 * (a.row_end(row) - a.row_begin(row)) * MatrixX::Identity(6, 6))
              : block;
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r) {
          a.blocks[k].column[c][r] = here(r, c);
          a.blocks[a.find(column, row)].column[r][c] = here(r, c);
        }
    }
  return a;
}

std::vector<std::set<int>> later_neighbours(const BlockMatrix& pattern, const std::vector<int>& row) {
  std::vector<int> place(row.size());
  for (std::size_t k = 0; k < row.size(); ++k) place[row[k]] = static_cast<int>(k);
  std::vector<std::set<int>> later(row.size());
  for (int k = 0; k < static_cast<int>(row.size()); ++k)
    for (int e = pattern.row_begin(row[k]); e < pattern.row_end(row[k]); ++e)
      if (place[pattern.column(e)] > k) later[k].insert(place[pattern.column(e)]);
  for (auto& column : later)
    if (!column.empty()) later[*column.begin()].insert(std::next(column.begin()), column.end());
  return later;
}

}  // namespace rodsweep::test
