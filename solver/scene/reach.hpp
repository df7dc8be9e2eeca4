// Whether the rods between clamps can follow how these move.
#pragma once

#include <functional>
#include <vector>

#include "solver/scene/scene.hpp"

namespace rodsweep {

/// How a held segment of a rod moves.
struct ClampPath {
  int segment;
  std::function<Pose(double time_s)> pose;
  std::function<Vector3(double time_s)> turned_deg;  ///< rotation vector, also of many turns
};

/// Throws SceneError if at one of these times two clamps of a rod are farther apart than the rod between them is long,
/// unless it `stretches`; or if they are turned against each other by more than a right angle for each joint between
/// them: there a joint bears the most, and beyond half a turn it slips by a turn.
void check_reach(const Rod& rod, const std::vector<ClampPath>& paths, const std::vector<double>& times_s,
                 bool stretches);

}  // namespace rodsweep
