// What the scenes are built of: segments along a direction, joints of their material, and the rods themselves.
#pragma once

#include <vector>

#include "solver/scene/scenes.hpp"

namespace rodsweep {

/// A segment of the scene's material.
SegmentSpec segment_at(const Vector3& centre, const Quaternion& orientation, double length_m, const RodParameters& p);

/// Segments a and b end to end (the local z axis of both points from a to b), as stiff as the material. `force_n`: what
/// an "inextensible" joint has to hold.
JointSpec joint_between(const std::vector<SegmentSpec>& segments, int a, int b, const RodParameters& p, double force_n);

/// Weight of the segments, under standard gravity at least [N].
double weight(const std::vector<SegmentSpec>& segments, const RodParameters& p);

/// Segments whose ends lie on `vertices`; orientations are parallel-transported along them.
std::vector<SegmentSpec> segments_through(const std::vector<Vector3>& vertices, const RodParameters& p);

/// Each segment joined to the next, at rest as they are or straight. `force_n` as above.
Rod chain(const std::vector<SegmentSpec>& segments, const RodParameters& p, double force_n, bool straight = false);

Rod build_rod(const BendingRod& p);
Rod build_rod(const Helix& p);
Rod build_rod(const Ring& p);
Rod build_rod(const Net& p);
Rod build_rod(const Tree& p);
Rod build_rod(const SkeletonTree& p);
Rod build_rod(const CoilingRod& p);
Rod build_rod(const Knot& p);
std::vector<Rod> build_rods(const Forest& p);
std::vector<Rod> build_rods(const FallingRods& p);
std::vector<Rod> build_rods(const RingChain& p);
std::vector<Rod> build_rods(const Bundle& p);

/// A knot's length, of the least that is loose enough, in radii.
double loose_knot_radii();

/// The smallest chain ring through which the next one fits, around, in radii.
constexpr double open_ring_radii = 40;

}  // namespace rodsweep
