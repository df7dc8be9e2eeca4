// Orders of elimination: their fill, and the low fill of minimum degree.
#include <catch2/catch.hpp>

#include "solver/factor/block_factor.hpp"
#include "solver/factor/elimination_order.hpp"
#include "solver/linear/linear_system.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_elimination_order {

using test::Edges;

/// The pattern of a rod with these segments.
BlockMatrix pattern_of(const Edges& edges, const std::vector<int>& held = {}) {
  return LinearSystem(test::random_rod(edges, held, 1)).matrix();
}

/// Number of pairs of rows that elimination from the last row to the first newly couples.
int fill_of(const BlockMatrix& pattern, const std::vector<int>& order) {
  int coupled = 0;
  for (const auto& column : test::later_neighbours(pattern, {order.rbegin(), order.rend()}))
    coupled += static_cast<int>(column.size());
  return coupled - (pattern.block_count() - pattern.block_rows()) / 2;
}

TEST_CASE("whether an order fills in is told as an elimination finds it") {
  const Edges graphs[] = {test::chain(9), test::tree(3, 2), test::ring(7), test::net(3, 4)};
  int without = 0, with = 0;
  for (const Edges& edges : graphs) {
    const BlockMatrix pattern = pattern_of(edges);
    std::vector<std::vector<int>> orders{root_to_leaf_order(test::random_rod(edges, {}, 1)),
                                         minimum_degree_order(pattern)};
    for (unsigned seed = 0; seed < 20; ++seed) orders.push_back(test::shuffled(pattern.block_rows(), seed));
    for (const std::vector<int>& order : orders) {
      const bool fills = fill_of(pattern, order) > 0;
      CHECK(fills_in(pattern, order) == fills);
      ++(fills ? with : without);
    }
  }
  CHECK(without >= 3);
  CHECK(with >= 40);
}

TEST_CASE("minimum degree names every row once, and a chain's so that nothing fills in") {
  for (const Edges& edges : {test::chain(2), test::chain(40), test::tree(3, 2), test::net(5, 6)}) {
    const BlockMatrix pattern = pattern_of(edges, {0});
    const std::vector<int> order = minimum_degree_order(pattern);
    if (edges == test::chain(40)) CHECK(fill_of(pattern, order) == 0);
    CHECK(test::names_each_once(order, pattern.block_rows()));
  }
}

TEST_CASE("a ring of n joints fills in n - 3 blocks, the fewest that a cycle can") {
  for (const int n : {3, 4, 9, 50}) {
    const BlockMatrix pattern = pattern_of(test::ring(n));
    CHECK(BlockFactor(pattern, minimum_degree_order(pattern)).fill_in() == n - 3);
    // A ring with a held segment is a chain: a held segment couples nothing.
    CHECK(BlockFactor(pattern_of(test::ring(n), {1}), minimum_degree_order(pattern)).fill_in() == 0);
  }
}

TEST_CASE("the factor counts the fill of the order that it takes, and that of a net is far below breadth-first's") {
  const Rod rod = test::random_rod(test::net(20, 20), {0}, 1);
  const BlockMatrix pattern = LinearSystem(rod).matrix();
  const int breadth_first = fill_of(pattern, root_to_leaf_order(rod));
  const BlockFactor factor(pattern, root_to_leaf_order(rod));
  CHECK(factor.fill_in() == fill_of(pattern, minimum_degree_order(pattern)));
  CHECK(factor.fill_in() < 0.4 * breadth_first);
}

TEST_CASE("breadth first: every row once, neighbours near each other, from an end of what has ends; no fill there") {
  for (const Edges& edges : {test::chain(9), test::tree(3, 2), test::ring(8), test::net(4, 6)}) {
    const BlockMatrix pattern = pattern_of(edges, {0});
    const std::vector<int> order = breadth_first_order(pattern);
    CHECK(test::names_each_once(order, pattern.block_rows()));
    CHECK(breadth_first_order(pattern) == order);
  }
  for (const Edges& edges : {test::chain(9), test::tree(3, 2)}) {
    const BlockMatrix pattern = pattern_of(edges);
    CHECK_FALSE(fills_in(pattern, breadth_first_order(pattern)));
  }
  // A net 3 cells wide and 11 long: neighbours are at most two fronts apart in the order.
  const BlockMatrix pattern = pattern_of(test::net(3, 11));
  const std::vector<int> order = breadth_first_order(pattern);
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
  for (int row = 0; row < pattern.block_rows(); ++row)
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k)
      CHECK(std::abs(place[row] - place[pattern.column(k)]) < pattern.block_rows() / 3);
}

}  // namespace rodsweep::test_elimination_order
