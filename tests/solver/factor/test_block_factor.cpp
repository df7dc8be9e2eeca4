// The block elimination against Eigen's dense Cholesky; its order; refusals.
#include <limits>
#include <string>

#include "solver/factor/block_factor.hpp"
#include "solver/factor/elimination_order.hpp"
#include "solver/linear/linear_system.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_block_factor {

using test::Edges, test::Graph, test::MatrixX;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<Graph> trees() {
  return {
      {"two segments", test::chain(2), {}},
      {"free chain", test::chain(12), {}},
      {"chain held at both ends", test::chain(12), {0, 11}},
      {"chain held in the middle", test::chain(12), {5}},
      {"tree, depth 4, branching 3", test::tree(4, 3), {0}},
      {"tree, depth 2, branching 7", test::tree(2, 7), {}},
      {"tree held at a leaf and a branching", test::tree(3, 3), {2, 39}},
      {"two separate chains", {{0, 1}, {1, 2}, {3, 4}, {4, 5}}, {}},
      {"chain numbered at random", {{4, 1}, {0, 3}, {1, 3}, {2, 0}, {5, 4}}, {}},
  };
}

std::vector<Graph> loops() {
  return {
      {"ring", test::ring(9), {}},
      {"held ring", test::ring(9), {4}},
      {"net", test::net(4, 5), {0}},
      {"net held at its corners", test::net(7, 8), {0, 7, 48, 55}},
      {"ring held at two segments", test::ring(30), {4, 20}},
      {"two rings at one segment", {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {4, 5}, {5, 6}, {6, 0}}, {}},
  };
}

std::vector<Graph> all_graphs() {
  std::vector<Graph> all = trees();
  for (Graph& graph : loops()) all.push_back(graph);
  return all;
}

/// A random matrix with the pattern of a rod's system.
BlockMatrix matrix_like(const Rod& rod, unsigned seed) {
  const BlockMatrix pattern = LinearSystem(rod).matrix();
  Edges couplings;
  for (int row = 0; row < pattern.block_rows(); ++row)
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k) couplings.emplace_back(row, pattern.column(k));
  return test::random_matrix(couplings, rod.joint_count(), seed);
}

struct Solved {
  SolveOutcome outcome;
  VectorX x;
};

Solved solve(BlockFactor& factor, const BlockMatrix& a, const VectorX& b) {
  Solved out{SolveOutcome::not_run, VectorX::Zero(b.size())};
  out.outcome = factor.solve(a, b, out.x);
  return out;
}

TEST_CASE("systems of rods are solved to rounding") {
  for (const Graph& graph : all_graphs()) {
    INFO(graph.name);
    const Rod rod = test::random_rod(graph.edges, graph.held, 4);
    const LinearSystem system = test::assembled(rod);
    BlockFactor factor(system.matrix(), root_to_leaf_order(rod));
    const Solved solved = solve(factor, system.matrix(), system.rhs());
    CHECK(solved.outcome == SolveOutcome::converged);
    const MatrixX a = system.matrix().dense();
    // Nets are over-constrained with condition numbers near 1e6: the dense reference itself is accurate to about 1e-10.
    const double rounding = std::string(graph.name).rfind("net", 0) == 0 ? 1e-9 : 1e-10;
    CHECK((system.rhs() - a * solved.x).norm() < rounding * system.rhs().norm());
    CHECK(test::energy_error(a, solved.x, test::dense_solve(a, system.rhs())) < rounding);
  }
}

TEST_CASE("solutions equal those of a dense Cholesky, once and with a kept factor, whatever was solved before") {
  for (const Graph& graph : all_graphs()) {
    INFO(graph.name);
    const Rod rod = test::random_rod(graph.edges, graph.held, 1);
    const BlockMatrix a = matrix_like(rod, 2);
    BlockFactor factor(a, root_to_leaf_order(rod));
    solve(factor, matrix_like(rod, 5), test::Random(6).entries(a.unknowns()));
    for (const unsigned seed : {3U, 4U, 5U}) {
      const VectorX b = test::Random(seed).entries(a.unknowns());
      VectorX x = b;
      if (seed == 3) {
        CHECK(factor.solve(a, b, x) == SolveOutcome::converged);
        CHECK(factor.factorise(a));
      } else {
        factor.substitute(x);
      }
      CHECK((x - test::dense_solve(a.dense(), b)).lpNorm<Eigen::Infinity>() < 1e-13);
    }
  }
  BlockMatrix indefinite = matrix_like(test::random_rod(test::chain(4), {0}, 1), 2);
  indefinite.blocks[indefinite.diagonal(1)].column[2][2] = -1;
  CHECK(!BlockFactor(indefinite, {0, 1, 2}).factorise(indefinite));
}

TEST_CASE("nothing fills in on chains and trees, whatever is held; loops fill in") {
  const auto fill_in = [](const Graph& graph) {
    const Rod rod = test::random_rod(graph.edges, graph.held, 1);
    return BlockFactor(LinearSystem(rod).matrix(), root_to_leaf_order(rod)).fill_in();
  };
  for (const Graph& graph : trees()) {
    INFO(graph.name);
    CHECK(fill_in(graph) == 0);
  }
  CHECK(fill_in(loops()[0]) > 0);
  CHECK(fill_in(loops()[2]) > 0);
}

TEST_CASE("an order that fills in gives way to a better one") {
  const Rod rod = test::random_rod(test::chain(9), {0}, 1);
  const BlockMatrix a = matrix_like(rod, 2);
  const VectorX b = test::Random(3).entries(a.unknowns());
  const std::vector<int> bad = {0, 4, 2, 6, 1, 3, 5, 7};
  REQUIRE(fills_in(a, bad));
  BlockFactor factor(a, bad);
  CHECK(factor.fill_in() == 0);
  CHECK((solve(factor, a, b).x - test::dense_solve(a.dense(), b)).lpNorm<Eigen::Infinity>() < 1e-13);
}

TEST_CASE("a matrix that is not positive definite is called indefinite, wherever its bad pivot is") {
  for (const Graph& graph : {trees()[1], trees()[6], loops()[0]}) {
    const Rod rod = test::random_rod(graph.edges, graph.held, 1);
    const BlockMatrix good = matrix_like(rod, 2);
    const VectorX b = test::Random(3).entries(good.unknowns());
    BlockFactor factor(good, root_to_leaf_order(rod));
    for (int row = 0; row < good.block_rows(); ++row)
      for (const double factor_of_block : {-1.0, 0.0}) {
        INFO(graph.name << ", block " << row << " times " << factor_of_block);
        BlockMatrix bad = good;
        for (Lane8& column : bad.blocks[bad.diagonal(row)].column) column *= broadcast(factor_of_block);
        CHECK(solve(factor, bad, b).outcome == SolveOutcome::indefinite);
      }
    BlockMatrix one_pivot = good;
    one_pivot.blocks[one_pivot.diagonal(1)].column[5][5] *= -1;
    CHECK(solve(factor, one_pivot, b).outcome == SolveOutcome::indefinite);
  }
}

TEST_CASE("a NaN anywhere in the matrix is never converged, one in b is called what it is") {
  const Rod rod = test::random_rod(test::tree(2, 2), {0}, 1);
  const BlockMatrix good = matrix_like(rod, 2);
  const VectorX b = test::Random(3).entries(good.unknowns());
  BlockFactor factor(good, root_to_leaf_order(rod));
  for (int row = 0; row < good.block_rows(); ++row)
    for (int k = good.row_begin(row); k < good.row_end(row); ++k) {
      BlockMatrix bad = good;
      bad.blocks[k].column[3][4] = bad.blocks[bad.find(good.column(k), row)].column[4][3] = nan;
      const SolveOutcome outcome = solve(factor, bad, b).outcome;
      INFO("block " << row << ", " << good.column(k) << ": " << to_string(outcome));
      CHECK((outcome == SolveOutcome::indefinite || outcome == SolveOutcome::not_a_number));
    }
  for (const double value : {nan, infinity})
    for (int row = 0; row < good.unknowns(); ++row) {
      VectorX bad = b;
      bad[row] = value;
      CHECK(solve(factor, good, bad).outcome == SolveOutcome::not_a_number);
    }
}

}  // namespace rodsweep::test_block_factor
