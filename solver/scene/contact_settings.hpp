// Contact: obstacles, and the settings of contacts.
#pragma once

#include <optional>
#include <variant>

#include "solver/numbers/types.hpp"

namespace rodsweep {

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
  double restitution = 0;   ///< e of Newton's law of impact, 0..1: the normal speed after, over that before
  double tolerance = 1e-5;  ///< converged if no contact would move its segments by more, in their radii
  int sweeps = 100;         ///< limit of sweeps over all contacts, there and back, after a projection of the rods
  double recovery = 0.2;    ///< share of an earlier penetration that a step corrects, at most 1 % of a radius
};

}  // namespace rodsweep
