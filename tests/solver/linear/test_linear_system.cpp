// A, b and the update against dense matrices from finite differences and world inertia tensors; the product without A.
#include <cmath>

#include "solver/linear/linear_system.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_linear_system {

using test::DenseSystem, test::Graph, test::MatrixX;

const std::vector<Graph>& graphs() {
  static const std::vector<Graph> all = {
      {"two free segments", test::chain(2), {}},
      {"chain held at its first segment", test::chain(7), {0}},
      {"chain held at its last segment", test::chain(7), {6}},
      {"chain held in the middle and at both ends", test::chain(9), {0, 4, 8}},
      {"tree with three children each", test::tree(2, 3), {}},
      {"tree held at the root", test::tree(2, 3), {0}},
      {"tree held at a branching and a leaf", test::tree(3, 2), {1, 14}},
      {"ring", test::ring(6), {}},
      {"held ring", test::ring(6), {2}},
      {"net", test::net(3, 3), {0, 8}},
      {"two joints between the same segments", {{0, 1}, {1, 0}, {1, 2}}, {}},
  };
  return all;
}

constexpr double dt = 0.013;

TEST_CASE("A is J M^-1 J^T + alpha / dt^2, symmetric and positive definite, and b is -C - alpha lambda / dt^2") {
  for (const Graph& graph : graphs())
    for (const unsigned seed : {0U, 1U, 2U, 17U}) {
      INFO(graph.name << ", seed " << seed);
      const Rod rod = test::random_rod(graph.edges, graph.held, seed);
      const LinearSystem system = test::assembled(rod, dt);
      const DenseSystem expected = test::dense_system(rod, dt);
      const MatrixX a = system.matrix().dense();
      CHECK(test::scaled_difference(a, expected.a) < 1e-9);
      CHECK(test::scaled_difference(a, a.transpose()) < 1e-14);
      CHECK(test::smallest_scaled_eigenvalue(a) > 1e-9);
      CHECK((system.rhs() - expected.b).lpNorm<Eigen::Infinity>() < 1e-12);
    }
}

TEST_CASE("A of an unbranched rod needs no compliance to be positive definite") {
  Rod rod = test::random_rod(test::chain(6), {0}, 2);
  for (Joint& joint : rod.joints) joint.compliance.setZero();
  CHECK(test::smallest_scaled_eigenvalue(test::assembled(rod, dt).matrix().dense()) > 1e-9);
}

TEST_CASE("assembling again writes the same bits, whatever was assembled between") {
  const Rod rod = test::random_rod(test::tree(2, 3), {0}, 4), other = test::random_rod(test::tree(2, 3), {0}, 5);
  LinearSystem system(rod);
  system.assemble(rod, dt);
  const MatrixX first = system.matrix().dense();
  const VectorX rhs = system.rhs();
  system.assemble(other, 2 * dt);
  REQUIRE(system.matrix().dense() != first);
  system.assemble(rod, dt);
  CHECK(system.matrix().dense() == first);
  CHECK(system.rhs() == rhs);
}

TEST_CASE("applying a solution moves the rod by M^-1 J^T dlambda, but no static segment, and adds to its multipliers") {
  for (const Graph& graph : graphs()) {
    INFO(graph.name);
    const Rod before = test::random_rod(graph.edges, graph.held, 23);
    Rod rod = before;
    LinearSystem system = test::assembled(rod, dt);
    const DenseSystem dense = test::dense_system(rod, dt);
    for (int again = 0; again < 2; ++again) {  // the second run must not keep impulses of the first
      rod = before;
      const VectorX dl = 1e-3 * test::Random(30 + again).entries(6 * rod.joint_count());
      system.apply(rod, dl);
      const VectorX moved = dense.inverse_mass * dense.jacobian.transpose() * dl;
      std::vector<Lane8> displacements;
      system.displacements(before, dl, displacements);  // in the segments' frames
      double worst = 0, worst_displacement = 0;
      for (int s = 0; s < rod.segment_count(); ++s) {
        const Vector3 shift = moved.segment<3>(6 * s), turn = moved.segment<3>(6 * s + 3);
        const Quaternion to_own = before.orientation[s].conjugate();
        Vector6 own;
        own << to_own * shift, to_own * turn;
        for (int i = 0; i < 6; ++i)
          worst_displacement = std::max(worst_displacement, std::abs(displacements[std::size_t(s)][i] - own[i]));
        worst = std::max(worst, (rod.position[s] - before.position[s] - shift).norm());
        worst = std::max(worst, (rod.orientation[s].coeffs() - rotated(before.orientation[s], turn).coeffs()).norm());
        if (!rod.segments[s].is_static) continue;
        CHECK(rod.position[s] == before.position[s]);  // bit for bit
        CHECK(rod.orientation[s].coeffs() == before.orientation[s].coeffs());
      }
      REQUIRE(moved.lpNorm<Eigen::Infinity>() > 1e-3);
      CHECK(worst < 1e-10);
      CHECK(worst_displacement < 1e-10 * moved.lpNorm<Eigen::Infinity>());
      CHECK((rod.lambda - before.lambda - dl).norm() < 1e-17);
    }
  }
}

TEST_CASE("a joint between two static segments is refused by number") {
  const Rod rod = test::random_rod(test::chain(5), {2, 3}, 1);
  CHECK_THROWS_MATCHES(LinearSystem(rod), SceneError,
                       Catch::Matchers::Message("joint 2 joins two static segments; remove it or free one of them"));
}

using namespace test;

double difference(const LinearSystem& system, const ConstraintProduct& product) {
  const VectorX x = VectorX::Random(system.matrix().unknowns());
  VectorX with(x), without(x);
  system.matrix().multiply(x.data(), with.data());
  product.multiply(x.data(), without.data());
  return (without - with).norm() / with.norm();
}

TEST_CASE("J (M^-1 (J^T x)) + alpha~ x is A x on any graph, held or free, for every number of joints in a register") {
  std::vector<Rod> rods{random_rod(tree(3, 3), {0}, 2), random_rod(ring(9), {}, 3), random_rod(net(4, 5), {0, 7}, 4)};
  for (int segments = 2; segments < 20; ++segments) rods.push_back(random_rod(chain(segments), {0}, 1));
  for (const Rod& rod : rods) {
    INFO(rod.joint_count());
    LinearSystem system(rod);
    ConstraintProduct product(rod);
    for (const double step_s : {0.02, 0.005}) {
      system.assemble(rod, step_s);
      product.update(rod, system.linearization(), 1 / (step_s * step_s));
      CHECK(difference(system, product) < 1e-13);
    }
  }
}

TEST_CASE("large systems multiply without their matrix, small ones with it, and both follow the positions") {
  Rod large = build_scene(lattice_of(Lattice::Cell::cubic, 4)).rods.front();
  const Rod small = random_rod(net(3, 3), {0}, 1);
  CHECK(LinearSystem(small).product() == nullptr);
  LinearSystem system(large);
  REQUIRE(system.product() != nullptr);
  for (int i = 0; i < 2; ++i) {
    system.assemble(large, 0.02);
    CHECK(difference(system, *system.product()) < 1e-14);
    for (Quaternion& q : large.orientation) q = q * Quaternion(1, 0.1, -0.2 * i, 0.05).normalized();
  }
  const LinearSystem moved = std::move(system);
  CHECK(difference(moved, *moved.product()) < 1e-14);
}

TEST_CASE("with the balance of momentum kept, the product knows the mobilities that geometric stiffness leaves") {
  Rod rod = build_scene(lattice_of(Lattice::Cell::cubic, 4)).rods.front();
  Random random(1);
  rod.lambda = 1e-3 * random.entries(6 * rod.joint_count());
  LinearSystem system(rod);
  system.assemble_balanced(rod, 0.02);
  CHECK(difference(system, *system.product()) < 1e-14);
}

}  // namespace rodsweep::test_linear_system
