#include "solver/contact/contact_projection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/contact/rebound.hpp"
#include "solver/linear/interruption.hpp"

namespace rodsweep {
namespace {

constexpr double accurate = 0.3;  ///< of the tolerance, which the next linearisation has to meet

}  // namespace

ContactProjection::ContactProjection(Scene& scene, const ContactSettings& settings, double unit_dt, bool two_steps)
    : scene_(scene),
      settings_(settings),
      tolerance_(settings.tolerance.value()),
      unit_dt_(unit_dt),
      two_steps_(two_steps),
      finder_(scene, settings, two_steps),
      motion_(scene, finder_.bodies()) {
  const auto check_friction = [](const char* quantity, double value) {
    require(value >= 0 && std::isfinite(value), quantity, value, "at least 0 and finite");
  };
  check_friction("friction", settings.friction);
  check_friction("obstacle_friction", settings.obstacle_friction.value_or(0));
  require(settings.sweeps >= 1, "sweeps", settings.sweeps, "at least 1");
  require(tolerance_ > 0 && std::isfinite(tolerance_), "tolerance", tolerance_, "positive");
  require(settings.recovery >= 0 && settings.recovery <= 1, "recovery", settings.recovery, "from 0 to 1");
  require(settings.restitution >= 0 && settings.restitution <= 1, "restitution", settings.restitution, "from 0 to 1");
}

void ContactProjection::start_step(double end_s) {
  finder_.remember(scene_, end_s);
  last_ = contacts_;
}

bool ContactProjection::find(bool keeps_balance) {
  contacts_ = last_;  // an earlier attempt of this step may have changed them
  if (!finder_.find(scene_, contacts_)) return false;
  fresh_ = true;
  keeps_balance_ = keeps_balance;
  motion_.start_step(unit_dt_);
  last_.reserve(contacts_.capacity());
  linear_.resize(contacts_.size());
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
  const auto mark = [this](int rod) { return rod >= 0 && !std::exchange(hit_[at(rod)], 1); };
  for (const Contact& contact : contacts_)
    if (contact.impulse.isZero(0) && finder_.closes(contact, axes_)) mark(rod_of(contact.a)), mark(rod_of(contact.b));
  for (bool again = true; again;) {
    again = false;
    for (const Contact& contact : contacts_) {
      const int a = rod_of(contact.a), b = rod_of(contact.b);
      if (a < 0 || b < 0 || hit_[at(a)] == hit_[at(b)]) continue;
      again |= mark(a) | mark(b);
    }
  }
  return hit_;
}

bool ContactProjection::project() {
  if (contacts_.empty()) return true;
  linearise();
  const bool presses = fresh_ && std::any_of(contacts_.begin(), contacts_.end(),
                                             [](const Contact& contact) { return !contact.impulse.isZero(0); });
  if (residual() < tolerance_ && !presses) return true;
  motion_.respond();
  active_.clear();
  activate();
  press();
  int sweeps = 0;
  for (bool more = true; more;) {
    restart(HUGE_VAL);
    bool converged = false;
    while (!converged && sweeps < settings_.sweeps) {
      const double moved = sweep();
      ++sweeps;
      check_interrupted(static_cast<std::int64_t>(active_.size()) * 200);
      converged = moved < (motion_.needs_settling() ? 1 : accurate) * tolerance_;
      if (!converged && sweeps < settings_.sweeps) accelerate(moved);
      if (!converged && motion_.needs_settling()) settle();
    }
    settle();
    more = converged && activate();
  }
  for (const Active& active : active_) contacts_[active.contact].impulse = active.frame * active.impulse;
  motion_.apply(keeps_balance_);
  if (keeps_balance_) tell_impulses();
  return false;
}

void ContactProjection::linearise() {
  finder_.place(scene_, axes_);
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    Linear& linear = linear_[c];
    const bool is_set = contact.impact.happens && !fresh_;
    Contact followed = contact;
    const Gap gap = finder_.follow(followed, axes_);
    linear.width = gap.width;
    if (!is_set) {
      contact.normal = followed.normal;
      linear.a = {contact.a, gap.on_a - axes_[at(contact.a)].centre};
      linear.b = {contact.b, contact.b < 0 ? gap.on_b : gap.on_b - axes_[at(contact.b)].centre};
    }
    linear.size = finder_.bodies().smaller_radius(contact.a, contact.b);
    linear.is_active = false;
    if (contact.impact.possible && fresh_) {
      contact.impact.meeting = -contact.normal.dot(slip(linear));
      contact.impact.limit = HUGE_VAL;
    }
    linear.gap = contact.impact.happens ? separation_short_of_rebound(c) : gap.width - contact.allowed;
  }
}

// An impulse's work is its product with the mean of the velocities before and after the impact, at the same points and
// along the same normal, so these stay as they are first linearised. The work must not be positive. Newton's e may give
// energy if the impulse also moves the surfaces across (Kane 1984), so friction's work limits the rebound. What joints
// take of a rod's vibration in the step cannot rebound either.
double ContactProjection::separation_short_of_rebound(std::size_t c) {
  Contact& contact = contacts_[c];
  const Linear& at = linear_[c];
  const Vector3 after = slip(at), before = slip(at, &ContactMotion::velocity_before);
  const auto apart = [&, approach = -contact.normal.dot(before)](double e) {
    return std::min(rebound(e, approach, contact.impact.gap, contact.impact.acceleration, two_steps_),
                    e * std::max(0.0, contact.impact.meeting));
  };
  double& target = contact.impact.limit;
  target = std::min(target, apart(settings_.restitution));
  if (const double pressed = contact.normal.dot(contact.impulse); pressed > 0) {
    const Vector3 across = contact.impulse - pressed * contact.normal;
    target = std::clamp(apart(1) - across.dot(after + before) / pressed, 0.0, target);
  }
  return contact.normal.dot(after) - target;
}

// h times the velocity of a's surface against b's, at the end of the step or before it; the smaller h of two rods, which
// converges.
Vector3 ContactProjection::slip(const Linear& at, Velocity velocity) const {
  double h = HUGE_VAL;
  const auto of = [&](const BodyPoint& point) -> Vector3 {
    if (finder_.is_obstacle(point.body)) return finder_.velocity(point.body);
    h = std::min(h, motion_.h(point.body));
    return (motion_.*velocity)(point);
  };
  const Vector3 apart = of(at.a) - of(at.b);
  return h * apart;
}

double ContactProjection::friction(const Contact& contact) const {
  const bool with_obstacle = contact.b < 0 || finder_.bodies().body(contact.b).rod < 0;
  return with_obstacle ? settings_.obstacle_friction.value_or(settings_.friction) : settings_.friction;
}

// The largest motion of a contact's correction by a sweep over free segments, relative to the smaller radius.
double ContactProjection::residual() {
  motion_.measure(axes_);
  double most = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Contact& contact = contacts_[c];
    const Linear& at = linear_[c];
    const Vector3 moved = motion_.of(at.a) - motion_.of(at.b);
    const double gap = at.gap + contact.normal.dot(moved);
    if (gap >= 0 && contact.impulse.isZero(0)) continue;
    const Matrix3 frame = contact_frame(contact.normal);
    const CoulombContact law(frame.transpose() * motion_.mobility(at.a, at.b) * frame, friction(contact));
    const Vector3 impulse = frame.transpose() * contact.impulse;
    Vector3 remains = frame.transpose() * (slip(at) + moved);
    remains.x() = gap;
    const Vector3 change = law.relaxed(impulse, remains) - impulse;
    if (change.isZero(0)) continue;
    most = std::max(most, change.norm() * law.normal_weight() / at.size);
    motion_.push(at.a, frame * change);
    motion_.push(at.b, frame * -change);
  }
  motion_.clear();
  return most;
}

// Adds the contacts that carry an impulse or would overlap with the motions so far. Returns whether there are any new.
bool ContactProjection::activate() {
  const std::size_t before = active_.size();
  const double overlap = before == 0 ? 0 : accurate * tolerance_;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    Contact& contact = contacts_[c];
    Linear& at = linear_[c];
    if (at.is_active) continue;
    const double gap = at.gap + contact.normal.dot(motion_.of(at.a) - motion_.of(at.b));
    if (contact.impulse.isZero(0) && gap >= -overlap * at.size) continue;
    at.is_active = true;
    if (contact.impact.possible && !std::exchange(contact.impact.happens, true))
      at.gap = separation_short_of_rebound(c);
    const Matrix3 frame = contact_frame(contact.normal);
    const Vector3 impulse = frame.transpose() * contact.impulse;
    Vector3 start = frame.transpose() * slip(at);
    start.x() = at.gap;
    active_.push_back({c, frame, {}, at.size, start, impulse, impulse, impulse, impulse, -1, -1});
    motion_.touch(at.a.body);
    motion_.touch(at.b.body);
  }
  if (active_.size() == before) return false;
  motion_.update();
  couple();
  find_motions();
  return true;
}

// Sets the rods' contact impulses, at the last linearisation.
void ContactProjection::tell_impulses() {
  for (Rod& rod : scene_.rods) rod.contact_impulse.assign(rod.segments.size(), Vector6::Zero());
  const auto tell = [this](int body, const Vector3& arm, const Vector3& impulse) {
    const Body& of = finder_.bodies().body(body);
    if (!of.is_free) return;
    Vector6& on = scene_.rods[at(of.rod)].contact_impulse[at(of.segment)];
    const double share = motion_.share(of.rod);
    on.head<3>() += share * impulse;
    const Vector3 moment = share * arm.cross(impulse);
    on.tail<3>() += keeps_balance_ ? motion_.turning(body, moment) : moment;
  };
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Contact& contact = contacts_[c];
    if (contact.impulse.isZero(0)) continue;
    tell(contact.a, linear_[c].a.arm, contact.impulse);
    if (contact.b >= 0) tell(contact.b, linear_[c].b.arm, -contact.impulse);
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
  state.residual = residual();
  return state;
}

void ContactProjection::add_actions(Action& of_obstacles, Action& of_clamps) const {
  const ContactBodies& bodies = finder_.bodies();
  const auto is_free = [&](int body) { return body >= 0 && bodies.body(body).is_free; };
  const auto add = [&](const BodyPoint& on, int by, const Vector3& impulse) {
    if (!is_free(on.body) || is_free(by)) return;
    (finder_.is_obstacle(by) ? of_obstacles : of_clamps)
        .add(axes_[at(on.body)].centre + on.arm, impulse / (unit_dt_ * unit_dt_));
  };
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Contact& contact = contacts_[c];
    if (contact.impulse.isZero(0)) continue;
    add(linear_[c].a, contact.b, contact.impulse);
    add(linear_[c].b, contact.a, -contact.impulse);
  }
}

}  // namespace rodsweep
