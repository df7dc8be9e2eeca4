#include "network/encoding/state_history.hpp"

#include <algorithm>
#include <cmath>

#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

Vector3 normal(SplitMix& random) {
  Vector3 out;
  for (double& x : out) x = random.normal();
  return out;
}

}  // namespace

StateHistory::StateHistory(const Rod& rod, double dt)
    : dt_(dt), position_(rod.position), orientation_(rod.orientation), motion_(rod.segments.size()) {}

void StateHistory::start_step(const std::vector<Vector3>& velocity, const std::vector<Vector3>& spin) {
  for (std::size_t s = 0; s < motion_.size(); ++s) {
    const Motion now{velocity[s], spin[s]};
    if (!started_) {
      motion_[s].fill(now);
      continue;
    }
    std::copy_backward(motion_[s].begin(), motion_[s].end() - 1, motion_[s].end());
    motion_[s].front() = now;
    position_[s] += dt_ * now.velocity;
    orientation_[s] = rotated(orientation_[s], dt_ * now.spin);
  }
  started_ = true;
}

StateHistory StateHistory::disturbed(const Rod& rod, double velocity_noise, double spin_noise, SplitMix& random) const {
  StateHistory out = *this;
  const double part = 1 / std::sqrt(static_cast<double>(length));
  for (std::size_t s = 0; s < motion_.size(); ++s) {
    if (rod.segments[s].is_static) continue;
    Motion walk{Vector3::Zero(), Vector3::Zero()};
    for (auto motion = out.motion_[s].rbegin(); motion != out.motion_[s].rend(); ++motion) {
      walk.velocity += part * velocity_noise * normal(random);
      walk.spin += part * spin_noise * normal(random);
      motion->velocity += walk.velocity;
      motion->spin += walk.spin;
      out.position_[s] += dt_ * walk.velocity;
      out.orientation_[s] = rotated(out.orientation_[s], dt_ * walk.spin);
    }
  }
  return out;
}

}  // namespace rodsweep
