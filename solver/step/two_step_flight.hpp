// The free flight of BDF2 (free_flight.hpp), of as many segments as a register has lanes.
//
// A turn by the constraints, d, adds to a turn h w* of free flight as h w = h w* + d + d x h w* / 2: neglecting the
// last term would make BDF2 first order, and so would the axis and the inertia at the start of the step. So BDF2 expects
// w~ = 2 w_n - w_(n-1) and the axis t~ that follows from it, of second order both, and lets free segments turn by
//
//   h (w* - s h w~ x w* / 2),   w* = ((1 - t~ t~^T) (L^ + h tau) / i_t + (w_a^ + h t~.tau / i_a) t~) / (1 + c h)
//
// with s = 1 / (1 + |h w~|^2 / 4), which matters only for turns that the step does not resolve. The momentum about the
// axis, i_a w_a, changes by torques about it alone; it is not taken from L, or an error of t~ would spin a thin segment.
#pragma once

#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

/// Of segments: v [m/s], w [rad/s] in the world.
struct LaneMotion {
  LaneVector position;
  LaneQuaternion orientation;
  LaneVector velocity, spin;
};

struct LanePose {
  LaneVector position;
  LaneQuaternion orientation;
};

inline LaneVector past(const LaneVector& now, const LaneVector& before) {
  return all_lanes(4.0 / 3) * now - all_lanes(1.0 / 3) * before;
}

/// x^ and q^, which is not normalised: the rotation maps do not see its norm.
inline LanePose past_pose(const LaneMotion& now, const LaneMotion& before) {
  const LaneQuaternion &q = now.orientation, p = in_hemisphere_of(q, before.orientation);
  return {past(now.position, before.position), {4 * q.w - p.w, 4 * q.x - p.x, 4 * q.y - p.y, 4 * q.z - p.z}};
}

/// Where segments are expected at the end of a step, and how fast, from their motions at its start and a step before.
inline LaneMotion expected(const LanePose& past, const LaneMotion& now, const LaneMotion& before, const Lane& h) {
  const Lane twice = all_lanes(2);
  const LaneVector velocity = twice * now.velocity - before.velocity, spin = twice * now.spin - before.spin;
  return {past.position + h * velocity, rotated(past.orientation, h * spin), velocity, spin};
}

/// The inertia and the loads of segments in BDF2's free flight.
struct Flight {
  Lane gyration;         ///< (i_a - i_t) / i_t
  Lane damping;          ///< 1 / (1 + c h)
  LaneVector gain;       ///< h times the acceleration by loads
  LaneVector turning{};  ///< h tau / i_t
  Lane axial_turning{};  ///< h t~.tau / i_a
};

/// The turn h w of BDF2's free flight.
inline LaneVector free_turn(const LaneMotion& now, const LaneMotion& before, const LaneMotion& expected,
                            const Flight& flight, const Lane& h) {
  const LaneVector axis_now = director(now.orientation), axis_before = director(before.orientation);
  const LaneVector axis = director(expected.orientation);
  const Lane axial_now = dot(axis_now, now.spin), axial_before = dot(axis_before, before.spin);
  const LaneVector momentum = past(now.spin + (flight.gyration * axial_now) * axis_now,
                                   before.spin + (flight.gyration * axial_before) * axis_before) +
                              flight.turning;  // L over i_t
  const Lane axial = (4 * axial_now - axial_before) / 3 + flight.axial_turning;
  const LaneVector spin = flight.damping * (momentum + (axial - dot(axis, momentum)) * axis);
  const Lane half = 0.5 * h / (1 + 0.25 * h * h * dot(expected.spin, expected.spin));
  return h * (spin - half * cross(expected.spin, spin));
}

inline LaneVector free_velocity(const LaneMotion& now, const LaneMotion& before, const Flight& flight) {
  return flight.damping * (past(now.velocity, before.velocity) + flight.gain);
}

/// Where free flight ends.
inline LanePose flown(const LanePose& past, const LaneMotion& now, const LaneMotion& before, const LaneMotion& expected,
                      const Flight& flight, const Lane& h) {
  return {past.position + h * free_velocity(now, before, flight),
          rotated(past.orientation, free_turn(now, before, expected, flight, h))};
}

}  // namespace rodsweep
