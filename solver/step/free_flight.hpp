// The two ends of a time step of one rod: free flight before its projections, velocities after them. Euler:
//
//   v* = (v + h (g + f / m)) / (1 + c h),  w* = (w + h I^-1 (tau - w x I w)) / (1 + c h)
//   x* = x + h v*,   q* = normalise(q + h [0, w*] q / 2)        of free segments
//   v = (x - x_old) / h,   w = (2 / h) Im(d) / Re(d),  d = q conj(q_old)
//
// BDF2 has other x_old, q_old, v* and w* (two_step_flight.hpp).
// I is axisymmetric: w x I w = (i_a - i_t) (t.w) w x t is transverse to the axis t, and I^-1 = i_t^-1 + excess t t^T.
// Processes as many segments at a time as a register has lanes. Nothing allocates after construction.
//
// The schemes in time: implicit Euler, as in Deul et al. 2018 and Shao et al. 2021, and BDF2 (Curtiss and Hirschfelder
// 1952). Both are one formula, with the forces at the end of the step:
//
//   x = x^ + h v,   q = rotated(q^, h w),   v (1 + c h) = v^ + h (g + f / m),   L (1 + c h) = L^ + h tau
//
//   euler   first order,   h = dt,       x^ = x_n,                     v^ = v_n, ...
//   bdf2    second order,  h = 2 dt / 3, x^ = (4 x_n - x_(n-1)) / 3,   v^ = (4 v_n - v_(n-1)) / 3, ...
//
// L is the angular momentum in the world. So constraints, compliance, damping and contacts only see another time step,
// h. The first step of BDF2 is one of Euler.
#pragma once

#include <vector>

#include "solver/rod/rod.hpp"
#include "solver/step/two_step_flight.hpp"

namespace rodsweep {

enum class Integrator { euler, bdf2 };

/// h of a step of dt.
constexpr double implicit_dt(double dt, bool uses_two_steps) { return uses_two_steps ? 2 * dt / 3 : dt; }

/// The loads on a segment of a rod, in the world.
struct SegmentLoads {
  std::vector<Vector3> force_n, torque_nm;
};

/// The motion of a rod's segments at one time.
struct RodMotion {
  std::vector<Vector3> position, velocity, angular_velocity;
  std::vector<Quaternion> orientation;
};

class FreeFlight {
 public:
  FreeFlight(const Rod& rod, Integrator integrator, double dt);

  /// Starts a step. If it uses two steps, the rod has the motion that is expected at the end of the step from now to
  /// predict(), since its loads act there.
  void start(Rod& rod);
  /// Starts the same step as one of Euler, at the rod's pose before start(): it hits something. So are the next two.
  void start_anew(Rod& rod);

  bool uses_two_steps() const { return uses_two_steps_; }
  double h() const { return implicit_dt(dt_, uses_two_steps_); }  ///< of this step

  /// Moves free segments to x*, q*. `loads` may be null.
  void predict(Rod& rod, double damping_per_s, const Vector3& gravity_m_s2, const SegmentLoads* loads);

  /// Moves free segments from there to where they are expected at the end of the step, x^ + h (2 v_n - v_(n-1)), q
  /// likewise, if the last step is known.
  void extrapolate(Rod& rod) const;

  void update_velocities(Rod& rod) const;

  /// The motion at the start of the last step; empty before one, and after an impact, when the next step does not use it.
  RodMotion before(const Rod& rod) const;
  /// Continues a rod that had this motion a step ago.
  void continue_from(const Rod& rod, const RodMotion& before);

  /// x^ and q^ of all segments, from which this step's velocities are measured.
  void put_past(const Rod& rod, Vector3* position, Quaternion* orientation) const;

 private:
  struct Group {  ///< neighbours, padded with copies of the last segment
    LaneMask is_free;
    Lane inverse_mass, inverse_inertia_transverse;
    Lane excess;             ///< of the inverse inertia: axial minus transverse
    Lane gyration;           ///< (i_a - i_t) / i_t
    LaneMotion now, before;  ///< at the start of this step and of the last one
    LaneMotion expected;     ///< at the end, if the step uses two
    LanePose past;
  };
  void predict_by_two_steps(Rod& rod, double damping_per_s, const Vector3& gravity_m_s2, const SegmentLoads* loads);

  Integrator integrator_;
  double dt_;
  std::vector<Group> groups_;
  int known_ = 0;  ///< motions since the start or an impact, at most 2: now and before
  bool uses_two_steps_ = false;
};

}  // namespace rodsweep
