// The history of a rod for a simulator of states: its position and its last five velocities.
//
//   x_n = x_{n-1} + dt v_n,   q_n = rotated(q_{n-1}, dt w_n)     exactly the v and w of the time step (free_flight.hpp)
//
// so that a recorded simulation needs to store velocities only. Before the first step the velocities are taken to be
// those of its start.
#pragma once

#include <array>
#include <vector>

#include "solver/numbers/split_mix.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// Velocity and angular velocity of a segment.
struct Motion {
  Vector3 velocity, spin;
};

class StateHistory {
 public:
  static constexpr int length = 5;

  /// Of a rod before its first step.
  StateHistory(const Rod& rod, double dt);

  /// Once at the start of every step, with the velocities there. Allocates nothing.
  void start_step(const std::vector<Vector3>& velocity, const std::vector<Vector3>& spin);

  const Vector3& position(std::size_t segment) const { return position_[segment]; }
  const Quaternion& orientation(std::size_t segment) const { return orientation_[segment]; }
  /// The last, `ago` steps ago.
  const Motion& motion(std::size_t segment, std::size_t ago = 0) const { return motion_[segment][ago]; }

  /// Adds noise to the free segments' velocities, a random walk over the history with the standard deviation `noise` at its
  /// end, and to the positions that follow from them.
  StateHistory disturbed(const Rod& rod, double velocity_noise, double spin_noise, SplitMix& random) const;

 private:
  double dt_;
  bool started_ = false;
  std::vector<Vector3> position_;
  std::vector<Quaternion> orientation_;
  std::vector<std::array<Motion, length>> motion_;  ///< of each segment, the last first
};

}  // namespace rodsweep
