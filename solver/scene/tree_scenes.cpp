#include <algorithm>
#include <cmath>
#include <string>

#include "solver/numbers/rotation.hpp"
#include "solver/numbers/split_mix.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// Moduli that grow with the edge's radius as stated in scenes.hpp, from those of the widest edge at the ground.
class Wood {
 public:
  Wood(const Skeleton& skeleton, const RodParameters& p, double modulus_exponent)
      : parameters_(p), exponent_(modulus_exponent) {
    for (const SkeletonNode& node : skeleton)
      if (node.parent == 0) trunk_radius_m_ = std::max(trunk_radius_m_, node.radius_m);
  }
  Section section(double radius_m) const {
    const double factor = exponent_ == 0 ? 1 : std::pow(radius_m / trunk_radius_m_, exponent_);
    return circular_section(radius_m, factor * parameters_.youngs_modulus_pa, factor * parameters_.torsion_modulus_pa);
  }

 private:
  const RodParameters& parameters_;
  double exponent_, trunk_radius_m_ = 0;
};

/// Half of a and half of b in series. A wall has no length.
JointSpec series_joint(const SegmentSpec& a, const SegmentSpec& b, const Wood& wood, const RodParameters& p,
                       double force_n) {
  const double half_a = a.length_m / 2, half_b = b.length_m / 2, length = half_a + half_b;
  const Section of_b = wood.section(b.radius_m), of_a = half_a > 0 ? wood.section(a.radius_m) : of_b;
  const auto in_series = [&](double Section::*stiffness) {
    return half_a / of_a.*stiffness + half_b / of_b.*stiffness;
  };
  JointSpec joint;
  joint.arm_a_m = Vector3(0, 0, half_a);
  joint.arm_b_m = Vector3(0, 0, -half_b);
  double across = p.stretch_compliance_per_j.value_or(inextensible_compliance(length, force_n)), along = across;
  if (p.stretch == Stretch::physical) {
    across = in_series(&Section::shear_n) / (length * length);
    along = in_series(&Section::axial_n) / (length * length);
  }
  joint.compliance_per_j << across, across, along, in_series(&Section::bending_x_nm2),
      in_series(&Section::bending_y_nm2), in_series(&Section::torsion_nm2);
  return joint;
}

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
    segments[i].radius_m = node.radius_m;
    if (first) segments[0].orientation = segments[1].orientation;
  }
  return segments;
}

Rod rod_of(const Skeleton& skeleton, const RodParameters& p, double modulus_exponent, const Vector3& base) {
  const std::vector<SegmentSpec> segments = segments_along(skeleton, p, base);
  const Wood wood(skeleton, p, modulus_exponent);
  std::vector<double> carried(segments.size());  // [N], by the joint below each segment
  for (std::size_t i = segments.size() - 1; i > 0; --i) {
    carried[i] += weight({segments[i]}, p);
    carried[at(skeleton[i].parent)] += carried[i];
  }
  std::vector<JointSpec> joints;
  joints.reserve(segments.size() - 1);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    joints.push_back(series_joint(segments[at(skeleton[i].parent)], segments[i], wood, p, carried[i]));
    joints.back().a = skeleton[i].parent;
    joints.back().b = static_cast<int>(i);
  }
  return Rod(segments, joints);
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
  if (!skeleton || skeleton->size() < 2) throw SceneError("a skeleton needs at least two nodes");
  if (const auto wrong = fault(*skeleton))
    throw SceneError("node " + std::to_string(wrong->node) + " of a skeleton: " + wrong->text);
}

SceneSize SkeletonTree::size() const {
  const int nodes = static_cast<int>(skeleton->size());
  return {nodes, nodes - 1};
}

void SkeletonTree::build(Scene& scene) const {
  scene.rods.push_back(rod_of(placed(*skeleton, unit_m, up), *this, modulus_exponent, Vector3::Zero()));
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
