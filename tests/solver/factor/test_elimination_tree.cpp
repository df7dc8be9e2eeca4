// Elimination trees against elimination of sets: parents, counts, costs, and the plan of a factorisation.
#include <catch2/catch.hpp>
#include <set>

#include "solver/factor/block_factor.hpp"
#include "solver/factor/elimination_order.hpp"
#include "solver/linear/linear_system.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_elimination_tree {

using test::later_neighbours, test::shuffled;

Lattice cubic(int nodes, int segments) { return test::lattice_of(Lattice::Cell::cubic, nodes, segments); }

BlockMatrix system_of(const SceneSpec& scene) { return LinearSystem(build_scene(scene).rods.front()).matrix(); }

TEST_CASE("parents and counts of an elimination tree are those of an elimination, whatever the graph and order") {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const int rows = 1 + static_cast<int>(seed);
    const BlockMatrix pattern = test::random_matrix(test::random_couplings(rows, 2 * rows, seed), rows, seed);
    const EliminationTree tree = elimination_tree(pattern, shuffled(rows, seed + 1));
    const std::vector<std::set<int>> later = later_neighbours(pattern, tree.row);
    REQUIRE(tree.columns() == rows);
    std::int64_t blocks = 0;
    for (int k = 0; k < rows; ++k) {
      REQUIRE(tree.count[k] == 1 + static_cast<int>(later[k].size()));
      REQUIRE(tree.parent[k] == (later[k].empty() ? -1 : *later[k].begin()));
      blocks += tree.count[k];
    }
    CHECK(tree.blocks() == blocks);
  }
}

TEST_CASE("an elimination tree costs what the given order does, however it is numbered") {
  const BlockMatrix pattern = LinearSystem(test::random_rod(test::net(6, 7), {0}, 1)).matrix();
  for (unsigned seed = 0; seed < 5; ++seed) {
    const std::vector<int> order = shuffled(pattern.block_rows(), seed);
    const EliminationTree tree = elimination_tree(pattern, order);
    std::int64_t blocks = pattern.block_rows();
    for (const auto& column : later_neighbours(pattern, {order.rbegin(), order.rend()}))
      blocks += static_cast<std::int64_t>(column.size());
    CHECK(tree.blocks() == blocks);
  }
}

TEST_CASE("supernodes hold every column once, in few of them, and hardly more blocks than L has") {
  for (const BlockMatrix& pattern : {system_of(cubic(4, 2)), system_of(Net{})}) {
    const EliminationTree tree = elimination_tree(pattern, minimum_degree_order(pattern));
    AssemblyTree fronts(tree);
    fronts.find_rows(pattern);
    REQUIRE(test::names_each_once(fronts.row, pattern.block_rows()));
    CHECK(fronts.blocks >= tree.blocks());
    CHECK(static_cast<double>(fronts.blocks) < 1.5 * static_cast<double>(tree.blocks()));
    CHECK(fronts.supernodes.size() < fronts.row.size() / 2);
  }
}

TEST_CASE(
    "rings and small nets are eliminated block by block, lattices in fronts, with less fill than minimum degree's") {
  const auto plan = [](const SceneSpec& spec) {
    const Scene scene = build_scene(spec);
    return plan_elimination(LinearSystem(scene.rods.front()).matrix(), root_to_leaf_order(scene.rods.front()));
  };
  CHECK(!plan(BendingRod{}).fronts);
  CHECK(plan(BendingRod{}).flops == 0);
  CHECK(!plan(Ring{}).fronts);
  CHECK(!plan(Net{}).fronts);
  const EliminationPlan lattice = plan(cubic(5, 3));
  REQUIRE(lattice.fronts);
  CHECK(lattice.bytes == lattice.fronts->bytes());
  const BlockMatrix pattern = system_of(cubic(5, 3));
  const EliminationTree minimum_degree = elimination_tree(pattern, minimum_degree_order(pattern));
  if (nested_dissection_order(pattern).empty()) {  // built without METIS
    CHECK(lattice.flops == minimum_degree.flops());
    return;
  }
  CHECK(lattice.flops < 0.6 * minimum_degree.flops());
  CHECK(elimination_tree(pattern, nested_dissection_order(pattern)).flops() == lattice.flops);
}

TEST_CASE("nested dissection names every row once and the same way every time") {
  const BlockMatrix pattern = system_of(cubic(4, 3));
  const std::vector<int> order = nested_dissection_order(pattern);
  if (order.empty()) return;  // built without METIS
  CHECK(nested_dissection_order(pattern) == order);
  CHECK(test::names_each_once(order, pattern.block_rows()));
  CHECK(nested_dissection_order(test::random_matrix({}, 3, 1)).empty());  // nothing to divide
}

TEST_CASE("a factor that would need too much memory is refused with its size, before it asks for any") {
  EliminationPlan plan{std::vector<int>(1000)};
  plan.bytes = most_factor_bytes;
  CHECK_NOTHROW(refuse_too_large(plan));
  plan.bytes = 1.5 * most_factor_bytes;
  CHECK_THROWS_AS(refuse_too_large(plan), FactorTooLarge);
  CHECK_THROWS_WITH(refuse_too_large(plan),
                    Catch::Contains("1000 joints") && Catch::Contains("6 GiB") && Catch::EndsWith(" 4 GiB"));
  EliminationTree dense;  // 14,000 rows, all coupled to each other
  for (int k = 0; k < 14000; ++k) {
    dense.row.push_back(k);
    dense.parent.push_back(k < 13999 ? k + 1 : -1);
    dense.count.push_back(14000 - k);
  }
  CHECK(AssemblyTree(dense).supernodes.size() == 1);
  CHECK(AssemblyTree(dense).bytes() > most_factor_bytes);
}

}  // namespace rodsweep::test_elimination_tree
