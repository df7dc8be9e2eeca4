// A scene: rods, the loads on them, how held segments move, obstacles, and the settings of contacts.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "solver/numbers/types.hpp"
#include "solver/rod/rod.hpp"
#include "solver/scene/prescribed.hpp"
#include "solver/scene/wind.hpp"

namespace rodsweep {

/// Position and orientation of a held segment at a time.
struct Pose {
  Vector3 position{0, 0, 0};
  Quaternion orientation = Quaternion::Identity();
};

/// A moving clamp: the pose of a static segment as a function of time [s].
struct MovingClamp {
  int rod = 0;
  int segment = 0;
  std::function<Pose(double time_s)> pose;
  double until_s = std::numeric_limits<double>::infinity();  ///< constant from then on
};

/// A dead load on one segment: force at `arm` (local frame, from the centre) and torque, both fixed in the world, times
/// the schedule.
struct PointLoad {
  int rod = 0;
  int segment = 0;
  Vector3 force_n{0, 0, 0};
  Vector3 torque_nm{0, 0, 0};
  Vector3 arm_m{0, 0, 0};
  Schedule schedule{};
};

// Obstacles are at the given place at time 0 and move at their velocity without rotating.

/// All points x with (x - point).normal <= 0 are solid. The normal need not be of unit length.
struct HalfSpace {
  Vector3 point_m{0, 0, 0};
  Vector3 normal{0, 1, 0};
  Vector3 velocity_m_s{0, 0, 0};
};

struct Ball {
  Vector3 centre_m{0, 0, 0};
  double radius_m = 1;
  Vector3 velocity_m_s{0, 0, 0};
};

/// All points nearer than the radius to the line between two points.
struct Capsule {
  Vector3 from_m{0, 0, 0}, to_m{0, 0, 1};
  double radius_m = 1;
  Vector3 velocity_m_s{0, 0, 0};
};

/// A solid that contacts do not move.
using Obstacle = std::variant<HalfSpace, Ball, Capsule>;

struct ContactSettings {
  double friction = 0.3;                      ///< Coulomb's coefficient mu, at rest and sliding
  std::optional<double> obstacle_friction{};  ///< of rods with obstacles; else as between rods
  double restitution = 0;           ///< e of Newton's law of impact, 0..1: the normal speed after, over that before
  std::optional<double> tolerance;  ///< converged if no contact would move its segments by more, in their radii
  int sweeps = 100;       ///< limit of sweeps over all contacts, there and back, after a projection of the rods
  double recovery = 0.2;  ///< share of an earlier penetration that a step corrects, at most 1 % of a radius

  /// By default the contacts of a second may err by a fiftieth of a radius, however many steps it has.
  double tolerance_in(double dt) const {
    constexpr double per_s = 0.02;
    return tolerance.value_or(per_s * dt);
  }
};

struct Scene {
  std::vector<Rod> rods;
  Vector3 gravity_m_s2{0, -9.81, 0};  ///< without the changes
  std::vector<GravityChange> gravity_changes;
  double damping_per_s = 0;       ///< viscous drag rate c: dv/dt = -c v, dw/dt = -c w, taken implicitly
  double internal_damping_s = 0;  ///< tau of solver/step/internal_damping.hpp
  std::vector<MovingClamp> clamps;
  std::vector<PointLoad> loads;
  std::optional<ContactSettings> contact;  ///< empty: no contacts
  std::vector<Obstacle> obstacles;
  std::optional<Wind> wind;
  double time_s = 0;

  Vector3 gravity_at(double time) const {
    Vector3 sum = gravity_m_s2;
    for (const GravityChange& change : gravity_changes) sum += change.schedule.at(time) * change.by_m_s2;
    return sum;
  }
};

}  // namespace rodsweep
