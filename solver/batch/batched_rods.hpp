// The state of the batched step: equal chains, as many as a register has lanes, rod r in lane r of every number.
//
// Equal chains have the same number of segments, joint k between segments k and k + 1, and the same static segments.
// Everything else (sizes, moduli, rest shapes, states, gravity, damping) may differ. Lanes beyond the last rod repeat
// it, so that they hold valid numbers.
#pragma once

#include <vector>

#include "solver/numbers/lane_blocks.hpp"
#include "solver/numbers/lane_math.hpp"
#include "solver/rod/joint_constraint.hpp"
#include "solver/rod/momentum_balance.hpp"
#include "solver/scene/scene.hpp"

namespace rodsweep {

struct BatchedSegment {
  bool is_static;
  Lane inverse_mass, inverse_inertia_axial;
  Lane turn_mobility;                                   ///< inverse transverse inertia, with stiffening
  Lane root_turn_mobility, root_inverse_inertia_axial;  ///< square roots
  Lane gyration;                                        ///< (axial - transverse) / transverse inertia
  LaneVector position, velocity, angular_velocity;
  LaneQuaternion orientation;
};

struct BatchedJoint {
  JointShape<Lane> shape;
  LaneVector6 compliance;  ///< alpha~ [1/(kg m^2)]
  LaneVector6 lambda;
};

struct BatchedRods {
  static constexpr int lanes = lane_width;

  /// From the states of scenes of one rod each, for steps with h (time_step.hpp). Throws SceneError for no scene or more
  /// than `lanes`, rods that are not equal chains, a joint between static segments, moving clamps, point loads, contact
  /// or wind.
  BatchedRods(const std::vector<Scene>& scenes, double h);

  void set_step(double h);  ///< of the next steps

  /// Writes the state of rod `lane` and its p* into its scene.
  void write(int lane, Scene& scene) const;

  int rods;
  std::vector<BatchedSegment> segments;
  std::vector<BatchedJoint> joints;
  std::vector<LaneVector6> alpha;       ///< of the joints [1/J]: alpha~ = alpha / dt_c^2
  JointKinks kinks;                     ///< of the joints that are not straight
  std::vector<SegmentPose<Lane>> free;  ///< p* of the segments
  LaneVector gravity;
  Lane damping_per_s;     ///< c
  Lane damping;           ///< 1 / (1 + c h)
  Lane constraint_dt;     ///< dt_c
  bool stretches_evenly;  ///< every joint's stretch and shear compliances are equal
};

}  // namespace rodsweep
