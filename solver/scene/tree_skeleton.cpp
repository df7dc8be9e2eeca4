#include "solver/scene/tree_skeleton.hpp"

#include <cmath>
#include <sstream>

#include "solver/numbers/counter_random.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {
namespace {

constexpr double degree = pi / 180;
constexpr double golden_angle = pi * (3 - 2.23606797749978969641);
constexpr double most_edges = 1e7;

double edges_of(const TreeShape& p) {
  double at_depth = 1, branches = 1;
  for (int level = 0; level < p.depth; ++level) branches += at_depth *= p.branches;
  return branches * p.segments;
}

class Growth {
 public:
  Growth(const TreeShape& shape, Skeleton& out) : shape_(shape), out_(out), random_(shape.seed) {
    turned_ = 2 * pi * random_.uniform();
  }

  /// A branch from a node, along the local z of `frame`, and all its descendants.
  void branch(int node, const Quaternion& frame, double length, double radius, int level) {
    const Vector3 step = length / shape_.segments * (frame * Vector3::UnitZ());
    for (int i = 0; i < shape_.segments; ++i) {
      const auto tapered = [&](int edges) { return radius * (1 - (1 - shape_.taper) * edges / shape_.segments); };
      const Vector3 tip = out_[at(node)].position_m + step;
      out_.push_back({node, tip, tapered(i + 1), tapered(i)});
      node = static_cast<int>(out_.size()) - 1;
    }
    if (level == shape_.depth) return;
    std::vector<Quaternion> frames;  // drawn for all children before any of them grows: neighbours in the spiral
    for (int child = 0; child < shape_.branches; ++child) frames.push_back(frame * turn());
    const double child_radius =
        out_.back().radius_m * std::pow(static_cast<double>(shape_.branches), -1 / shape_.pipe_exponent);
    for (const Quaternion& child : frames) branch(node, child, length * shape_.length_ratio, child_radius, level + 1);
  }

 private:
  /// From a branch's frame to that of its next child: about an axis across the branch, without twist.
  Quaternion turn() {
    turned_ += shape_.phyllotaxis == TreeShape::Phyllotaxis::golden ? golden_angle : 2 * pi * random_.uniform();
    const double spread = shape_.angle_spread_deg * (2 * random_.uniform() - 1);
    const Vector3 axis(-std::sin(turned_), std::cos(turned_), 0);
    return Quaternion(Eigen::AngleAxisd(degree * (shape_.branching_angle_deg + spread), axis));
  }

  const TreeShape& shape_;
  Skeleton& out_;
  SplitMix random_;
  double turned_;  ///< around the branch, so far
};

}  // namespace

std::optional<SkeletonFault> fault(const Skeleton& skeleton) {
  const auto edge = [&skeleton](int node) -> Vector3 {
    const SkeletonNode& end = skeleton[at(node)];
    return end.position_m - skeleton[at(end.parent)].position_m;
  };
  for (int i = 0; i < static_cast<int>(skeleton.size()); ++i) {
    const SkeletonNode& node = skeleton[at(i)];
    std::ostringstream text;
    if (!(node.radius_m > 0)) text << "radius is " << node.radius_m << "; must be positive";
    if (i > 0 && edge(i).norm() == 0) text << "position is that of its parent; must be different";
    if (!text.str().empty()) return SkeletonFault{i, text.str()};
  }
  return std::nullopt;
}

Skeleton with_base_radii(Skeleton skeleton) {
  std::vector<int> branches(skeleton.size());
  for (const SkeletonNode& node : skeleton)
    if (node.parent >= 0) ++branches[at(node.parent)];
  for (SkeletonNode& node : skeleton) {
    if (node.parent < 0) continue;
    const auto parent = at(node.parent);
    node.base_radius_m = branches[parent] == 1 ? skeleton[parent].radius_m : node.radius_m;
  }
  return skeleton;
}

Skeleton placed(const Skeleton& skeleton, const Vector3& origin, double unit_m, Up up) {
  Skeleton out = skeleton;
  for (SkeletonNode& node : out) {
    const Vector3 p = unit_m * (node.position_m - origin);
    node.position_m = up == Up::y ? p : Vector3(p.x(), p.z(), -p.y());
    node.radius_m *= unit_m;
  }
  return out;
}

void validate(const TreeShape& p) {
  require(p.depth >= 0 && p.depth <= 100, "depth", p.depth, "from 0 to 100");
  require(p.branches >= 1, "branches", p.branches, "at least 1");
  require(p.segments >= 1, "segments", p.segments, "at least 1");
  require(p.length_m > 0, "length_m", p.length_m, "positive");
  require(p.length_ratio > 0, "length_ratio", p.length_ratio, "positive");
  require(p.taper > 0 && p.taper <= 1, "taper", p.taper, "above 0 and at most 1");
  require(p.pipe_exponent > 0, "pipe_exponent", p.pipe_exponent, "positive");
  const double widest = std::abs(p.branching_angle_deg) + std::abs(p.angle_spread_deg);
  require(widest <= 150, "branching_angle_deg with angle_spread_deg", widest, "at most 150");
  require(edges_of(p) <= most_edges, "number of segments of a tree", edges_of(p), "at most 1e7");
}

int edge_count(const TreeShape& shape) { return static_cast<int>(edges_of(shape)); }

Skeleton grow(const TreeShape& shape, double radius_m) {
  validate(shape);
  Skeleton out;
  out.reserve(at(edge_count(shape)) + 1);
  out.push_back({-1, Vector3::Zero(), radius_m, radius_m});
  const Quaternion up = turn_between(Vector3::UnitZ(), Vector3::UnitY());
  Growth(shape, out).branch(0, up, shape.length_m, radius_m, 0);
  return out;
}

}  // namespace rodsweep
