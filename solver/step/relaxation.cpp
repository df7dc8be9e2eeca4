#include "solver/step/relaxation.hpp"

#include <algorithm>
#include <limits>

#include "solver/rod/joint_forces.hpp"
#include "solver/step/observables.hpp"

namespace rodsweep {
namespace {

/// Whether loads, gravity, clamps and obstacles have come to their last values.
bool is_settled(const Scene& scene) {
  const auto changes = [&](double until_s) { return scene.time_s < until_s; };
  for (const PointLoad& load : scene.loads)
    if (changes(load.schedule.until_s())) return false;
  for (const GravityChange& change : scene.gravity_changes)
    if (changes(change.schedule.until_s())) return false;
  for (const MovingClamp& clamp : scene.clamps)
    if (changes(clamp.until_s)) return false;
  return std::all_of(scene.obstacles.begin(), scene.obstacles.end(), [](const Obstacle& obstacle) {
    return std::visit([](const auto& solid) { return solid.velocity_m_s.isZero(0); }, obstacle);
  });
}

}  // namespace

Relaxation::Relaxation(const Scene& scene, double tolerance, double dt) : tolerance_(tolerance), dt_(dt) {
  for (const Rod& rod : scene.rods) {
    energy_ += kinetic_energy(rod);
    velocity_.push_back(rod.velocity);
    spin_.push_back(rod.angular_velocity);
  }
}

bool Relaxation::settle(Scene& scene) {
  const double gravity = scene.gravity_at(scene.time_s).norm();
  double energy = 0, missing = 0, carried = std::numeric_limits<double>::min();
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    const Rod& rod = scene.rods[r];
    energy += kinetic_energy(rod);
    for (std::size_t s = 0; s < rod.segments.size(); ++s) {
      const Segment& segment = rod.segments[s];
      if (segment.is_static) continue;
      const double turning = segment.inertia_transverse * (rod.angular_velocity[s] - spin_[r][s]).norm();
      missing = larger_or_nan(missing, segment.mass * (rod.velocity[s] - velocity_[r][s]).norm() / dt_);
      missing = larger_or_nan(missing, turning / (segment.length_m * dt_));
      carried = std::max(carried, segment.mass * gravity);
    }
    for (int k = 0; k < rod.joint_count(); ++k) {
      const Action action = joint_action(rod, k);
      carried = std::max({carried, action.force_n.norm(), action.moment_nm.norm() / rod.joints[at(k)].length});
    }
  }
  lacking_ = missing / carried;
  const bool started_at_rest = energy_ == 0;
  const bool falls = energy < energy_;
  energy_ = falls ? 0 : energy;
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    Rod& rod = scene.rods[r];
    if (falls)
      for (std::size_t s = 0; s < rod.segments.size(); ++s) {
        rod.velocity[s].setZero();
        rod.angular_velocity[s].setZero();
      }
    velocity_[r] = rod.velocity;
    spin_[r] = rod.angular_velocity;
  }
  return started_at_rest && lacking_ <= tolerance_ && is_settled(scene);
}

}  // namespace rodsweep
