// The multifrontal factorisation against Eigen's dense Cholesky; refusals.
#include <limits>
#include <numeric>

#include "solver/factor/block_factor.hpp"
#include "solver/factor/elimination_order.hpp"
#include "solver/linear/interruption.hpp"
#include "solver/linear/linear_system.hpp"
#include "tests/catch.hpp"
#include "tests/hand_clock.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_multifrontal_factor {

using test::Edges;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

MultifrontalFactor in_fronts(const BlockMatrix& a, const std::vector<int>& order) {
  return {a, AssemblyTree(elimination_tree(a, order))};
}

std::vector<int> in_order(int rows) {
  std::vector<int> order(rows);
  std::iota(order.rbegin(), order.rend(), 0);
  return order;
}

/// Couples all rows from `first` to `last` with each other.
void couple_all(int first, int last, Edges& couplings) {
  for (int i = first; i < last; ++i)
    for (int j = first; j < i; ++j) couplings.emplace_back(i, j);
}

/// Largest entry of x - A^-1 b over the largest entry of A^-1 b.
double error_of(MultifrontalFactor& factor, const BlockMatrix& a, unsigned seed) {
  const VectorX b = test::Random(seed).entries(a.unknowns());
  VectorX x = b;
  factor.substitute(x);
  const VectorX expected = test::dense_solve(a.dense(), b);
  return (x - expected).lpNorm<Eigen::Infinity>() / expected.lpNorm<Eigen::Infinity>();
}

/// Largest difference of eight right-hand sides at once from one after the other, over the largest solution.
template <class Factor>
double error_in_lanes(Factor& factor, int unknowns, unsigned seed) {
  std::vector<Lane8> x(static_cast<std::size_t>(unknowns));
  std::vector<VectorX> expected;
  for (unsigned lane = 0; lane < 8; ++lane) {
    expected.push_back(test::Random(seed + lane).entries(unknowns));
    if (lane % 2) expected.back().tail(unknowns / 2).setZero();
    for (int i = 0; i < unknowns; ++i) x[static_cast<std::size_t>(i)][lane] = expected.back()[i];
    factor.substitute(expected.back());
  }
  factor.substitute(x);
  double error = 0, scale = 0;
  for (unsigned lane = 0; lane < 8; ++lane)
    for (int i = 0; i < unknowns; ++i) {
      scale = std::max(scale, std::abs(expected[lane][i]));
      error = std::max(error, std::abs(x[static_cast<std::size_t>(i)][lane] - expected[lane][i]));
    }
  return error / scale;
}

TEST_CASE("fronts solve as a dense Cholesky does, whatever the graph and order, eight right-hand sides at once too") {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const int rows = 1 + static_cast<int>(seed);
    const BlockMatrix a = test::random_matrix(test::random_couplings(rows, 3 * rows / 2, seed), rows, seed);
    for (const std::vector<int>& order : {in_order(rows), minimum_degree_order(a)}) {
      MultifrontalFactor fronts = in_fronts(a, order);
      REQUIRE(fronts.factorise(a));
      for (const unsigned b : {1U, 2U}) REQUIRE(error_of(fronts, a, b) < 1e-12);
      CHECK(error_in_lanes(fronts, a.unknowns(), seed) < 1e-13);
    }
    BlockElimination blocks(a, in_order(rows));
    REQUIRE(blocks.factorise(a));
    CHECK(error_in_lanes(blocks, a.unknowns(), seed) < 1e-13);
  }
}

TEST_CASE("fronts wider than everything that is done at once solve as a dense Cholesky does") {
  Edges one, two;
  couple_all(0, 61, one);
  couple_all(0, 55, two);  // 35 rows remain for the other front
  couple_all(20, 75, two);
  for (const auto& [couplings, rows] : {std::pair{one, 61}, std::pair{two, 75}}) {
    const BlockMatrix a = test::random_matrix(couplings, rows, 1);
    MultifrontalFactor factor = in_fronts(a, in_order(rows));
    REQUIRE(factor.factorise(a));
    CHECK(error_of(factor, a, 2) < 1e-12);
    CHECK(error_in_lanes(factor, a.unknowns(), 3) < 1e-12);
  }
}

TEST_CASE("systems of lattices and nets are solved to rounding, with the same bits every time") {
  const Lattice cubic = test::lattice_of(Lattice::Cell::cubic, 3, 2), octet = test::lattice_of(Lattice::Cell::octet, 2);
  Net net;
  net.rows = net.columns = 6;
  for (const SceneSpec& spec : {SceneSpec(cubic), SceneSpec(octet), SceneSpec(net)}) {
    const Scene scene = build_scene(spec);
    const LinearSystem system = test::assembled(scene.rods.front());
    const BlockMatrix& a = system.matrix();
    std::vector<std::vector<int>> orders{minimum_degree_order(a), root_to_leaf_order(scene.rods.front())};
    if (std::vector<int> dissection = nested_dissection_order(a); !dissection.empty()) orders.push_back(dissection);
    for (const std::vector<int>& order : orders) {
      const VectorX b = test::Random(3).entries(a.unknowns());
      MultifrontalFactor factor = in_fronts(a, order), again = in_fronts(a, order);
      VectorX x = b, y = b, z = b;
      REQUIRE(factor.factorise(a));
      factor.substitute(x);
      CHECK(test::residual(a, b, x).norm() < 1e-8 * b.norm());
      REQUIRE(again.factorise(a));
      REQUIRE(again.factorise(a));
      again.substitute(y);
      again.substitute(z);
      CHECK(x == y);
      CHECK(y == z);
    }
  }
}

TEST_CASE("within a large front it is asked whether anybody waits, and an interrupted factor can be made again") {
  Edges all;
  couple_all(0, 150, all);
  const BlockMatrix a = test::random_matrix(all, 150, 3);
  MultifrontalFactor factor = in_fronts(a, in_order(150));
  int asked = 0;
  {
    test::HandClock::set_tick(std::chrono::seconds(1));
    const Interruptible interruptible([&] { return ++asked == 4; }, test::HandClock::ticking);
    CHECK_THROWS_AS(factor.factorise(a), InterruptedComputation);
  }
  CHECK(asked == 4);
  REQUIRE(factor.factorise(a));
  CHECK(error_of(factor, a, 1) < 1e-12);
}

TEST_CASE("what is not positive definite is refused, wherever its bad pivot is, and forgotten by the next matrix") {
  const BlockMatrix good = test::random_matrix(test::random_couplings(24, 60, 1), 24, 1);
  MultifrontalFactor factor = in_fronts(good, minimum_degree_order(good));
  for (int row = 0; row < good.block_rows(); ++row) {
    BlockMatrix bad = good;
    bad.blocks[bad.diagonal(row)].column[row % 6][row % 6] *= -1;
    CHECK(!factor.factorise(bad));
    bad.blocks[bad.diagonal(row)].column[row % 6][row % 6] = nan;
    CHECK(!factor.factorise(bad));
    CHECK(factor.factorise(good));
    CHECK(error_of(factor, good, 2) < 1e-12);
  }
  BlockMatrix zero = good;
  for (Block6& block : zero.blocks) block = {};
  CHECK(!factor.factorise(zero));
}

TEST_CASE("a factor with fronts keeps what a factor promises") {
  const Scene scene = build_scene(test::lattice_of(Lattice::Cell::cubic, 5));
  const LinearSystem system = test::assembled(scene.rods.front());
  const BlockMatrix& a = system.matrix();
  BlockFactor factor(a, root_to_leaf_order(scene.rods.front()));
  REQUIRE(factor.has_fronts());
  CHECK(factor.fill_in() > 0);
  const VectorX b = test::Random(3).entries(a.unknowns());
  VectorX x = VectorX::Zero(b.size());
  CHECK(factor.solve(a, b, x) == SolveOutcome::converged);
  CHECK(test::residual(a, b, x).norm() < 1e-10 * b.norm());
  VectorX kept = b;
  CHECK(factor.factorise(a));
  factor.substitute(kept);
  CHECK(kept == x);
  BlockMatrix bad = a;
  bad.blocks[bad.diagonal(7)].column[2][2] = -1;
  CHECK(factor.solve(bad, b, x) == SolveOutcome::indefinite);
  VectorX infinite = b;
  infinite[5] = std::numeric_limits<double>::infinity();
  CHECK(factor.solve(a, infinite, x) == SolveOutcome::not_a_number);
  CHECK(factor.solve(a, b, x) == SolveOutcome::converged);
  CHECK(kept == x);
}

}  // namespace rodsweep::test_multifrontal_factor
