// Joints of a tree: where the stiffness of its edges is.
//
// An edge is a cone of two halves, from its lower node to its middle and on to its upper node (softness.hpp). Each joint has
// the halves that meet at it, in series:
//   a node with one edge above   the upper half of the edge below, the lower half of the edge above
//   a fork                       the lower half of its branch. The moments of all branches bend the upper half of the
//                                edge below, so that half belongs to the joint at that edge's lower end: a shift of
//                                compliance by less than an edge, an error of second order in edge lengths
//   the ground                   the lower half of its edge
// So a joint's stiffness does not depend on the other branches of its node, nor on the order of nodes.
#pragma once

#include "solver/scene/scene_parts.hpp"
#include "solver/scene/tree_skeleton.hpp"

namespace rodsweep {

/// The joints of a skeleton's edges; joint i - 1 is at the lower end of edge i, between segments parent(i) and i.
/// `segments`: of the edges, 0 the ground. Moduli grow with the radius as stated in scenes.hpp.
std::vector<JointSpec> tree_joints(const Skeleton& skeleton, const std::vector<SegmentSpec>& segments,
                                   const RodParameters& p, double modulus_exponent);

}  // namespace rodsweep
