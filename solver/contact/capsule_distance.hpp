// Distances between the axes of capsules: line segments centre + s half, s in [-1, 1], which may have zero length.
//
// The closest points of two of them minimise the convex quadratic |c + s u - t v|^2 on a square, c the difference of
// the centres: its unconstrained minimiser, s clamped, then the best t for it, then the best s for that. If the axes
// are parallel within 1e-6, every point of their overlap is closest; the middle one is returned.
#pragma once

#include <optional>

#include "solver/numbers/types.hpp"

namespace rodsweep {

struct CapsuleAxis {
  Vector3 centre, half;
  Vector3 at(double s) const { return centre + s * half; }
};

/// Places on two axes.
struct AxisPoints {
  double s, t;
};

AxisPoints closest_points(const CapsuleAxis& a, const CapsuleAxis& b);

/// The place on an axis that is closest to a point.
double closest_point(const CapsuleAxis& axis, const Vector3& point);

/// From b to a, between their closest points.
Vector3 separation(const CapsuleAxis& a, const CapsuleAxis& b);

/// The part of a's axis onto which b's axis projects at right angles; empty if low > high.
struct Overlap {
  double low, high;
};
Overlap overlap(const CapsuleAxis& a, const CapsuleAxis& b);

/// An upper bound of the motion of any point of a relative to any of b, while their ends move on straight lines.
double relative_motion(const CapsuleAxis& a_from, const CapsuleAxis& a_to, const CapsuleAxis& b_from,
                       const CapsuleAxis& b_to);

/// The first time, from 0 to 1, at which two axes with this motion are `distance` apart, by conservative advancement
/// (Mirtich 1996), to a thousandth of the distance. A pair that is undecided after 64 advances counts as a contact.
std::optional<double> first_touch(const CapsuleAxis& a_from, const CapsuleAxis& a_to, const CapsuleAxis& b_from,
                                  const CapsuleAxis& b_to, double distance);

/// The axis at a time from 0 to 1.
CapsuleAxis between(const CapsuleAxis& from, const CapsuleAxis& to, double time);

}  // namespace rodsweep
