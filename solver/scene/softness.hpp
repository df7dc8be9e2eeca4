// The compliance of parts of rods, and of two parts in series: what a joint between two segments has.
//
// The compliance of a cone is
//   integral of (t t^T / GJ + (I - t t^T) / EI) ds,   t its axis,
// and likewise against stretch and shear. A joint where the axis kinks has the sum of two such tensors. Its frame has the
// principal axes of the sum: x is the axis n of the kink (n = t_a x t_b), y and z are in its plane, z along the rod
// (half-way between t_a and t_b if both parts are alike).
#pragma once

#include <functional>

#include "solver/rod/rod.hpp"

namespace rodsweep {

/// Compliance of a part of a rod, about and along axes across it (bend, shear) and its own axis (twist, axial).
struct Softness {
  double length_m = 0;
  double bend = 0, twist = 0;   ///< [1/Nm]
  double shear = 0, axial = 0;  ///< [m/N]
};

Softness operator+(const Softness& a, const Softness& b);

/// Of a cone, from the radii at its ends. `section`: that of a radius.
Softness cone(double radius_m, double end_radius_m, double length_m, const std::function<Section(double)>& section);

/// The radius of the cylinder of a cone's volume and length.
double mean_radius(double radius_m, double end_radius_m);

/// Two parts in series, seen from part a, whose axis is z; `rest` turns that to b's.
struct Series {
  Vector3 stretch, bend;
  Quaternion frame;
};

Series in_series(const Softness& a, const Softness& b, const Quaternion& rest);

}  // namespace rodsweep
