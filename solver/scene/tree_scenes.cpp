// Trees, and their joints: where the stiffness of edges is.
//
// An edge is a cone of two halves, from its lower node to its middle and on to its upper node (softness.hpp). Each joint has
// the halves that meet at it, in series:
//   a node with one edge above   the upper half of the edge below, the lower half of the edge above
//   a fork                       the lower half of its branch. The moments of all branches bend the upper half of the
//                                edge below, so that half belongs to the joint at that edge's lower end: a shift of
//                                compliance by less than an edge, an error of second order in edge lengths
//   the ground                   the lower half of its edge
// So a joint's stiffness does not depend on the other branches of its node, nor on the order of nodes.
#include <algorithm>
#include <cmath>
#include <string>

#include "solver/numbers/counter_random.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"
#include "solver/scene/tree_skeleton.hpp"

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

/// Moduli that grow with the radius, from those of the widest edge at the ground.
class Wood {
 public:
  Wood(const Skeleton& skeleton, const RodParameters& p, double modulus_exponent)
      : parameters_(p), exponent_(modulus_exponent) {
    for (const SkeletonNode& node : skeleton)
      if (node.parent == 0) trunk_radius_m_ = std::max(trunk_radius_m_, node.base_radius_m);
  }
  Section section(double radius_m) const {
    const double factor = exponent_ == 0 ? 1 : std::pow(radius_m / trunk_radius_m_, exponent_);
    return circular_section(radius_m, factor * parameters_.youngs_modulus_pa, factor * parameters_.torsion_modulus_pa);
  }

 private:
  const RodParameters& parameters_;
  double exponent_, trunk_radius_m_ = 0;
};

/// The joints of a skeleton's edges; joint i - 1 is at the lower end of edge i, between segments parent(i) and i.
/// `segments`: of the edges, 0 the ground. Moduli grow with the radius as stated in scenes.hpp.
std::vector<JointSpec> tree_joints(const Skeleton& skeleton, const std::vector<SegmentSpec>& segments,
                                   const RodParameters& p, double modulus_exponent) {
  const Wood wood(skeleton, p, modulus_exponent);
  std::vector<int> branches(skeleton.size());
  for (std::size_t i = 1; i < skeleton.size(); ++i) ++branches[at(skeleton[i].parent)];
  std::vector<double> carried(segments.size());  // [N], by the joint below each segment
  for (std::size_t i = segments.size() - 1; i > 0; --i) {
    carried[i] += weight({segments[i]}, p);
    carried[at(skeleton[i].parent)] += carried[i];
  }
  const auto half = [&](std::size_t i, bool upper) {
    const SkeletonNode& node = skeleton[i];
    const double middle = (node.base_radius_m + node.radius_m) / 2;
    return cone(middle, upper ? node.radius_m : node.base_radius_m, segments[i].length_m / 2,
                [&wood](double radius) { return wood.section(radius); });
  };
  std::vector<JointSpec> joints;
  joints.reserve(segments.size() - 1);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const std::size_t below = at(skeleton[i].parent);
    const SegmentSpec &a = segments[below], &b = segments[i];
    const Softness of_a = below > 0 && branches[below] == 1 ? half(below, true) : Softness();
    const Softness of_b = branches[i] > 1 ? half(i, false) + half(i, true) : half(i, false);
    const Quaternion rest = (a.orientation.conjugate() * b.orientation).normalized();
    const Series series = in_series(of_a, of_b, rest);

    JointSpec joint{static_cast<int>(below), static_cast<int>(i), {0, 0, a.length_m / 2}, {0, 0, -b.length_m / 2}};
    joint.rest = rest;
    joint.frame = series.frame;
    set_compliance(joint, series, (a.length_m + b.length_m) / 2, carried[i], p);
    joints.push_back(joint);
  }
  return joints;
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
