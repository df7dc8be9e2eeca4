// The skeleton of a tree: nodes with parents, and how one is grown from a few numbers.
//
// Every node has a radius, and except for the root an edge from its parent, a cone (SWC files: Cannon et al. 1998).
// Growth: a trunk along +y; every branch of `segments` edges ends in `branches` new ones, `length_ratio` as
// long, repeated `depth` times:
//   edges = segments (1 + b + ... + b^depth)
// A child leaves at branching_angle_deg, plus or minus up to angle_spread_deg. Its direction around the parent advances
// by the golden angle from child to child (phyllotaxis), or is random. Radii follow the pipe model (Shinozaki et al.
// 1964; Leonardo's rule at exponent 2): for the edge below a branching and those above it,
//   r^e = sum of r_i^e,   so r_i = r b^(-1/e);
// within a branch they fall linearly to `taper` times that at its end. Lengths in m.
// Throws SceneError with the value that is out of bounds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "solver/numbers/types.hpp"

namespace rodsweep {

struct SkeletonNode {
  int parent = -1;  ///< an earlier node; -1 only for the root, which is the first
  Vector3 position_m{0, 0, 0};
  double radius_m = 0;       ///< here, at the upper end of the edge from the parent
  double base_radius_m = 0;  ///< at its lower end
};

using Skeleton = std::vector<SkeletonNode>;

/// The first node at which a skeleton cannot become a rod, and the reason.
struct SkeletonFault {
  int node;
  std::string text;
};

/// Finds radii that are not positive and edges without length.
std::optional<SkeletonFault> fault(const Skeleton& skeleton);

/// An edge begins with the radius of its lower node, or at a fork with that of its upper one: a thin twig on a thick
/// trunk is not a cone. On a branch that tapers, that is an error of second order in edge lengths.
Skeleton with_base_radii(Skeleton skeleton);

enum class Up { y, z };

/// Converts a skeleton in another unit with the axis `up` upwards to metres from `origin`, y up.
Skeleton placed(const Skeleton& skeleton, const Vector3& origin, double unit_m, Up up);

struct TreeShape {
  enum class Phyllotaxis { golden, random };
  int depth = 4;        ///< branchings between the ground and a twig
  int branches = 3;     ///< per branching
  int segments = 4;     ///< of each branch, and of the trunk
  double length_m = 1;  ///< of the trunk
  double length_ratio = 0.75;
  double taper = 1;
  double pipe_exponent = 2;
  double branching_angle_deg = 35, angle_spread_deg = 10;
  Phyllotaxis phyllotaxis = Phyllotaxis::golden;
  std::uint64_t seed = 0;  ///< of angles and directions
};

/// Throws SceneError if a value is out of bounds.
void validate(const TreeShape& shape);

int edge_count(const TreeShape& shape);

/// Nodes are in order of branches, each branch as a whole; parents come first. The root is the origin. `radius_m`: of
/// the trunk at the ground.
Skeleton grow(const TreeShape& shape, double radius_m);

}  // namespace rodsweep
