#include <algorithm>
#include <cmath>
#include <string>

#include "solver/numbers/counter_random.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/scene/tree_joints.hpp"

namespace rodsweep {
namespace {

/// Segment i is the edge to node i, segment 0 the ground.
std::vector<SegmentSpec> segments_along(const Skeleton& skeleton, const RodParameters& p, const Vector3& base) {
  std::vector<SegmentSpec> segments(skeleton.size());
  segments[0].position_m = base + skeleton[0].position_m;
  segments[0].is_static = true;
  for (std::size_t i = 1; i < skeleton.size(); ++i) {
    const SkeletonNode &node = skeleton[i], &parent = skeleton[at(node.parent)];
    const Vector3 edge = node.position_m - parent.position_m;
    const SegmentSpec& below = segments[at(node.parent)];
    const bool first = i == 1;  // of all edges: it gives the ground its frame
    const Vector3 before = (first ? Quaternion::Identity() : below.orientation) * Vector3::UnitZ();
    Quaternion orientation = turn_between(before, edge);
    if (!first) orientation = orientation * below.orientation;
    segments[i] = segment_at(base + parent.position_m + edge / 2, orientation.normalized(), edge.norm(), p);
    segments[i].radius_m = mean_radius(node.base_radius_m, node.radius_m);
    if (first) segments[0].orientation = segments[1].orientation;
  }
  return segments;
}

Rod rod_of(const Skeleton& skeleton, const RodParameters& p, double modulus_exponent, const Vector3& base) {
  const std::vector<SegmentSpec> segments = segments_along(skeleton, p, base);
  return Rod(segments, tree_joints(skeleton, segments, p, modulus_exponent));
}

}  // namespace

void Tree::check() const { validate(shape); }

SceneSize Tree::size() const {
  const int edges = edge_count(shape);
  return {edges + 1, edges};  // with the ground
}

void Tree::build(Scene& scene) const {
  scene.rods.push_back(rod_of(grow(shape, radius_m), *this, modulus_exponent, Vector3::Zero()));
}

void SkeletonTree::check() const {
  if (!trees || trees->empty()) throw SceneError("a skeleton needs a tree");
  for (const Skeleton& tree : *trees) {
    if (tree.size() < 2) throw SceneError("a skeleton needs at least two nodes");
    if (const auto wrong = fault(tree))
      throw SceneError("node " + std::to_string(wrong->node) + " of a skeleton: " + wrong->text);
  }
}

SceneSize SkeletonTree::size() const {
  int nodes = 0;
  for (const Skeleton& tree : *trees) nodes += static_cast<int>(tree.size());
  const int count = static_cast<int>(trees->size());
  return {nodes, nodes - count, count, "the roots of the skeleton"};
}

void SkeletonTree::build(Scene& scene) const {
  const Vector3 origin = trees->front().front().position_m;
  for (const Skeleton& tree : *trees)
    scene.rods.push_back(
        rod_of(with_base_radii(placed(tree, origin, unit_m, up)), *this, modulus_exponent, Vector3::Zero()));
}

void Forest::check() const {
  Tree::check();
  check_least("rows", rows, 1);
  check_least("columns", columns, 1);
  check_segments("a forest", static_cast<double>(edge_count(shape)) * rows * columns);
}

SceneSize Forest::size() const {
  const SceneSize tree = Tree::size();
  const int trees = rows * columns;
  return {trees * tree.segments, trees * tree.joints, trees, "rows x columns"};
}

void Forest::build(Scene& scene) const {
  SplitMix random(shape.seed);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      TreeShape own = shape;
      own.seed = split_mix(shape.seed ^ split_mix(at(row * columns + column)));
      const double x = random.uniform() - 0.5, z = random.uniform() - 0.5;
      const Vector3 base = spacing_m * Vector3(column + jitter * x, 0, row + jitter * z);
      scene.rods.push_back(rod_of(grow(own, radius_m), *this, modulus_exponent, base));
    }
}

}  // namespace rodsweep
