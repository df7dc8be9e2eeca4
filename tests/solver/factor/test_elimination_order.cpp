// Orders of elimination and their fill; elimination trees against elimination of sets; the plan of a factorisation.
#include <set>

#include "solver/factor/block_factor.hpp"
#include "solver/factor/elimination_order.hpp"
#include "solver/linear/linear_system.hpp"
#include "tests/catch.hpp"
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

TEST_CASE("breadth first, neighbours are near each other: in a net 3 cells wide and 11 long at most two fronts apart") {
  const BlockMatrix pattern = pattern_of(test::net(3, 11));
  const std::vector<int> order = breadth_first_order(pattern);
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
  for (int row = 0; row < pattern.block_rows(); ++row)
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k)
      CHECK(std::abs(place[row] - place[pattern.column(k)]) < pattern.block_rows() / 3);
}

using test::later_neighbours, test::shuffled;

Lattice cubic(int nodes, int segments) { return test::lattice_of(Lattice::Cell::cubic, nodes, segments); }

BlockMatrix system_of(const SceneSpec& scene) { return LinearSystem(build_scene(scene).rods.front()).matrix(); }

TEST_CASE("parents and counts of an elimination tree are those of an elimination, whatever the graph and order") {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const int rows = 1 + static_cast<int>(seed);
    const BlockMatrix pattern = test::random_matrix(test::random_couplings(rows, 2 * rows, seed), rows, seed);
    const std::vector<int> order = shuffled(rows, seed + 1);
    const EliminationTree tree = elimination_tree(pattern, order);
    const std::vector<std::set<int>> later = later_neighbours(pattern, tree.row);
    REQUIRE(tree.columns() == rows);
    std::int64_t blocks = 0;
    for (int k = 0; k < rows; ++k) {
      REQUIRE(tree.count[k] == 1 + static_cast<int>(later[k].size()));
      REQUIRE(tree.parent[k] == (later[k].empty() ? -1 : *later[k].begin()));
      blocks += tree.count[k];
    }
    CHECK(tree.blocks() == blocks);
    blocks = rows;  // of the given order, however the tree is numbered
    for (const auto& column : later_neighbours(pattern, {order.rbegin(), order.rend()}))
      blocks += static_cast<std::int64_t>(column.size());
    CHECK(tree.blocks() == blocks);
  }
}

TEST_CASE(
    "rings and small nets are eliminated block by block, lattices in fronts, with less fill than minimum degree's") {
  const auto plan = [](const SceneSpec& spec) {
    const Scene scene = build_scene(spec);
    return plan_elimination(LinearSystem(scene.rods.front()).matrix(), root_to_leaf_order(scene.rods.front()));
  };
  CHECK(!plan(BendingRod{}).fronts);
  CHECK(plan(BendingRod{}).cost == 0);
  CHECK(!plan(Ring{}).fronts);
  CHECK(!plan(Net{}).fronts);
  const EliminationPlan lattice = plan(cubic(5, 3));
  REQUIRE(lattice.fronts);
  CHECK(lattice.bytes == lattice.fronts->bytes());
  const BlockMatrix pattern = system_of(cubic(5, 3));
  const double flops = elimination_tree(pattern, lattice.order).flops();
  const EliminationTree minimum_degree = elimination_tree(pattern, minimum_degree_order(pattern));
  if (nested_dissection_order(pattern).empty()) {  // built without METIS
    CHECK(flops == minimum_degree.flops());
    return;
  }
  CHECK(flops < 0.6 * minimum_degree.flops());
  CHECK(elimination_tree(pattern, nested_dissection_order(pattern)).flops() == flops);
}

TEST_CASE("a factor that would need too much memory is refused with its size, before it asks for any") {
  EliminationPlan plan{std::vector<int>(1000)};
  plan.bytes = most_factor_bytes;
  CHECK_NOTHROW(refuse_too_large(plan));
  plan.bytes = 1.5 * most_factor_bytes;
  CHECK_THROWS_AS(refuse_too_large(plan), FactorTooLarge);
  CHECK_THROWS_WITH(refuse_too_large(plan), Catch::Matchers::ContainsSubstring("1000 joints") &&
                                                Catch::Matchers::ContainsSubstring("6 GiB") &&
                                                Catch::Matchers::EndsWith(" 4 GiB"));
  EliminationTree dense;  // 14,000 rows, all coupled to each other
  for (int k = 0; k < 14000; ++k) {
    dense.row.push_back(k);
    dense.parent.push_back(k < 13999 ? k + 1 : -1);
    dense.count.push_back(14000 - k);
  }
  CHECK(AssemblyTree(dense).supernodes.size() == 1);
  CHECK(AssemblyTree(dense).bytes() > most_factor_bytes);
}

}  // namespace rodsweep::test_elimination_order
