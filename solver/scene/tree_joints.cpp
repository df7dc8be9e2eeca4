#include "solver/scene/tree_joints.hpp"

#include <algorithm>
#include <cmath>

namespace rodsweep {
namespace {

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

}  // namespace

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

    JointSpec& joint = joints.emplace_back();
    joint.a = static_cast<int>(below);
    joint.b = static_cast<int>(i);
    joint.arm_a_m = Vector3(0, 0, a.length_m / 2);
    joint.arm_b_m = Vector3(0, 0, -b.length_m / 2);
    joint.rest = rest;
    joint.frame = series.frame;
    set_compliance(joint, series, (a.length_m + b.length_m) / 2, carried[i], p);
  }
  return joints;
}

}  // namespace rodsweep
