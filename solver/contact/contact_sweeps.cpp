// The sweeps over active contacts of a ContactProjection: their matrix G, relaxations and acceleration.
#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/contact/contact_projection.hpp"

namespace rodsweep {

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

// Applies the last step's impulses to contacts that persist, unless the balance of momentum already includes them: on
// rods without joints Newton's iteration does not act.
void ContactProjection::press() {
  if (!std::exchange(fresh_, false)) return;
  for (Active& active : active_) {
    const Vector3 pressed = active.law.admissible(active.impulse);
    if (keeps_balance_)
      press_single(active);
    else
      active.impulse = active.settled = Vector3::Zero();
    change(active, pressed);
  }
  if (motion_.needs_settling()) settle();
}

void ContactProjection::press_single(const Active& active) {
  const Vector3 impulse = active.frame * active.impulse;
  const auto press = [this](const BodyPoint& on, int point, const Vector3& own, const Vector3& in_world) {
    if (!motion_.is_single(on.body)) return;
    push(point, own);
    motion_.push(on, in_world);
  };
  press(linear_[active.contact].a, active.a, active.impulse, impulse);
  press(linear_[active.contact].b, active.b, -active.impulse, -impulse);
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
  constexpr double worse = 1.5;  // limit of a sweep's motion, relative to the least since the last restart
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

}  // namespace rodsweep
