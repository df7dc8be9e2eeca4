// The parts of scenes: segments along a line, joints of their material, moving clamps; and checks of their parameters,
// which throw SceneError.
#pragma once

#include <string>
#include <vector>

#include "solver/scene/scenes.hpp"
#include "solver/scene/softness.hpp"

namespace rodsweep {

/// The cross-section of the scene's rods.
CrossSection cross_section(const RodParameters& p);

/// Its stiffness.
Section stiffness(const RodParameters& p);

/// A segment of the scene's material.
SegmentSpec segment_at(const Vector3& centre, const Quaternion& orientation, double length_m, const RodParameters& p);

/// A static point that clamps what is joined to it: a segment of zero length, without contact.
SegmentSpec held_point(const Vector3& at, const Quaternion& orientation);

/// Segments a and b end to end (the local z axis of both points from a to b), with the material's stiffness. `force_n`:
/// the force that an "inextensible" joint has to hold.
JointSpec joint_between(const std::vector<SegmentSpec>& segments, int a, int b, const RodParameters& p, double force_n);

/// The compliance of an "inextensible" joint [1/J] that has to hold `force_n` and the scene's loads, or the given one.
double stretch_compliance(double length_m, double force_n, const RodParameters& p);

/// Sets the compliance of a joint of length l whose material is two parts in series. `force_n` as above.
void set_compliance(JointSpec& joint, const Series& series, double length_m, double force_n, const RodParameters& p);

/// Two segments with one centre, with the given stiffness about every axis [Nm] and compliance of the stretch-shear
/// rows [1/J].
JointSpec crossing_between(int a, int b, double stiffness_nm, double stretch_per_j);

/// Weight of the segments, under at least standard gravity [N].
double weight(const std::vector<SegmentSpec>& segments, const RodParameters& p);

/// Turns a segment about its axis until its local y points along `height`, which is across it.
void set_height(SegmentSpec& segment, const Vector3& height);

/// A straight line from one point to another, cut into equal pieces.
std::vector<Vector3> straight_line(const Vector3& from, const Vector3& to, int pieces);

/// Segments whose ends lie on `vertices`; orientations are parallel-transported along them.
std::vector<SegmentSpec> segments_through(const std::vector<Vector3>& vertices, const RodParameters& p);

/// Joins each segment to the next. The rest shape is the given one, or straight. `force_n` as above.
Rod chain(const std::vector<SegmentSpec>& segments, const RodParameters& p, double force_n, bool straight = false);

/// "[x, y, z]", for errors.
std::string text_of(const Vector3& point);

/// Moves a held segment of the first rod at a velocity, from its position.
void move_clamp(Scene& scene, int segment, const Vector3& velocity_m_s);

/// `why`: an explanation that begins with its punctuation, or empty.
void check_least(const char* quantity, int value, int least, const char* why = "");

/// Checks the limit on the size of a scene.
void check_segments(const char* scene, double segments);

}  // namespace rodsweep
