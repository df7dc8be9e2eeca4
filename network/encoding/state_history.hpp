// What a simulator that knows states alone remembers of a rod: where it is, and its last five velocities.
//
//   x_n = x_{n-1} + dt v_n,   q_n = rotated(q_{n-1}, dt w_n)     exactly how the time step finds v and w
//   (free_flight.hpp)
// so that velocities are all that a recorded simulation must have kept. Before its first step a rod has been moving as
// it does then: at rest, most are.
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

  /// With noise that the free segments' velocities gather in equal parts over the history, a random walk of standard
  /// deviations that are `noise` at its end, and with where that would have taken them.
  StateHistory disturbed(const Rod& rod, double velocity_noise, double spin_noise, SplitMix& random) const;

 private:
  double dt_;
  bool started_ = false;
  std::vector<Vector3> position_;
  std::vector<Quaternion> orientation_;
  std::vector<std::array<Motion, length>> motion_;  ///< of each segment, the last first
};

}  // namespace rodsweep
