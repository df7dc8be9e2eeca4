// A scene: rods, the loads on them, and how held segments move.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "solver/numbers/types.hpp"
#include "solver/rod/rod.hpp"
#include "solver/scene/contact_settings.hpp"
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

struct Scene {
  std::vector<Rod> rods;
  Vector3 gravity_m_s2{0, -9.81, 0};  ///< without the changes
  std::vector<GravityChange> gravity_changes;
  double damping_per_s = 0;  ///< viscous drag rate c: dv/dt = -c v, dw/dt = -c w, taken implicitly
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
