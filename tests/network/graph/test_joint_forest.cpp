// Rods as graphs and joints as a forest: parents, depths, cut loops; single and side by side.
#include <algorithm>

#include "network/graph/joint_forest.hpp"
#include "network/graph/rod_graph.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_joint_forest {

TEST_CASE("a chain hangs from its held end; held in the middle it is two trees, since nothing couples through that") {
  const auto forest = [](const std::vector<int>& held) {
    return joint_forest(test::random_rod(test::chain(5), held, 1));
  };
  CHECK(forest({0}).order == std::vector<int>{0, 1, 2, 3});
  CHECK(forest({0}).level_begin == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(forest({4}).order == std::vector<int>{3, 2, 1, 0});
  for (const std::vector<int>& held : {std::vector<int>{0}, std::vector<int>{4}, std::vector<int>{0, 4}})
    CHECK(forest(held).parent == std::vector<int>{-1, 0, 1, 2});
  CHECK(forest({2}).levels() == 2);
  CHECK(forest({2}).order == std::vector<int>{1, 2, 0, 3});
  CHECK(forest({2}).parent == std::vector<int>{-1, -1, 0, 1});
}

TEST_CASE("siblings share a parent, and a free tree hangs from its first joint") {
  const JointForest held = joint_forest(test::random_rod(test::tree(2, 2), {0}, 1));
  CHECK(held.level_begin == std::vector<int>{0, 2, 6});
  CHECK(held.parent == std::vector<int>{-1, -1, 0, 0, 1, 1});
  const JointForest free = joint_forest(test::random_rod(test::tree(2, 2), {}, 1));
  CHECK(free.order == std::vector<int>{0, 1, 2, 3, 4, 5});
  CHECK(free.parent == std::vector<int>{-1, 0, 0, 0, 1, 1});
}

TEST_CASE("a ring is cut across from its first joint") {
  const JointForest free = joint_forest(test::random_rod(test::ring(6), {}, 1));
  CHECK(free.order == std::vector<int>{0, 1, 5, 2, 4, 3});
  CHECK(free.parent == std::vector<int>{-1, 0, 0, 1, 2, 4});
  CHECK(joint_forest(test::random_rod(test::ring(6), {0}, 1)).parent == std::vector<int>{-1, 0, 1, 2, 3, 4});
}

TEST_CASE("what stands beside a joint are its siblings and the joint across a cut") {
  CHECK(joint_forest(test::random_rod(test::chain(5), {0}, 1)).beside == std::vector<int>{0, 0, 0, 0});
  CHECK(joint_forest(test::random_rod(test::tree(2, 2), {0}, 1)).beside == std::vector<int>{0, 0, 1, 1, 1, 1});
  const JointForest ring = joint_forest(test::random_rod(test::ring(6), {}, 1));
  CHECK(ring.beside == std::vector<int>{0, 0, 0, 1, 0, 1});
  CHECK(side_by_side(std::vector<const JointForest*>{&ring}).beside == ring.beside);
  CHECK(ring.cut);
  CHECK(side_by_side(std::vector<const JointForest*>{&ring}).cut);
  CHECK_FALSE(joint_forest(test::random_rod(test::ring(6), {0}, 1)).cut);
}

TEST_CASE("however many loops, every joint has one place, below a joint that shares a segment with it") {
  const test::Edges edges = test::net(4, 3);
  const JointForest forest = joint_forest(test::random_rod(edges, {0}, 1));
  std::vector<int> joints = forest.order;
  std::sort(joints.begin(), joints.end());
  for (std::size_t i = 0; i < edges.size(); ++i) CHECK(joints[i] == static_cast<int>(i));
  REQUIRE(joints.size() == edges.size());
  int roots = 0;
  for (int i = 0; i < forest.size(); ++i) {
    const int up = forest.parent[i];
    roots += up < 0;
    if (up < 0) continue;
    CHECK(up < i);
    const auto [a, b] = edges[forest.order[i]];
    const auto [c, d] = edges[forest.order[up]];
    CHECK((a == c || a == d || b == c || b == d));
  }
  CHECK(roots == 1);  // one joint at the held corner; paths around the loops reach the other
}

TEST_CASE("side by side, forests keep their parents and share levels") {
  const JointForest tree = joint_forest(test::random_rod(test::tree(2, 2), {0}, 1));
  const JointForest chain = joint_forest(test::random_rod(test::chain(4), {0}, 2));
  const JointForest both = side_by_side(std::vector<const JointForest*>{&chain, &tree});
  CHECK(both.size() == 9);
  CHECK(both.level_begin == std::vector<int>{0, 3, 8, 9});
  for (int i = 0; i < both.size(); ++i) {
    const int joint = both.order[i], up = both.parent[i];
    const JointForest& own = joint < 3 ? chain : tree;
    const int first = joint < 3 ? 0 : 3, expected = own.parent[joint - first];
    CHECK((up < 0 ? -1 : both.order[up]) == (expected < 0 ? -1 : expected + first));
  }
}

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

}  // namespace rodsweep::test_joint_forest
