// Sample rods for the solver's tests, and their dense systems.
//
// These share no formula with the solver: constraints use rotation matrices, Jacobians are fourth-order central
// differences (accurate to about 1e-11), masses follow from the segments' radius, length and density.
#pragma once

#include <random>
#include <set>
#include <utility>
#include <vector>

#include "solver/linear/linear_system.hpp"
#include "solver/rod/rod.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/solver/dense.hpp"

namespace rodsweep::test {

/// Reproducible random numbers.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vector3 vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  VectorX entries(int count);
  Quaternion quaternion();  ///< uniform over all unit quaternions, both hemispheres included

 private:
  std::mt19937 engine_;
};

// Graphs: pairs of segments that share a joint.
using Edges = std::vector<std::pair<int, int>>;
Edges chain(int segments);
Edges tree(int depth, int branching);  ///< segment 0 is the root; children have larger numbers than parents
Edges ring(int segments);
Edges net(int rows, int columns);
int segments_of(const Edges& edges);
struct Graph {
  const char* name;
  Edges edges;
  std::vector<int> held;  ///< segments
};
std::vector<int> shuffled(int count, unsigned seed);  ///< 0 ... count - 1
/// `count` random pairs of rows. Pairs may repeat, and a row may be paired with itself.
Edges random_couplings(int rows, int count, unsigned seed);

/// Random poses, arms, rest rotations, sizes, compliances and multipliers. Its constraints are far from zero.
Rod random_rod(const Edges& edges, const std::vector<int>& static_segments, unsigned seed);

/// Moves free segments at random by up to `shift` along every axis and turns them, so that all joints differ.
Rod shaken(Rod rod, unsigned seed, double shift = 0.01);

Scene scene_of(const Rod& rod);
LinearSystem assembled(const Rod& rod, double dt = 0.02);
/// C of all joints by linearize().
VectorX constraint_of(const Rod& rod);
void move_rigidly(Rod& rod, const Quaternion& turn, const Vector3& shift);
/// Sets the velocities of a rigid motion: v at the origin and angular velocity w.
void set_rigid_velocity(Rod& rod, const Vector3& v, const Vector3& w);

/// Parameters of a straight or bent rod with zero constraints, as scenes build it.
BendingRod bending_rod(int segments, Clamp clamp = Clamp::segment);
/// Parameters of a lattice with the same number of nodes along every edge.
Lattice lattice_of(Lattice::Cell cell, int nodes, int segments = 3, Held held = Held::corners);
/// The same of rods of 1 cm, which is condensed from some size on.
Lattice slender_lattice(Lattice::Cell cell, int nodes, int segments = 3, Held held = Held::side, double modulus = 1e6);
/// A moving, bending rod after `steps` direct steps.
Scene moving_scene(int segments, int steps = 8);

/// C of all joints, computed independently of linearize(); stretch-shear rows in `frames`, one per joint.
VectorX constraint(const Rod& rod, const std::vector<Matrix3>& frames);
VectorX constraint(const Rod& rod);  ///< in the rod's own frames

struct DenseSystem {
  MatrixX jacobian;      ///< 6 per joint x 6 per segment (x, theta), in the world; the joints' frames are constant
  MatrixX inverse_mass;  ///< world frame; zero for static segments
  MatrixX a;
  VectorX b;
};
DenseSystem dense_system(const Rod& rod, double dt);

/// b - A x, by the product of CG.
VectorX residual(const BlockMatrix& a, const VectorX& b, const VectorX& x);

/// The rod of a tree, its assembled system and the solution.
struct OneRod {
  Scene scene = scene_of(random_rod(tree(2, 3), {0}, 1));
  LinearSystem system = assembled(scene.rods[0]);
  MatrixX a = system.matrix().dense();
  VectorX exact = dense_solve(a, system.rhs());

  int size() const { return system.matrix().unknowns(); }
};

/// The pattern of a graph's system with random entries; symmetric positive definite and well conditioned.
BlockMatrix random_matrix(const Edges& joints_coupled, int block_rows, unsigned seed);

/// For every column its later neighbours, fill included, when elimination follows the order of `row`.
std::vector<std::set<int>> later_neighbours(const BlockMatrix& pattern, const std::vector<int>& row);

}  // namespace rodsweep::test
