// The two ends of a time step of one rod: free flight before its projections, velocities after them.
//
//   v* = (v + dt (g + f / m)) / (1 + c dt),  w* = (w + dt I^-1 (tau - w x I w)) / (1 + c dt)
//   x* = x + dt v*,   q* = normalise(q + dt [0, w*] q / 2)        of free segments
//   v = (x - x_old) / dt,   w = (2 / dt) Im(d) / Re(d),  d = q conj(q_old)
// I is axisymmetric: w x I w = (i_a - i_t) (t.w) w x t is transverse to the axis t, and I^-1 = i_t^-1 + excess t t^T.
// Processes as many segments at a time as a register has lanes. Nothing allocates after construction.
#pragma once

#include <vector>

#include "solver/numbers/lane_math.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// The loads on a segment of a rod, in the world.
struct SegmentLoads {
  std::vector<Vector3> force_n, torque_nm;
};

class FreeFlight {
 public:
  explicit FreeFlight(const Rod& rod);

  /// Moves free segments to x*, q* and remembers the state at the start of the step. `loads` may be null.
  void predict(Rod& rod, double dt, double damping_per_s, const Vector3& gravity_m_s2, const SegmentLoads* loads);

  /// To be called between these two. Moves free segments to x_old + dt (2 v - v_before), q likewise, with v_before from
  /// the last call; the first call leaves the rod at p*.
  void extrapolate(Rod& rod, double dt);

  void update_velocities(Rod& rod, double dt) const;

 private:
  struct Group {  ///< neighbours, padded with copies of the last segment
    LaneMask is_free;
    Lane inverse_mass, inverse_inertia_transverse;
    Lane excess;    ///< of the inverse inertia: axial minus transverse
    Lane gyration;  ///< (i_a - i_t) / i_t
    LaneVector old_position;
    LaneQuaternion old_orientation;
    LaneVector velocity_before, spin_before;
  };
  std::vector<Group> groups_;
  bool extrapolates_ = false;  ///< velocities before are known
};

}  // namespace rodsweep
