// The history of a rod for a simulator of states: its position and its last five velocities.
//
//   x_n = x_{n-1} + dt v_n,   q_n = rotated(q_{n-1}, dt w_n)     v and w as in the time step (free_flight.hpp)
//
// so that a recorded simulation stores velocities only. Velocities before the first step equal those at its start.
#pragma once

#include <array>
#include <vector>

#include "solver/numbers/counter_random.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// Velocity and angular velocity of a segment.
struct Motion {
  Vector3 velocity, spin;
};

class StateHistory {
 public:
  static constexpr int length = 5;

  /// `rod` is in its state before the first step.
  StateHistory(const Rod& rod, double dt);

  /// Call once at the start of every step, with the velocities there. Allocates nothing.
  void start_step(const std::vector<Vector3>& velocity, const std::vector<Vector3>& spin);

  const Vector3& position(std::size_t segment) const { return position_[segment]; }
  const Quaternion& orientation(std::size_t segment) const { return orientation_[segment]; }
  /// The motion `ago` steps before the last.
  const Motion& motion(std::size_t segment, std::size_t ago = 0) const { return motion_[segment][ago]; }

  /// A copy with a random walk added to the free segments' velocities, and with the positions that follow from them.
  /// The walk's standard deviations at its end are `velocity_noise` and `spin_noise`.
  StateHistory disturbed(const Rod& rod, double velocity_noise, double spin_noise, SplitMix& random) const;

 private:
  double dt_;
  bool started_ = false;
  std::vector<Vector3> position_;
  std::vector<Quaternion> orientation_;
  std::vector<std::array<Motion, length>> motion_;  ///< of each segment, newest first
};

}  // namespace rodsweep
