// Equilibrium by dynamic relaxation with kinetic damping (Day 1965; Cundall 1976): steps are those of Euler, and all
// velocities are set to zero whenever the kinetic energy falls, since it is near a maximum where forces nearly balance.
//
// A scene is at rest if nothing that moves or loads it will change any more and, in a step that starts without
// velocities, no segment lacks a force: the largest m |a|, or I |dw/dt| over the segment's length, is at most the
// tolerance times the largest force that a joint carries (or moment over its length), or times the weight of a segment if
// that is larger. Steps must balance momentum at least as well.
#pragma once

#include <vector>

#include "solver/scene/scene.hpp"

namespace rodsweep {

class Relaxation {
 public:
  /// dt: of the steps [s].
  Relaxation(const Scene& scene, double tolerance, double dt);

  /// To be called after each step. Returns whether the scene is at rest; if not, may zero its velocities.
  bool settle(Scene& scene);

  double lacking() const { return lacking_; }  ///< the largest missing force over the one that is compared with

 private:
  double tolerance_, dt_, energy_ = 0, lacking_ = 0;
  std::vector<std::vector<Vector3>> velocity_, spin_;  ///< at the start of the step, by rod
};

}  // namespace rodsweep
