// What the scenes are made of: segments along a line, joints of their material, clamps that move; and bounds on their
// parameters, which throw SceneError.
#pragma once

#include <vector>

#include "solver/scene/scenes.hpp"

namespace rodsweep {

/// A segment of the scene's material.
SegmentSpec segment_at(const Vector3& centre, const Quaternion& orientation, double length_m, const RodParameters& p);

/// Segments a and b end to end (the local z axis of both points from a to b), as stiff as the material. `force_n`: what
/// an "inextensible" joint has to hold.
JointSpec joint_between(const std::vector<SegmentSpec>& segments, int a, int b, const RodParameters& p, double force_n);

/// Two segments whose centres coincide, as stiff about every axis as said [Nm] and as soft in its three stretch-shear
/// rows [1/J]. The bend-twist constraint measures a turn about the axis by which the two differ at rest, by an angle
/// theta, by cos(theta / 2) only: compliance makes up for that where this is an axis of the frames.
JointSpec crossing_between(const std::vector<SegmentSpec>& segments, int a, int b, double stiffness_nm,
                           double stretch_per_j);

/// Weight of the segments, under standard gravity at least [N].
double weight(const std::vector<SegmentSpec>& segments, const RodParameters& p);

/// A straight line from one point to another, cut into equal pieces.
std::vector<Vector3> straight_line(const Vector3& from, const Vector3& to, int pieces);

/// Segments whose ends lie on `vertices`; orientations are parallel-transported along them.
std::vector<SegmentSpec> segments_through(const std::vector<Vector3>& vertices, const RodParameters& p);

/// Each segment joined to the next, at rest as they are or straight. `force_n` as above.
Rod chain(const std::vector<SegmentSpec>& segments, const RodParameters& p, double force_n, bool straight = false);

/// A held segment of the first rod moves on from where it is at a velocity.
void move_clamp(Scene& scene, int segment, const Vector3& velocity_m_s);

/// `why`, where it is not plain, with the punctuation before it.
void check_least(const char* quantity, int value, int least, const char* why = "");

/// Of a scene as a whole.
void check_segments(const char* scene, double segments);

}  // namespace rodsweep
