// The choice between the factor of A and that of the condensed system; the condensed solution against that of A.
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "solver/factor/direct_factor.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_direct_factor {

using Cell = Lattice::Cell;
using test::slender_lattice;
constexpr double dt = 0.02;

template <class Parameters>
Rod rod_of(const Parameters& p) {
  return build_scene(p).rods.front();
}

Rod physical_net(int rods) {
  Net p;
  p.rows = p.columns = rods;
  p.radius_m = 0.01;
  p.stretch = Stretch::physical;
  return rod_of(p);
}

VectorX solved_whole(const Rod& rod, const LinearSystem& system) {
  VectorX x = VectorX::Zero(system.rhs().size());
  BlockFactor factor(system.matrix(), root_to_leaf_order(rod));
  REQUIRE(factor.solve(system.matrix(), system.rhs(), x) == SolveOutcome::converged);
  return x;
}

VectorX solved(DirectFactor& factor, const Rod& rod, const LinearSystem& system) {
  VectorX x = VectorX::Zero(system.rhs().size());
  REQUIRE(factor.solve(rod, system, x) == SolveOutcome::converged);
  return x;
}

/// |b - A x| / |b|.
double residual_of(const LinearSystem& system, const VectorX& x) {
  return test::residual(system.matrix(), system.rhs(), x).norm() / system.rhs().norm();
}

double difference(const VectorX& one, const VectorX& other) { return (one - other).norm() / other.norm(); }

TEST_CASE(
    "lattices that stretch physically are condensed; chains, trees, rings and nets of almost rigid rods are not") {
  for (const Cell cell : {Cell::cubic, Cell::body_centred, Cell::octet})
    for (const int segments : {1, 3}) {
      const DirectFactor factor(rod_of(slender_lattice(cell, 4, segments)));
      CHECK(factor.condenses());
      CHECK_FALSE(factor.has_whole());
    }
  CHECK(DirectFactor(physical_net(8)).condenses());
  CHECK_FALSE(DirectFactor(rod_of(slender_lattice(Cell::cubic, 2))).condenses());
  for (const Rod& rod : {test::random_rod(test::chain(40), {0}, 1), test::random_rod(test::tree(4, 2), {0}, 2),
                         test::random_rod(test::ring(40), {}, 3), test::random_rod({}, {}, 4)})
    CHECK_FALSE(DirectFactor(rod).condenses());
  Lattice rigid = slender_lattice(Cell::cubic, 5);
  rigid.stretch = Stretch::inextensible;
  CHECK_FALSE(DirectFactor(rod_of(rigid)).condenses());
  Net net;
  net.rows = net.columns = 16;
  CHECK_FALSE(DirectFactor(rod_of(net)).condenses());
}

TEST_CASE("whether a rod can be condensed depends on the ratio of its compliances alone") {
  Rod rod = rod_of(slender_lattice(Cell::cubic, 3));
  CHECK(can_be_condensed(rod));
  for (Joint& joint : rod.joints) joint.compliance *= 1e-30;
  CHECK(can_be_condensed(rod));
  rod.joints[17].compliance[2] *= 1e-7;
  CHECK_FALSE(can_be_condensed(rod));
  rod.joints[17].compliance[2] = 0;
  CHECK_FALSE(can_be_condensed(rod));
}

TEST_CASE("a condensed system has the solution of the factor of A") {
  for (const Cell cell : {Cell::cubic, Cell::body_centred, Cell::octet})
    for (const int segments : {1, 2, 5})
      for (const Held held : {Held::side, Held::corners, Held::free})
        for (const bool balanced : {false, true}) {
          CAPTURE(static_cast<int>(cell), segments, static_cast<int>(held), balanced);
          Rod rod = test::shaken(rod_of(slender_lattice(cell, cell == Cell::octet ? 3 : 4, segments, held)), 1, 1e-3);
          rod.lambda = 1e-6 * test::Random(5).entries(6 * rod.joint_count());
          rod.free_position = rod.position;
          rod.free_orientation = rod.orientation;
          LinearSystem system(rod);
          balanced ? system.assemble_balanced(rod, dt) : system.assemble(rod, dt);
          DirectFactor factor(rod);
          REQUIRE(factor.condenses());
          const VectorX x = solved(factor, rod, system);
          CHECK_FALSE(factor.has_whole());
          CHECK(residual_of(system, x) < 1e-11);
          CHECK(difference(x, solved_whole(rod, system)) < 1e-11);
        }
}

TEST_CASE("soft rods need no correction, stiff ones a single one, after which the residual is as small as by A") {
  const auto check = [](const Rod& rod, int corrections) {
    const LinearSystem system = test::assembled(rod, dt);
    REQUIRE(can_be_condensed(rod));
    Condensation condensation(rod);
    EliminationPlan plan = plan_crossings(condensation);
    CondensedFactor factor(std::move(condensation), std::move(plan));
    VectorX d;
    REQUIRE(factor.solve(rod, system, d));
    CHECK(factor.corrections() == corrections);
    CHECK(residual_of(system, d) < std::max(1e-12, 2 * residual_of(system, solved_whole(rod, system))));
  };
  for (const Cell cell : {Cell::cubic, Cell::body_centred, Cell::octet})
    for (const double modulus : {1e6, 1e9, 2e11})
      check(test::shaken(rod_of(slender_lattice(cell, 3, 3, Held::side, modulus)), 2, 1e-4), modulus > 1e6);
  Lattice p = slender_lattice(Cell::cubic, 3);
  p.stretch = Stretch::inextensible;
  p.stretch_compliance_per_j = 1.2e-5;
  check(test::shaken(rod_of(p), 3, 1e-4), 1);
}

TEST_CASE("what condensation cannot solve accurately is solved by the factor of A, to its bits") {
  Lattice p = slender_lattice(Cell::cubic, 4);
  Rod rod = test::shaken(rod_of(p), 1, 1e-4);
  DirectFactor factor(rod);
  const VectorX soft = solved(factor, rod, test::assembled(rod, dt));
  for (Joint& joint : rod.joints) joint.compliance.head<3>() *= 1e-12;
  const LinearSystem rigid = test::assembled(rod, dt);
  CHECK(solved(factor, rod, rigid) == solved_whole(rod, rigid));
  CHECK(factor.has_whole());
  for (Joint& joint : rod.joints) joint.compliance.head<3>() *= 1e12;
  CHECK(difference(solved(factor, rod, test::assembled(rod, dt)), soft) < 1e-12);
  p.stretch = Stretch::inextensible;  // not condensed in the first place
  rod = test::shaken(rod_of(p), 1, 1e-4);
  DirectFactor other(rod);
  const LinearSystem system = test::assembled(rod, dt);
  CHECK(solved(other, rod, system) == solved_whole(rod, system));
}

TEST_CASE("systems that are not positive definite or not finite are called so") {
  Rod rod = rod_of(slender_lattice(Cell::octet, 3));
  DirectFactor factor(rod);
  REQUIRE(factor.condenses());
  VectorX x = VectorX::Zero(6 * rod.joint_count());
  for (const double mobility : {-1.0, -1e12}) {  // M is indefinite, and A
    Rod bad = rod;
    for (Segment& segment : bad.segments)
      if (!segment.is_static) segment.turn_mobility *= mobility;
    CHECK(factor.solve(bad, test::assembled(bad, dt), x) == SolveOutcome::indefinite);
  }
  Rod lost = rod;
  lost.position.back().x() = std::numeric_limits<double>::infinity();
  CHECK(factor.solve(lost, test::assembled(lost, dt), x) == SolveOutcome::not_a_number);
  CHECK(factor.solve(rod, test::assembled(rod, dt), x) == SolveOutcome::converged);
}

TEST_CASE("the same system gives the same bits, whatever was solved before; a system without load gives zero") {
  const Rod rod = test::shaken(rod_of(slender_lattice(Cell::body_centred, 3)), 1), other = test::shaken(rod, 2);
  const LinearSystem system = test::assembled(rod, dt);
  DirectFactor factor(rod), fresh(rod);
  const VectorX x = solved(factor, rod, system);
  CHECK(difference(solved(factor, other, test::assembled(other, dt)), x) > 1e-3);
  CHECK(solved(factor, rod, system) == x);
  CHECK(solved(fresh, rod, system) == x);
  const Rod still = rod_of(slender_lattice(Cell::body_centred, 3));
  CHECK(solved(factor, still, test::assembled(still, dt)).norm() < 1e-12 * x.norm());
}

}  // namespace rodsweep::test_direct_factor
