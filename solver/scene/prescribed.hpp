// What changes a scene over time, in every scene: loads at points, motions of clamps, changes of gravity.
//
// A point belongs to the segment whose axis is nearest at the start, and to that point of its axis. Where held segments
// meet, such as at a held node of a lattice, a motion moves all of them. Of free ones that meet, the first bears a load.
#pragma once

#include <vector>

#include "solver/numbers/types.hpp"

namespace rodsweep {

struct Scene;

/// A number over time: linear between given times, or smooth with zero speed at each of them; constant before and after.
struct Schedule {
  std::vector<double> times_s, factors;  ///< of equal length; both empty: 1 at all times
  bool smooth = false;

  double at(double time_s) const;
  double largest() const;  ///< magnitude
  double until_s() const;  ///< constant from then on
  /// Throws SceneError unless times increase and each has a factor.
  void check() const;
};

/// A force and a torque, fixed in the world, times the schedule.
struct PrescribedLoad {
  Vector3 at_m{0, 0, 0}, force_n{0, 0, 0}, torque_nm{0, 0, 0};
  Schedule schedule;
};

/// A held segment moves by a displacement, and turns about `at_m` by a rotation vector in the world, times the schedule.
/// Several motions of one segment add up in any order: their displacements, and their rotation vectors about one point.
struct PrescribedMotion {
  Vector3 at_m{0, 0, 0}, displacement_m{0, 0, 0}, rotation_deg{0, 0, 0};
  Schedule schedule;
};

/// Is added to the scene's gravity, times the schedule.
struct GravityChange {
  Vector3 by_m_s2{0, 0, 0};
  Schedule schedule;
};

struct Prescribed {
  std::vector<PrescribedLoad> loads;
  std::vector<PrescribedMotion> motions;
  std::vector<GravityChange> gravity;

  /// Throws SceneError unless times increase and have factors, and motions begin with the factor 0.
  void check() const;
  /// What an "inextensible" joint may have to hold beside the weight [N].
  double largest_force_n() const;
  double largest_gravity_m_s2(const Vector3& constant) const;
};

/// Adds them, checked, to a scene with rods. Throws SceneError if a point is away from all rods, if a load is on a held
/// segment, if a motion is on one that is not held or that the scene moves itself, if motions turn one segment about
/// different points, or if rods cannot follow them. `stretches`: whether rods may become longer.
void add_prescribed(const Prescribed& prescribed, Scene& scene, bool stretches = true);

}  // namespace rodsweep
