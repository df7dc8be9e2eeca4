// Trees: segment counts, radii, directions, joints; forests; refusals.
#include <cmath>
#include <map>

#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_trees {

constexpr double golden_angle_deg = 137.50776405003785;

TreeShape shape(int depth, int branches, int segments) {
  TreeShape p;
  p.depth = depth;
  p.branches = branches;
  p.segments = segments;
  return p;
}

Tree tree(int depth, int branches, int segments) {
  Tree p;
  p.shape = shape(depth, branches, segments);
  p.youngs_modulus_pa = 1e9;
  p.torsion_modulus_pa = 4e8;
  return p;
}

double second_moment(double radius) { return pi * std::pow(radius, 4) / 4; }

std::vector<std::vector<int>> children_of(const Skeleton& skeleton) {
  std::vector<std::vector<int>> children(skeleton.size());
  for (int i = 1; i < static_cast<int>(skeleton.size()); ++i) children[skeleton[i].parent].push_back(i);
  return children;
}

Vector3 edge(const Skeleton& skeleton, int node) {
  const SkeletonNode& at = skeleton[node];
  return at.position_m - skeleton[at.parent].position_m;
}

bool same_bits(const Skeleton& one, const Skeleton& other) {
  if (one.size() != other.size()) return false;
  for (std::size_t i = 0; i < one.size(); ++i)
    if (one[i].position_m != other[i].position_m || one[i].radius_m != other[i].radius_m) return false;
  return true;
}

TEST_CASE("a tree has segments (1 + b + ... + b^depth) edges, and a rod of it one segment more, the ground") {
  const std::map<std::vector<int>, int> counts{{{0, 3, 5}, 5}, {{3, 1, 2}, 8}, {{4, 3, 2}, 242}, {{6, 2, 8}, 1016}};
  for (const auto& [p, edges] : counts) {
    const Tree spec = tree(p[0], p[1], p[2]);
    CHECK(edge_count(spec.shape) == edges);
    CHECK(static_cast<int>(grow(spec.shape, 0.05).size()) == edges + 1);
    const Rod rod = build_scene(spec).rods.front();
    CHECK(rod.segment_count() == edges + 1);
    CHECK(rod.joint_count() == edges);
    CHECK(rod.segments[0].is_static);
    CHECK(rod.segments[0].length_m == 0);
  }
}

TEST_CASE("the pipe model holds at every branching, for any exponent and taper") {
  for (const double exponent : {2.0, 2.5, 3.0})
    for (const double taper : {1.0, 0.6}) {
      TreeShape p = shape(4, 3, 3);
      p.pipe_exponent = exponent;
      p.taper = taper;
      const Skeleton skeleton = grow(p, 0.1);
      const auto children = children_of(skeleton);
      int branchings = 0;
      for (std::size_t i = 1; i < skeleton.size(); ++i) {
        if (children[i].size() < 2) continue;
        double sum = 0;
        for (const int child : children[i]) sum += std::pow(skeleton[child].base_radius_m, exponent);
        CHECK(sum == Approx(std::pow(skeleton[i].radius_m, exponent)).epsilon(1e-12));
        ++branchings;
      }
      CHECK(branchings == 1 + 3 + 9 + 27);
      CHECK(skeleton[1].base_radius_m == 0.1);
      CHECK(skeleton[2].base_radius_m == skeleton[1].radius_m);
      CHECK(skeleton[3].radius_m == Approx(0.1 * taper).epsilon(1e-15));
    }
}

TEST_CASE("branches leave at the angle, are as long as they should be, and go around by the golden angle") {
  TreeShape p = shape(3, 3, 2);
  p.length_m = 2;
  p.length_ratio = 0.7;
  p.branching_angle_deg = 40;
  p.angle_spread_deg = 0;
  const Skeleton skeleton = grow(p, 0.1);
  const auto children = children_of(skeleton);
  CHECK((edge(skeleton, 1) - Vector3(0, 1, 0)).norm() < 1e-15);
  for (int i = 2; i < static_cast<int>(skeleton.size()); ++i) {
    const bool leaves = children[skeleton[i].parent].size() > 1;
    const Vector3 before = edge(skeleton, skeleton[i].parent), after = edge(skeleton, i);
    CHECK(after.norm() / before.norm() == Approx(leaves ? 0.7 : 1).epsilon(1e-12));
    CHECK(after.dot(before) / (after.norm() * before.norm()) ==
          Approx(std::cos(leaves ? 40 * pi / 180 : 0)).epsilon(1e-9));
  }
  const std::vector<int>& at_top = children[2];
  REQUIRE(at_top.size() == 3);
  for (std::size_t k = 1; k < 3; ++k) {
    const Vector3 one = edge(skeleton, at_top[k - 1]), next = edge(skeleton, at_top[k]);
    const double around =
        std::acos((one.x() * next.x() + one.z() * next.z()) / (one.x() * one.x() + one.z() * one.z()));
    CHECK(around * 180 / pi == Approx(golden_angle_deg).epsilon(1e-9));
  }
}

TEST_CASE("the same seed grows the same bits, another seed another tree") {
  for (const auto phyllotaxis : {TreeShape::Phyllotaxis::golden, TreeShape::Phyllotaxis::random}) {
    TreeShape p = shape(4, 3, 2), other = p;
    p.phyllotaxis = other.phyllotaxis = phyllotaxis;
    other.seed = 1;
    CHECK(same_bits(grow(p, 0.1), grow(p, 0.1)));
    CHECK_FALSE(same_bits(grow(p, 0.1), grow(other, 0.1)));
  }
}

TEST_CASE("a tree starts unstrained, and every part of its edges is in the joint that it belongs to") {
  Tree p = tree(3, 2, 3);
  p.shape.taper = 0.7;
  p.modulus_exponent = 0.5;
  const Rod rod = build_scene(p).rods.front();
  CHECK(test::constraint_of(rod).norm() < 1e-13);
  const Skeleton skeleton = grow(p.shape, p.radius_m);
  const auto children = children_of(skeleton);
  const auto integral = [&](int node, double from, double to) {  // of ds / EI, by the midpoint rule
    const SkeletonNode& end = skeleton[node];
    const int parts = 1000;
    double sum = 0;
    for (int i = 0; i < parts; ++i) {
      const double share = from + (i + 0.5) * (to - from) / parts;
      const double r = end.base_radius_m + share * (end.radius_m - end.base_radius_m);
      sum += (to - from) / parts * edge(skeleton, node).norm() / (1e9 * std::sqrt(r / p.radius_m) * second_moment(r));
    }
    return sum;
  };
  for (const Joint& joint : rod.joints) {
    double bending = integral(joint.b, 0, children[joint.b].size() > 1 ? 1 : 0.5);
    if (joint.a > 0 && children[joint.a].size() == 1) bending += integral(joint.a, 0.5, 1);
    CHECK(joint.compliance[3] == Approx(bending).epsilon(1e-6));
    CHECK(joint.compliance[4] == Approx(bending).epsilon(1e-6));
    CHECK(joint.compliance[5] == Approx(bending * 1e9 / (2 * 4e8)).epsilon(1e-6));
  }
}

TEST_CASE("an inextensible joint of a tree is made for the weight above it, a physical one for its two sections") {
  Tree p = tree(2, 3, 2);
  const Rod rod = build_scene(p).rods.front();
  double mass = 0;
  for (const Segment& s : rod.segments) mass += s.mass;
  const Joint &lowest = rod.joints.front(), &last = rod.joints.back();
  CHECK(lowest.compliance[0] == Approx(inextensible_compliance(lowest.length, 9.81 * mass)).epsilon(1e-12));
  CHECK(last.compliance[0] ==
        Approx(inextensible_compliance(last.length, 9.81 * rod.segments.back().mass)).epsilon(1e-12));
  p.stretch = Stretch::physical;
  p.shape.taper = 0.5;
  const Joint thinning = build_scene(p).rods.front().joints[1];
  // Two edges taper from .05 m to .025 m; the upper one carries a fork. Integral of ds / r^2 between radii: l / (r r').
  const double l = p.shape.length_m / 2;
  const double lower = l / 2 / (0.04375 * 0.0375), upper = l / (0.0375 * 0.025);
  CHECK(thinning.compliance[2] == Approx((lower + upper) / (1e9 * pi * l * l)).epsilon(1e-12));
}

TEST_CASE(
    "a forest is a tree for every place of the grid, each of its own seed, off its place by less than the jitter") {
  Forest p;
  p.shape = shape(2, 2, 2);
  p.rows = 2;
  p.columns = 3;
  p.spacing_m = 4;
  p.jitter = 0.3;
  const Scene scene = build_scene(p);
  REQUIRE(scene.rods.size() == 6);
  for (int i = 0; i < 6; ++i) {
    const Vector3 base = scene.rods[i].position[0], place(4 * (i % 3), 0, 4 * (i / 3));
    CHECK((base - place).cwiseAbs().maxCoeff() <= 0.3 * 4 / 2);
    CHECK(base.y() == 0);
    for (int j = 0; j < i; ++j) {
      const Rod &one = scene.rods[i], &other = scene.rods[j];
      CHECK((one.position.back() - one.position[0] - other.position.back() + other.position[0]).norm() > 1e-3);
    }
  }
}

TEST_CASE("trees that cannot grow are refused with quantity, value and bound") {
  Tree p = tree(2, 2, 2);
  p.shape.branching_angle_deg = 145;
  CHECK_THROWS_WITH(build_scene(p), "branching_angle_deg with angle_spread_deg is 155; must be at most 150");
  CHECK_THROWS_AS(build_scene(tree(30, 3, 2)), SceneError);
  CHECK_THROWS_WITH(build_scene(tree(30, 3, 2)), "number of segments of a tree is 6.17673e+14; must be at most 1e7");
  SkeletonTree measured;
  measured.trees =
      std::make_shared<const std::vector<Skeleton>>(1, Skeleton{{-1, {0, 0, 0}, 0.1}, {0, {0, 0, 0}, 0.1}});
  CHECK_THROWS_WITH(build_scene(measured), Catch::Matchers::StartsWith("node 1 of a skeleton: position "));
  measured.trees = std::make_shared<const std::vector<Skeleton>>(1, Skeleton{{-1, {0, 0, 0}, 0}, {0, {0, 1, 0}, 0.1}});
  CHECK_THROWS_WITH(build_scene(measured), "node 0 of a skeleton: radius is 0; must be positive");
}

}  // namespace rodsweep::test_trees
