#include "solver/contact/contact_projection.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "solver/contact/rebound.hpp"
#include "solver/linear/interruption.hpp"
#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

constexpr double worse = 1.5;     ///< limit of a sweep's motion, relative to the least since the last restart
constexpr double accurate = 0.3;  ///< of the tolerance, which the next linearisation has to meet

void check_least(const char* what, double value, double least) {
  if (!(value >= least) || !std::isfinite(value))
    throw SceneError(std::string(what) + " is " + std::to_string(value) + "; must be at least " +
                     std::to_string(static_cast<int>(least)) + " and finite");
}

void check_most(const char* what, double value, double most) {
  if (value > most)
    throw SceneError(std::string(what) + " is " + std::to_string(value) + "; must be at most " +
                     std::to_string(static_cast<int>(most)));
}

}  // namespace

ContactProjection::ContactProjection(Scene& scene, const ContactSettings& settings, double unit_dt, bool two_steps)
    : scene_(scene),
      settings_(settings),
      unit_dt_(unit_dt),
      two_steps_(two_steps),
      finder_(scene, settings, two_steps),
      motion_(scene, finder_.bodies()) {
  check_least("friction", settings.friction, 0);
  check_least("obstacle_friction", settings.obstacle_friction.value_or(0), 0);
  check_least("tolerance", settings.tolerance, 0);
  if (settings.tolerance == 0) throw SceneError("tolerance is 0; must be positive");
  check_least("sweeps", settings.sweeps, 1);
  check_least("recovery", settings.recovery, 0);
  check_least("restitution", settings.restitution, 0);
  check_most("recovery", settings.recovery, 1);
  check_most("restitution", settings.restitution, 1);
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
  if (residual() < settings_.tolerance && !presses) return true;
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
      converged = moved < (motion_.needs_settling() ? 1 : accurate) * settings_.tolerance;
      if (!converged && sweeps < settings_.sweeps) accelerate(moved);
      if (!converged && motion_.needs_settling()) settle();
    }
    settle();
    more = converged && activate();
  }
  keep_impulses();
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
    if (contact.impact.happens && fresh_) {
      contact.impact.meeting = -contact.normal.dot(slip(c));
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
  const Vector3 after = slip(c), before = shared_h(at) * (velocity_before(at.a) - velocity_before(at.b));
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

// h times the velocity of a's surface against b's; the smaller h of two rods, which converges.
Vector3 ContactProjection::slip(std::size_t c) const {
  const Linear& at = linear_[c];
  return shared_h(at) * (velocity(at.a) - velocity(at.b));
}

double ContactProjection::shared_h(const Linear& at) const {
  double h = HUGE_VAL;
  for (const int body : {at.a.body, at.b.body})
    if (!finder_.is_obstacle(body)) h = std::min(h, motion_.h(body));
  return h;
}

Vector3 ContactProjection::velocity(const BodyPoint& at) const {
  return finder_.is_obstacle(at.body) ? finder_.velocity(at.body) : motion_.velocity(at);
}

Vector3 ContactProjection::velocity_before(const BodyPoint& at) const {
  return finder_.is_obstacle(at.body) ? finder_.velocity(at.body) : motion_.velocity_before(at);
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
    Vector3 remains = frame.transpose() * (slip(c) + moved);
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
  const double overlap = before == 0 ? 0 : accurate * settings_.tolerance;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const Contact& contact = contacts_[c];
    Linear& at = linear_[c];
    if (at.is_active) continue;
    const double gap = at.gap + contact.normal.dot(motion_.of(at.a) - motion_.of(at.b));
    if (contact.impulse.isZero(0) && gap >= -overlap * at.size) continue;
    at.is_active = true;
    const Matrix3 frame = contact_frame(contact.normal);
    const Vector3 impulse = frame.transpose() * contact.impulse;
    Vector3 start = frame.transpose() * slip(c);
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

// Gives every point of an active contact its place in the motions of its group and in G.
void ContactProjection::place_points() {
  points_.clear();
  by_group_.clear();
  const auto add = [this](const BodyPoint& at, std::size_t active) {
    const int group = motion_.group(at.body);
    if (group < 0) return -1;
    by_group_.push_back(static_cast<int>(points_.size()));
    points_.push_back({&at, active, group, 0, 0, 0, 0});
    return by_group_.back();
  };
  for (std::size_t i = 0; i < active_.size(); ++i) {
    active_[i].a = add(linear_[active_[i].contact].a, i);
    active_[i].b = add(linear_[active_[i].contact].b, i);
  }
  std::sort(by_group_.begin(), by_group_.end(),
            [this](int p, int q) { return std::pair(point(p).group, p) < std::pair(point(q).group, q); });
  std::size_t motions = 0, entries = 0;
  for (std::size_t first = 0, last = 0; first < by_group_.size(); first = last) {
    while (last < by_group_.size() && point(by_group_[last]).group == point(by_group_[first]).group) ++last;
    const std::size_t rows = (3 * (last - first) + 7) / 8 * 8;
    for (std::size_t i = first; i < last; ++i) {
      Point& of = point(by_group_[i]);
      of.begin = motions;
      of.rows = rows;
      of.motion = 3 * (i - first);
      of.column = entries + of.motion * rows;
    }
    entries += 3 * (last - first) * rows;
    motions += rows;
  }
  motions_.assign(motions / 8, Lane8{});
  coupling_.assign(entries / 8, Lane8{});
}

// Finds G, which is symmetric, and with it the laws of the contacts.
void ContactProjection::couple() {
  place_points();
  double* const g = reinterpret_cast<double*>(coupling_.data());
  for (std::size_t i = 0; i < by_group_.size(); ++i) {
    const Point& by = point(by_group_[i]);
    for (std::size_t j = i; j < by_group_.size() && point(by_group_[j]).group == by.group; ++j) {
      const Point& of = point(by_group_[j]);
      const Matrix3 motion =
          active_[of.active].frame.transpose() * motion_.coupling(*of.place, *by.place) * active_[by.active].frame;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) g[by.entry(of, r, c)] = g[of.entry(by, c, r)] = motion(r, c);
    }
  }
  const auto block = [&](int of, int by) {
    Matrix3 out = Matrix3::Zero();
    if (of < 0 || by < 0 || point(of).group != point(by).group) return out;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) out(r, c) = g[point(by).entry(point(of), r, c)];
    return out;
  };
  for (Active& active : active_) {
    const Matrix3 cross = block(active.a, active.b);
    const Matrix3 mobility = block(active.a, active.a) + block(active.b, active.b) - cross - cross.transpose();
    active.law = CoulombContact(mobility, friction(contacts_[active.contact]));
  }
}

// Applies the last step's impulses to contacts that persist, unless the balance of momentum already includes them.
void ContactProjection::press() {
  if (!std::exchange(fresh_, false)) return;
  for (Active& active : active_) {
    const Vector3 pressed = active.law.admissible(active.impulse);
    if (!keeps_balance_) active.impulse = active.settled = Vector3::Zero();
    change(active, pressed);
  }
  if (motion_.needs_settling()) settle();
}

void ContactProjection::change(Active& active, const Vector3& impulse) {
  push(active.a, impulse - active.impulse);
  push(active.b, active.impulse - impulse);
  active.impulse = impulse;
}

void ContactProjection::push(int at, const Vector3& impulse) {
  if (at < 0) return;
  const Point& by = point(at);
  const std::size_t rows = by.rows / 8;
  const Lane8* const g = coupling_.data() + by.column / 8;
  Lane8* const motions = motions_.data() + by.begin / 8;
  for (std::size_t r = 0; r < rows; ++r)
    motions[r] += g[r] * impulse.x() + g[rows + r] * impulse.y() + g[2 * rows + r] * impulse.z();
}

/// v of a contact, in its frame.
Vector3 ContactProjection::motion(const Active& active) const {
  const double* const motions = reinterpret_cast<const double*>(motions_.data());
  const auto of = [&](int at) -> Vector3 {
    if (at < 0) return Vector3::Zero();
    return Eigen::Map<const Vector3>(motions + point(at).begin + point(at).motion);
  };
  return of(active.a) - of(active.b);
}

// Returns the largest motion of a contact's correction on the way from the first to the last, relative to the smaller
// radius.
double ContactProjection::sweep() {
  for (Active& active : active_) active.before = active.impulse;
  double most = 0;
  for (Active& active : active_) most = std::max(most, relax(active));
  if (motion_.couples_segments())
    for (std::size_t i = active_.size(); i-- > 0;) relax(active_[i]);
  return most;
}

double ContactProjection::relax(Active& active) {
  const Vector3 remains = active.start + motion(active);
  if (remains.x() >= 0 && active.impulse.isZero(0)) return 0;
  const Vector3 impulse = active.law.relaxed(active.impulse, remains), by = impulse - active.impulse;
  if (by.isZero(0)) return 0;
  change(active, impulse);
  return active.law.motion(by) / active.size;
}

void ContactProjection::settle() {
  for (Active& active : active_) {
    const Vector3 by = active.impulse - active.settled;
    active.settled += by;
    if (by.isZero(0)) continue;
    motion_.push(linear_[active.contact].a, active.frame * by);
    motion_.push(linear_[active.contact].b, active.frame * -by);
  }
  motion_.settle();
  find_motions();
}

void ContactProjection::keep_impulses() {
  for (const Active& active : active_) contacts_[active.contact].impulse = active.frame * active.impulse;
}

void ContactProjection::find_motions() {
  double* const motions = reinterpret_cast<double*>(motions_.data());
  for (const Point& point : points_)
    Eigen::Map<Vector3>(motions + point.begin + point.motion) =
        active_[point.active].frame.transpose() * motion_.of(*point.place);
}

void ContactProjection::restart(double moved) {
  momentum_ = 1;
  least_moved_ = moved;
}

// Extrapolates the last change. Restarts if the sweep went against it (adaptive restart, O'Donoghue & Candes 2015) or
// if the motion grows: friction is not a gradient, so an accelerated iteration may cycle.
void ContactProjection::accelerate(double moved) {
  if (momentum_ == 1)
    for (Active& active : active_) active.swept = active.before;
  double against = 0;
  for (const Active& active : active_) {
    const Vector3& now = active.impulse;
    against += active.law.normal_weight() * (active.before - now).dot(now - active.swept);
  }
  if (against > 0 || moved > worse * least_moved_) restart(moved);
  least_moved_ = std::min(least_moved_, moved);
  const double next = (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2, beta = (momentum_ - 1) / next;
  momentum_ = next;
  for (Active& active : active_) {
    const Vector3 now = active.impulse;
    change(active, active.law.admissible(now + beta * (now - active.swept)));
    active.swept = now;
  }
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

}  // namespace rodsweep
