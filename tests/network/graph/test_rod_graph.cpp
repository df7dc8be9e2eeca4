// Rods as graphs, single and side by side.
#include <catch2/catch.hpp>

#include "network/graph/rod_graph.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_rod_graph {

TEST_CASE("an edge goes from a joint's segment a to its segment b, loops included") {
  const RodGraph graph = rod_graph(test::random_rod(test::ring(3), {0}, 1));
  CHECK(graph.nodes == 3);
  CHECK(graph.sender == std::vector<int>{0, 1, 2});
  CHECK(graph.receiver == std::vector<int>{1, 2, 0});
  CHECK(graph.rods() == 1);
  CHECK(graph.first_node == std::vector<int>{0, 3});
  CHECK(graph.first_edge == std::vector<int>{0, 3});
}

TEST_CASE("side by side, numbers go on and every rod knows its own") {
  const RodGraph chain = rod_graph(test::random_rod(test::chain(3), {0}, 1));
  const RodGraph point = rod_graph(test::random_rod(test::chain(1), {0}, 1));
  const RodGraph ring = rod_graph(test::random_rod(test::ring(3), {0}, 1));
  const RodGraph two = side_by_side(std::vector<const RodGraph*>{&chain, &point}),
                 three = side_by_side(std::vector<const RodGraph*>{&two, &ring});
  CHECK(three.nodes == 7);
  CHECK(three.sender == std::vector<int>{0, 1, 4, 5, 6});
  CHECK(three.receiver == std::vector<int>{1, 2, 5, 6, 4});
  CHECK(three.rods() == 3);
  CHECK(three.first_node == std::vector<int>{0, 3, 4, 7});
  CHECK(three.first_edge == std::vector<int>{0, 2, 2, 5});
}

}  // namespace rodsweep::test_rod_graph
