#include "solver/step/observables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/numbers/rotation.hpp"
#include "solver/rod/joint_forces.hpp"
#include "solver/rod/momentum_balance.hpp"

namespace rodsweep {
namespace {

/// I w of an axisymmetric segment, world frame.
Vector3 spin_momentum(const Rod& rod, std::size_t s) {
  const Segment& segment = rod.segments[s];
  const Vector3 axis = director(rod.orientation[s]);
  const Vector3& w = rod.angular_velocity[s];
  return segment.inertia_transverse * w + (segment.inertia_axial - segment.inertia_transverse) * axis.dot(w) * axis;
}

Linearization linearized(const Rod& rod) {
  Linearization at(rod);
  linearize(rod, at);
  return at;
}

/// Of rows first to end - 1 of a joint.
double stored_energy(const Rod& rod, const Linearization& at, std::size_t joint, int first, int end) {
  double energy = 0;
  for (int row = first; row < end; ++row) {
    const double c = at.constraint[static_cast<Eigen::Index>(6 * joint) + row];
    const double alpha = rod.joints[joint].compliance[row];
    if (alpha > 0) energy += c * c / alpha / 2;
  }
  return energy;
}

}  // namespace

double rod_length(const Rod& rod) {
  // Each segment's ends: the midpoints of the joints there, or its own end if it has no joint.
  const std::size_t n = rod.segments.size();
  std::vector<Vector3> tail(n), head(n);
  for (std::size_t s = 0; s < n; ++s) {
    const Vector3 half = rod.segments[s].length_m / 2 * director(rod.orientation[s]);
    tail[s] = rod.position[s] - half;
    head[s] = rod.position[s] + half;
  }
  const auto move_end = [&](int segment, const Vector3& arm, const Vector3& to) {
    const std::size_t s = at(segment);
    if (std::abs(arm.z()) < rod.segments[s].length_m / 4) return;  // nearer to the centre than to an end
    (arm.z() < 0 ? tail[s] : head[s]) = to;
  };
  for (const Joint& j : rod.joints) {
    const Vector3 midpoint = (point_on_a(rod, j) + point_on_b(rod, j)) / 2;
    move_end(j.a, j.arm_a, midpoint);
    move_end(j.b, j.arm_b, midpoint);
  }
  double length = 0;
  for (std::size_t s = 0; s < n; ++s)
    if (rod.segments[s].length_m > 0) length += (head[s] - tail[s]).norm();
  return length;
}

double joint_gap(const Rod& rod) {
  double worst = 0;
  for (const Joint& j : rod.joints)
    worst = std::max(worst, (point_on_a(rod, j) - point_on_b(rod, j)).norm() / j.length);
  return worst;
}

double newton_residual(const Rod& rod, double constraint_dt) {
  return newton_residual(rod, linearized(rod), constraint_dt);
}

double newton_residual(const Rod& rod, const Linearization& at, double constraint_dt) {
  double worst = 0;
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Eigen::Index row = static_cast<Eigen::Index>(6 * k);
    const Vector6 residual = rod.residual(k, at.constraint.segment<6>(row), 1 / (constraint_dt * constraint_dt));
    if (!residual.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    worst = std::max(worst, residual.lpNorm<Eigen::Infinity>());
  }
  return worst;
}

double momentum_residual(const Rod& rod) {
  MomentumBalance balance(rod);
  balance_momentum(rod, linearized(rod), balance);
  return balance.residual;
}

double elastic_energy(const Rod& rod) { return elastic_energy(rod, linearized(rod)); }

double elastic_energy(const Rod& rod, const Linearization& at) {
  double energy = 0;
  for (std::size_t k = 0; k < rod.joints.size(); ++k)
    energy += stored_energy(rod, at, k, rod.joints[k].is_inextensible ? 3 : 0, 6);
  return energy;
}

double gap_energy(const Rod& rod) { return gap_energy(rod, linearized(rod)); }

double gap_energy(const Rod& rod, const Linearization& at) {
  double energy = 0;
  for (std::size_t k = 0; k < rod.joints.size(); ++k)
    if (rod.joints[k].is_inextensible) energy += stored_energy(rod, at, k, 0, 3);
  return energy;
}

double kinetic_energy(const Rod& rod) {
  double energy = 0;
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    if (rod.segments[s].is_static) continue;
    energy += rod.segments[s].mass * rod.velocity[s].squaredNorm() / 2;
    energy += rod.angular_velocity[s].dot(spin_momentum(rod, s)) / 2;
  }
  return energy;
}

double gravitational_energy(const Rod& rod, const Vector3& gravity_m_s2) {
  double energy = 0;
  for (std::size_t s = 0; s < rod.segments.size(); ++s)
    if (!rod.segments[s].is_static) energy -= rod.segments[s].mass * gravity_m_s2.dot(rod.position[s]);
  return energy;
}

Vector3 linear_momentum(const Rod& rod) {
  Vector3 total = Vector3::Zero();
  for (std::size_t s = 0; s < rod.segments.size(); ++s)
    if (!rod.segments[s].is_static) total += rod.segments[s].mass * rod.velocity[s];
  return total;
}

Vector3 angular_momentum(const Rod& rod) {
  Vector3 total = Vector3::Zero();
  for (std::size_t s = 0; s < rod.segments.size(); ++s)
    if (!rod.segments[s].is_static)
      total += rod.segments[s].mass * rod.position[s].cross(rod.velocity[s]) + spin_momentum(rod, s);
  return total;
}

bool is_finite(const Rod& rod) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s)
    if (!rod.position[s].allFinite() || !rod.orientation[s].coeffs().allFinite()) return false;
  return true;
}

}  // namespace rodsweep
