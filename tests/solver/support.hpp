// Sample rods for the solver's tests, and their dense systems.
//
// These share no formula with the solver: constraints through rotation matrices, Jacobians by fourth-order
// central differences of them (good to about 1e-11), masses from the segments' radius, length and density.
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

/// Numbers that are the same in every run.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vector3 vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  VectorX entries(int count);
  Quaternion quaternion();  ///< uniform over all unit quaternions, so in both hemispheres

 private:
  std::mt19937 engine_;
};

// Graphs: pairs of segments that a joint joins.
using Edges = std::vector<std::pair<int, int>>;
Edges chain(int segments);
Edges tree(int depth, int branching);  ///< segment 0 the root, children numbered after their parents
Edges ring(int segments);
Edges net(int rows, int columns);
int segments_of(const Edges& edges);
struct Graph {
  const char* name;
  Edges edges;
  std::vector<int> held;  ///< segments
};
std::vector<int> shuffled(int count, unsigned seed);        ///< the numbers from 0
bool names_each_once(std::vector<int> numbers, int count);  ///< of the numbers from 0
/// So many pairs of rows, any of them repeated or of a row with itself.
Edges random_couplings(int rows, int count, unsigned seed);

/// Random everything: poses, arms, rest rotations, sizes, compliances, multipliers. Its constraints are far from zero.
Rod random_rod(const Edges& edges, const std::vector<int>& static_segments, unsigned seed);

Scene scene_of(const Rod& rod);
LinearSystem assembled(const Rod& rod, double dt = 0.02);
/// C of all joints as linearize() has it.
VectorX constraint_of(const Rod& rod);
void move_rigidly(Rod& rod, const Quaternion& turn, const Vector3& shift);
/// v and w of a rigid motion about the origin.
void set_rigid_velocity(Rod& rod, const Vector3& v, const Vector3& w);

/// A straight or bent rod whose constraints are zero, as the scenes build it.
BendingRod bending_rod(int segments, Clamp clamp = Clamp::segment);
/// As many nodes along every edge.
Lattice lattice_of(Lattice::Cell cell, int nodes, int segments = 3, Held held = Held::corners);
/// A bending rod in the middle of its motion after some direct steps.
Scene moving_scene(int segments, int steps = 8);

/// C of all joints, independently of linearize(), stretch-shear rows in these frames, one a joint.
VectorX constraint(const Rod& rod, const std::vector<Matrix3>& frames);
VectorX constraint(const Rod& rod);  ///< in the rod's own

struct DenseSystem {
  MatrixX jacobian;      ///< 6 per joint x 6 per segment (x, theta), in the world; joints' frames stand still
  MatrixX inverse_mass;  ///< world frame; zero for static segments
  MatrixX a;
  VectorX b;
};
DenseSystem dense_system(const Rod& rod, double dt);

/// A tree's rod, its assembled system and the solution of that.
struct OneRod {
  Scene scene = scene_of(random_rod(tree(2, 3), {0}, 1));
  LinearSystem system = assembled(scene.rods[0]);
  MatrixX a = system.matrix().dense();
  VectorX exact = dense_solve(a, system.rhs());

  int size() const { return system.matrix().unknowns(); }
};

/// The pattern of a graph's system, with random well-conditioned symmetric positive definite entries.
BlockMatrix random_matrix(const Edges& joints_coupled, int block_rows, unsigned seed);

/// Later neighbours of every column, fill included, of an elimination in the order of `row`.
std::vector<std::set<int>> later_neighbours(const BlockMatrix& pattern, const std::vector<int>& row);

}  // namespace rodsweep::test
