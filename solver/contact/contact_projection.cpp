#include "solver/contact/contact_projection.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "solver/linear/interruption.hpp"
#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

constexpr double worse = 1.5;  ///< limit of a sweep's motion, relative to the least since the last restart

void check_least(const char* what, double value, double least) {
  if (!(value >= least) || !std::isfinite(value))
    throw SceneError(std::string(what) + " is " + std::to_string(value) + "; must be at least " +
                     std::to_string(static_cast<int>(least)) + " and finite");
}

}  // namespace

ContactProjection::ContactProjection(Scene& scene, const ContactSettings& settings, double unit_dt)
    : scene_(scene),
      settings_(settings),
      unit_dt_(unit_dt),
      finder_(scene, settings.recovery),
      motion_(scene, finder_.bodies()) {
  check_least("friction", settings.friction, 0);
  check_least("tolerance", settings.tolerance, 0);
  if (settings.tolerance == 0) throw SceneError("tolerance is 0; must be positive");
  check_least("sweeps", settings.sweeps, 1);
  check_least("recovery", settings.recovery, 0);
  if (settings.recovery > 1)
    throw SceneError("recovery is " + std::to_string(settings.recovery) + "; must be at most 1");
}

void ContactProjection::start_step(double end_s) {
  finder_.remember(scene_, end_s);
  last_ = contacts_;
  old_.clear();
  for (const Rod& rod : scene_.rods)
    for (std::size_t s = 0; s < rod.segments.size(); ++s) old_.push_back({rod.position[s], rod.orientation[s]});
}

bool ContactProjection::find(bool keeps_balance) {
  contacts_ = last_;  // an earlier attempt of this step may have changed them
  if (!finder_.find(scene_, contacts_)) return false;
  fresh_ = true;
  keeps_balance_ = keeps_balance;
  motion_.start_step(unit_dt_);
  last_.reserve(contacts_.capacity());
  linear_.resize(contacts_.size());
  before_.resize(contacts_.size());
  swept_.resize(contacts_.size());
  if (keeps_balance_) {
    linearise();
    tell_impulses();
  }
  return true;
}

const std::vector<char>& ContactProjection::impacts() {
  hit_.assign(scene_.rods.size(), 0);
  contacts_ = last_;
  if (!finder_.find(scene_, contacts_)) return hit_;
  finder_.place(scene_, axes_);
  const auto rod_of = [this](int body) { return body < 0 ? -1 : finder_.bodies().body(body).rod; };
  /// Whether this marks another rod.
  const auto mark = [this](int rod) { return rod >= 0 && !std::exchange(hit_[static_cast<std::size_t>(rod)], 1); };
  for (const Contact& contact : contacts_)
    if (contact.impulse.isZero(0) && finder_.closes(contact, axes_)) mark(rod_of(contact.a)), mark(rod_of(contact.b));
  for (bool again = true; again;) {
    again = false;
    for (const Contact& contact : contacts_) {
      const int a = rod_of(contact.a), b = rod_of(contact.b);
      if (a < 0 || b < 0 || hit_[static_cast<std::size_t>(a)] == hit_[static_cast<std::size_t>(b)]) continue;
      again |= mark(a) | mark(b);
    }
  }
  return hit_;
}

bool ContactProjection::project() {
  if (contacts_.empty()) return true;
  linearise();
  const bool pressed = press();
  restart(HUGE_VAL);
  for (int i = 0; i < settings_.sweeps; ++i) {
    const double moved = sweep();
    check_interrupted(static_cast<std::int64_t>(contacts_.size()) * 100);
    if (i == 0) swept_ = before_;
    const bool converged = moved < settings_.tolerance;
    if (converged && i == 0 && !pressed) {
      undo_sweep();
      return true;
    }
    const bool last = converged || i + 1 == settings_.sweeps;
    if (!last) accelerate(moved);
    motion_.settle();
    if (last) break;
  }
  motion_.apply(keeps_balance_);
  if (keeps_balance_) tell_impulses();
  return false;
}

// Applies the last step's impulses to contacts that persist, unless the balance of momentum already includes them.
// Returns whether anything moves.
bool ContactProjection::press() {
  if (!fresh_) return false;
  fresh_ = false;
  bool any = false;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    const Vector3 counted = keeps_balance_ ? contact.impulse : Vector3::Zero();
    contact.impulse = linear_[c].law.admissible(contact.impulse);
    const Vector3 change = contact.impulse - counted;
    if (change.isZero(0)) continue;
    push(contact, linear_[c], change);
    any = true;
  }
  motion_.settle();
  return any;
}

void ContactProjection::linearise() {
  finder_.place(scene_, axes_);
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    Linear& at = linear_[c];
    const Gap gap = finder_.follow(contact, axes_);
    const CapsuleAxis& a = axes_[static_cast<std::size_t>(contact.a)];
    at.width = gap.width;
    at.arm_a = gap.middle - a.centre;
    at.slip = slip(contact.a, gap.middle);
    at.size = finder_.bodies().smaller_radius(contact.a, contact.b);
    Matrix3 mobility = motion_.mobility(contact.a, at.arm_a, a);
    if (contact.b >= 0) {
      const CapsuleAxis& b = axes_[static_cast<std::size_t>(contact.b)];
      at.arm_b = gap.middle - b.centre;
      at.slip -= slip(contact.b, gap.middle);
      mobility += motion_.mobility(contact.b, at.arm_b, b);
    } else {
      at.slip -= finder_.motion(contact.b);
    }
    at.law = CoulombContact(contact.normal, mobility, settings_.friction);
  }
}

// Returns the largest motion of a contact's correction, relative to the smaller radius.
double ContactProjection::sweep() {
  double most = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    const Linear& at = linear_[c];
    before_[c] = contact.impulse;
    Vector3 moved = motion_.of(contact.a, at.arm_a);
    if (contact.b >= 0) moved -= motion_.of(contact.b, at.arm_b);
    const double gap = at.width - contact.allowed + contact.normal.dot(moved);
    const Vector3 impulse = at.law.relaxed(contact.impulse, gap, at.slip + moved);
    const Vector3 change = impulse - contact.impulse;
    if (change.isZero(0)) continue;
    most = std::max(most, change.norm() * at.law.normal_weight() / at.size);
    contact.impulse = impulse;
    push(contact, at, change);
  }
  return most;
}

// Reverts the last sweep, which must not have settled.
void ContactProjection::undo_sweep() {
  for (std::size_t c = 0; c < contacts_.size(); ++c) contacts_[c].impulse = before_[c];
  motion_.clear();
}

void ContactProjection::restart(double moved) {
  momentum_ = 1;
  least_moved_ = moved;
}

// Extrapolates the last change. Restarts if the sweep went against it (adaptive restart, O'Donoghue & Candes 2015) or
// if the motion grows: friction is not a gradient, so an accelerated iteration may cycle.
void ContactProjection::accelerate(double moved) {
  double against = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Vector3& now = contacts_[c].impulse;
    against += linear_[c].law.normal_weight() * (before_[c] - now).dot(now - swept_[c]);
  }
  if (against > 0 || moved > worse * least_moved_) restart(moved);
  least_moved_ = std::min(least_moved_, moved);
  const double next = (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2, beta = (momentum_ - 1) / next;
  momentum_ = next;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    const Vector3 now = contact.impulse;
    contact.impulse = linear_[c].law.admissible(now + beta * (now - swept_[c]));
    push(contact, linear_[c], contact.impulse - now);
    swept_[c] = now;
  }
}

void ContactProjection::push(const Contact& contact, const Linear& at, const Vector3& impulse) {
  motion_.push(contact.a, at.arm_a, impulse, axes_[static_cast<std::size_t>(contact.a)]);
  if (contact.b >= 0) motion_.push(contact.b, at.arm_b, -impulse, axes_[static_cast<std::size_t>(contact.b)]);
}

// The motion of the body's material at a point since the start of the step.
Vector3 ContactProjection::slip(int body, const Vector3& point) const {
  const Body& of = finder_.bodies().body(body);
  if (of.rod < 0) return finder_.motion(body);
  const Rod& rod = scene_.rods[static_cast<std::size_t>(of.rod)];
  const auto s = static_cast<std::size_t>(of.segment);
  const OldPose& old = old_[static_cast<std::size_t>(body)];
  const Vector3 arm = rod.orientation[s].conjugate() * (point - rod.position[s]);
  return point - (old.position + old.orientation * arm);
}

// Sets the rods' contact impulses, at the last linearisation.
void ContactProjection::tell_impulses() {
  for (Rod& rod : scene_.rods) rod.contact_impulse.assign(rod.segments.size(), Vector6::Zero());
  const auto tell = [this](int body, const Vector3& arm, const Vector3& impulse) {
    const Body& of = finder_.bodies().body(body);
    if (!of.is_free) return;
    Vector6& on = scene_.rods[static_cast<std::size_t>(of.rod)].contact_impulse[static_cast<std::size_t>(of.segment)];
    const double share = motion_.share(of.rod);
    on.head<3>() += share * impulse;
    on.tail<3>() += share * arm.cross(impulse);
  };
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Contact& contact = contacts_[c];
    tell(contact.a, linear_[c].arm_a, contact.impulse);
    if (contact.b >= 0) tell(contact.b, linear_[c].arm_b, -contact.impulse);
  }
}

ContactState ContactProjection::state() {
  ContactState state;
  if (contacts_.empty()) {
    if (!keeps_balance_) tell_impulses();
    return state;
  }
  linearise();
  if (!keeps_balance_) tell_impulses();  // else they stay as they acted, though contacts moved since
  for (const Linear& at : linear_) state.penetration = std::max(state.penetration, -at.width / at.size);
  state.residual = sweep();
  undo_sweep();
  return state;
}

}  // namespace rodsweep
