// The matrix-free product against the product with the matrix.
#include <catch2/catch.hpp>

#include "solver/linear/linear_system.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_constraint_product {

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
    for (const double dt : {0.02, 0.005}) {
      system.assemble(rod, dt);
      product.update(rod, system.linearization(), 1 / (dt * dt));
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

}  // namespace rodsweep::test_constraint_product
