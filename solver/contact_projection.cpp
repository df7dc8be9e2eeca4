#include "solver/contact_projection.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "solver/rotation.hpp"

namespace rodsweep {
namespace {

void check_least(const char* what, double value, double least) {
  if (!(value >= least) || !std::isfinite(value))
    throw SceneError(std::string(what) + " is " + std::to_string(value) + "; must be at least " +
                     std::to_string(static_cast<int>(least)) + " and finite");
}

Vector3 across(const Vector3& v, const Vector3& normal) { return v - normal.dot(v) * normal; }

}  // namespace

ContactProjection::ContactProjection(Scene& scene, const ContactSettings& settings)
    : scene_(scene), settings_(settings), finder_(scene, settings.recovery) {
  check_least("friction", settings.friction, 0);
  check_least("tolerance", settings.tolerance, 0);
  check_least("sweeps", settings.sweeps, 1);
  check_least("recovery", settings.recovery, 0);
  motion_.assign(static_cast<std::size_t>(finder_.bodies().count()), {Vector3::Zero(), Vector3::Zero()});
}

void ContactProjection::start_step() {
  finder_.remember(scene_);
  old_.clear();
  for (const Rod& rod : scene_.rods)
    for (std::size_t s = 0; s < rod.segments.size(); ++s) old_.push_back({rod.position[s], rod.orientation[s]});
}

void ContactProjection::find() {
  finder_.find(scene_, contacts_);
  linear_.resize(contacts_.size());
  before_.resize(contacts_.size());
  swept_.assign(contacts_.size(), Vector3::Zero());
  momentum_ = 1;
}

bool ContactProjection::project(bool last) {
  if (contacts_.empty()) return true;
  linearise();
  for (std::size_t c = 0; c < contacts_.size(); ++c) before_[c] = contacts_[c].impulse;
  const double moved = sweep();
  if (moved < settings_.tolerance) {
    for (std::size_t c = 0; c < contacts_.size(); ++c) contacts_[c].impulse = before_[c];
    for (Motion& motion : motion_) motion = {Vector3::Zero(), Vector3::Zero()};
    return true;
  }
  for (int i = 1; i < settings_.sweeps; ++i) sweep();
  if (!last) accelerate();
  move();
  return false;
}

void ContactProjection::linearise() {
  const ContactBodies& bodies = finder_.bodies();
  bodies.place(scene_, axes_);
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    Linear& at = linear_[c];
    const Gap gap = finder_.follow(contact, axes_);
    at.gap = gap.width - contact.allowed;
    at.arm_a = gap.middle - axes_[static_cast<std::size_t>(contact.a)].centre;
    at.slip = slip(contact.a, gap.middle);
    at.size = bodies.body(contact.a).radius;
    if (contact.b >= 0) {
      at.arm_b = gap.middle - axes_[static_cast<std::size_t>(contact.b)].centre;
      at.slip -= slip(contact.b, gap.middle);
      at.size = std::min(at.size, bodies.body(contact.b).radius);
    }
    at.normal_weight = weight(contact, at, contact.normal);
  }
}

// Returns the largest motion that a contact asked for, relative to its segments' radius.
double ContactProjection::sweep() {
  double most = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    const Linear& at = linear_[c];
    const Vector3& n = contact.normal;
    const Vector3 moved = relative_motion(contact, at);
    const double had = n.dot(contact.impulse);
    const double normal = std::max(0.0, had - (at.gap + n.dot(moved)) / at.normal_weight);
    if (normal == 0 && contact.impulse.isZero()) continue;

    Vector3 impulse = normal * n;
    if (settings_.friction > 0 && normal > 0) {
      const Vector3 slip = across(at.slip + moved, n);
      Vector3 friction = across(contact.impulse, n);
      const double distance = slip.norm();
      if (distance > 0) friction -= slip / weight(contact, at, slip / distance);
      impulse += std::min(1.0, settings_.friction * normal / std::max(friction.norm(), 1e-300)) * friction;
    }
    const Vector3 change = impulse - contact.impulse;
    most = std::max(most, change.norm() * at.normal_weight / at.size);
    contact.impulse = impulse;
    push(contact, at, change);
  }
  return most;
}

// Onwards along the last way, unless the sweeps went back against it (adaptive restart, O'Donoghue & Candes 2015).
void ContactProjection::accelerate() {
  double against = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Vector3& now = contacts_[c].impulse;
    against += linear_[c].normal_weight * (before_[c] - now).dot(now - swept_[c]);
  }
  if (against > 0) momentum_ = 1;
  const double next = (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2, beta = (momentum_ - 1) / next;
  momentum_ = next;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    const Vector3 now = contact.impulse;
    contact.impulse = admissible(contact, now + beta * (now - swept_[c]));
    push(contact, linear_[c], contact.impulse - now);
    swept_[c] = now;
  }
}

void ContactProjection::move() {
  const ContactBodies& bodies = finder_.bodies();
  for (int i = 0; i < bodies.count(); ++i) {
    const Body& body = bodies.body(i);
    Motion& motion = motion_[static_cast<std::size_t>(i)];
    if (body.inverse_mass == 0 || (motion.shift.isZero(0) && motion.turn.isZero(0))) continue;
    Rod& rod = scene_.rods[static_cast<std::size_t>(body.rod)];
    const auto s = static_cast<std::size_t>(body.segment);
    rod.position[s] += motion.shift;
    rod.orientation[s] = rotated(rod.orientation[s], motion.turn);
    motion = {Vector3::Zero(), Vector3::Zero()};
  }
}

void ContactProjection::push(const Contact& contact, const Linear& at, const Vector3& impulse) {
  const ContactBodies& bodies = finder_.bodies();
  Motion& a = motion_[static_cast<std::size_t>(contact.a)];
  a.shift += bodies.body(contact.a).inverse_mass * impulse;
  a.turn += turn(contact.a, at.arm_a.cross(impulse));
  if (contact.b < 0) return;
  Motion& b = motion_[static_cast<std::size_t>(contact.b)];
  b.shift -= bodies.body(contact.b).inverse_mass * impulse;
  b.turn -= turn(contact.b, at.arm_b.cross(impulse));
}

Vector3 ContactProjection::relative_motion(const Contact& contact, const Linear& at) const {
  const Motion& a = motion_[static_cast<std::size_t>(contact.a)];
  Vector3 out = a.shift + a.turn.cross(at.arm_a);
  if (contact.b >= 0) {
    const Motion& b = motion_[static_cast<std::size_t>(contact.b)];
    out -= b.shift + b.turn.cross(at.arm_b);
  }
  return out;
}

double ContactProjection::weight(const Contact& contact, const Linear& at, const Vector3& direction) const {
  const auto of = [&](int body, const Vector3& arm) {
    const Vector3 moment = arm.cross(direction);
    return finder_.bodies().body(body).inverse_mass + moment.dot(turn(body, moment));
  };
  return of(contact.a, at.arm_a) + (contact.b >= 0 ? of(contact.b, at.arm_b) : 0);
}

// I^-1 m of an axisymmetric segment.
Vector3 ContactProjection::turn(int body, const Vector3& moment) const {
  const Body& of = finder_.bodies().body(body);
  if (of.inverse_mass == 0) return Vector3::Zero();
  const Vector3 axis = axes_[static_cast<std::size_t>(body)].half / of.half_length;
  return of.inverse_inertia_transverse * moment +
         (of.inverse_inertia_axial - of.inverse_inertia_transverse) * axis.dot(moment) * axis;
}

// How far the body's material at a point has come since the start of the step.
Vector3 ContactProjection::slip(int body, const Vector3& point) const {
  const Body& of = finder_.bodies().body(body);
  if (of.rod < 0) return Vector3::Zero();
  const Rod& rod = scene_.rods[static_cast<std::size_t>(of.rod)];
  const auto s = static_cast<std::size_t>(of.segment);
  const OldPose& old = old_[static_cast<std::size_t>(body)];
  const Vector3 arm = rod.orientation[s].conjugate() * (point - rod.position[s]);
  return point - (old.position + old.orientation * arm);
}

// The nearest in the friction cone along its axis: the normal part, and what friction it bears.
Vector3 ContactProjection::admissible(const Contact& contact, const Vector3& impulse) const {
  const double normal = contact.normal.dot(impulse);
  if (!(normal > 0)) return Vector3::Zero();
  const Vector3 friction = across(impulse, contact.normal);
  const double most = settings_.friction * normal, size = friction.norm();
  return normal * contact.normal + (size > most ? most / size : 1) * friction;
}

double ContactProjection::penetration() {
  finder_.bodies().place(scene_, axes_);
  double deepest = 0;
  for (const Contact& contact : contacts_) {
    Contact now = contact;
    double size = finder_.bodies().body(contact.a).radius;
    if (contact.b >= 0) size = std::min(size, finder_.bodies().body(contact.b).radius);
    deepest = std::max(deepest, -finder_.follow(now, axes_).width / size);
  }
  return deepest;
}

}  // namespace rodsweep
