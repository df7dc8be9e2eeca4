#include "solver/contact/contact.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "solver/contact/rebound.hpp"

namespace rodsweep {
namespace {

constexpr double reach = 1.2;            ///< contacts begin at this many radii from the axis, plus the motion
constexpr double most_recovered = 0.01;  ///< limit per step of a penetration's correction, of the smaller radius
constexpr double least_impact = 0.01;    ///< approach in a step, of the smaller radius
constexpr double catching = 0.3;         ///< cosine of the angle at which the next segment must approach
constexpr double side_by_side = 0.1;     ///< of R: limit of the distance's change along the overlap

std::vector<double> margins(const ContactBodies& bodies) {
  std::vector<double> out;
  for (int i = 0; i < bodies.count(); ++i) out.push_back(bodies.body(i).radius / 2);
  return out;
}

Box swept_box(const CapsuleAxis& from, const CapsuleAxis& to, double beyond) {
  Box box{from.at(1), from.at(1)};
  box.extend(from.at(-1)).extend(to.at(1)).extend(to.at(-1));
  return grown(box, beyond);
}

bool is_finite(const CapsuleAxis& axis) { return axis.centre.allFinite() && axis.half.allFinite(); }

/// The unit vector from b to a. If the axes meet, any that is at right angles to both.
Vector3 direction(const Vector3& separation, const CapsuleAxis& a, const CapsuleAxis& b, double scale) {
  const double distance = separation.norm();
  if (distance > 1e-9 * scale) return separation / distance;
  const Vector3 across = a.half.cross(b.half);
  if (across.norm() > 1e-9 * scale * scale) return across.normalized();
  return (a.half.isZero() ? b.half : a.half).unitOrthogonal();
}

}  // namespace

ContactFinder::ContactFinder(const Scene& scene, const ContactSettings& settings, bool two_steps)
    : bodies_(scene),
      broad_phase_(margins(bodies_), [this](int a, int b) { return bodies_.matter(a, b); }),
      recovery_(settings.recovery),
      restitution_(settings.restitution),
      two_steps_(two_steps) {
  for (const Obstacle& obstacle : scene.obstacles)
    if (const auto* half_space = std::get_if<HalfSpace>(&obstacle)) {
      if (!half_space->point_m.allFinite() || !(half_space->normal.norm() > 0) || !half_space->normal.allFinite())
        throw SceneError("an obstacle's half-space needs a finite point and normal; the normal must not be zero");
      if (!half_space->velocity_m_s.allFinite()) throw SceneError("an obstacle's velocity is not finite");
      planes_.push_back({half_space->point_m, half_space->normal.normalized(), half_space->velocity_m_s});
    }
}

bool ContactFinder::find(const Scene& scene, std::vector<Contact>& contacts) {
  place(scene, free_);
  if (!std::all_of(free_.begin(), free_.end(), is_finite)) {
    contacts.clear();
    return false;
  }
  boxes_.resize(free_.size());
  reach_.resize(free_.size());
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const double radius = bodies_.body(static_cast<int>(i)).radius;
    const double motion = (free_[i].centre - start_[i].centre).norm() + (free_[i].half - start_[i].half).norm();
    reach_[i] = reach * radius + std::min(motion, 2 * radius);
    boxes_[i] = swept_box(start_[i], free_[i], reach_[i]);
  }

  found_.clear();
  auto last = contacts.begin();
  const std::vector<Pair>& pairs = broad_phase_.pairs(boxes_);
  auto pair = pairs.begin();
  for (int a = 0; a < bodies_.count(); ++a) {
    if (bodies_.body(a).is_free)
      for (int plane = static_cast<int>(planes_.size()) - 1; plane >= 0; --plane) find_below(a, plane);
    for (; pair != pairs.end() && pair->a == a; ++pair) {
      while (last != contacts.end() && std::pair(last->a, last->b) < std::pair(a, pair->b)) ++last;
      const bool touched = last != contacts.end() && last->a == a && last->b == pair->b;
      find_pair(a, pair->b, touched ? &last->normal : nullptr);
    }
  }
  keep_impulses(contacts);
  if (restitution_ > 0) let_rebound(scene);
  std::swap(found_, contacts);
  found_.reserve(contacts.capacity());  // both lists have room, so that a later step need not allocate
  return true;
}

void ContactFinder::keep_impulses(const std::vector<Contact>& last) {
  const auto key = [](const Contact& contact) { return std::tuple(contact.a, contact.b, contact.place); };
  auto was = last.begin();
  for (Contact& contact : found_) {
    while (was != last.end() && key(*was) < key(contact)) ++was;
    if (was != last.end() && key(*was) == key(contact)) contact.impulse = was->impulse;
  }
}

void ContactFinder::let_rebound(const Scene& scene) {
  bodies_.coast(scene, start_, end_s_, end_s_ - start_s_, coasting_);
  for (Contact& contact : found_) {
    if (!contact.impulse.isZero(0)) continue;
    Contact at_start = contact, coasting = contact, free = contact;
    const double end = follow(free, free_, end_s_).width;
    const double start = follow(at_start, start_, start_s_).width;
    const double coasted = follow(coasting, coasting_, end_s_).width;
    Impact& impact = contact.impact;
    impact.gap = std::max(0.0, start);
    impact.acceleration = coasted - end;
    impact.possible = end < start - coasted + impact.acceleration &&
                      rebound(restitution_, start - coasted, impact.gap, impact.acceleration, two_steps_) > 0;
  }
}

void ContactFinder::find_pair(int a, int b, const Vector3* side) {
  const auto ia = at(a), ib = at(b);
  const double contact_distance = bodies_.body(a).radius + bodies_.body(b).radius;
  const CapsuleAxis &a_start = start_[ia], &b_start = start_[ib], &a_free = free_[ia], &b_free = free_[ib];
  const double motion = relative_motion(a_start, a_free, b_start, b_free);
  const Vector3 ends = separation(a_free, b_free);
  const double at_end = ends.norm();
  const double near = reach_[ia] + reach_[ib];
  if (at_end - motion > near) return;
  const Vector3 starts = separation(a_start, b_start);
  const double at_start = starts.norm();
  if (at_start + at_end - motion > 2 * near) return;

  double when = 1;
  Vector3 normal = direction(ends, a_free, b_free, contact_distance);
  const bool crossed = side && at_start < contact_distance && side->dot(starts) < 0;
  if (crossed) {
    normal = *side;
  } else if (motion >= at_start) {
    if (const auto time = first_touch(a_start, a_free, b_start, b_free, std::min(contact_distance, at_start))) {
      const CapsuleAxis a_then = between(a_start, a_free, *time), b_then = between(b_start, b_free, *time);
      normal = direction(separation(a_then, b_then), a_then, b_then, contact_distance);
      when = *time;
    }
  }
  const Overlap beside = overlap(a_free, b_free);
  const double length = (beside.high - beside.low) * a_free.half.norm();
  const double slope = a_free.half.cross(b_free.half).norm();
  if (beside.low < beside.high && length > contact_distance / 5 &&
      length * slope < side_by_side * contact_distance * a_free.half.norm() * b_free.half.norm()) {
    add({a, b, AxisPlace::low, beside.low, normal}, crossed);
    add({a, b, AxisPlace::high, beside.high, normal}, crossed);
  } else {
    const AxisPoints at = closest_points(between(a_start, a_free, when), between(b_start, b_free, when));
    if (!crossed && (nearer_beyond(a, b, at.s, normal, when) || nearer_beyond(b, a, at.t, -normal, when))) return;
    add({a, b, AxisPlace::closest, 0, normal}, crossed);
  }
}

bool ContactFinder::nearer_beyond(int body, int other, double s, const Vector3& away, double time) const {
  if (std::abs(s) < 1) return false;
  for (const ContactBodies::Next& next : bodies_.next(body)) {
    const auto i = at(next.body);
    if (!bodies_.matter(std::min(next.body, other), std::max(next.body, other))) continue;
    if (next.end * s > 0 && next.into * away.dot(between(start_[i], free_[i], time).half.normalized()) < -catching)
      return true;
  }
  return false;
}

void ContactFinder::find_below(int a, int half_space) {
  const Plane& plane = planes_[at(half_space)];
  const auto ia = at(a);
  for (const auto place : {AxisPlace::low, AxisPlace::high}) {
    const double s = place == AxisPlace::low ? -1 : 1;
    const double height = std::min(plane.height(start_[ia].at(s), start_s_), plane.height(free_[ia].at(s), end_s_));
    if (height < reach_[ia]) add({a, -1 - half_space, place, s, plane.normal}, true);
  }
}

void ContactFinder::add(Contact contact, bool sided) {
  Contact at_start = contact;
  if (!sided) at_start.normal.setZero();  // there is no wrong side: only the distance counts
  const double width = std::min(0.0, follow(at_start, start_, start_s_).width);
  contact.allowed =
      std::min((1 - recovery_) * width, width + most_recovered * bodies_.smaller_radius(contact.a, contact.b));
  found_.push_back(contact);
}

bool ContactFinder::closes(Contact contact, const std::vector<CapsuleAxis>& axes) const {
  const double end = follow(contact, axes, end_s_).width;
  if (end >= 0) return false;
  const double nearer = follow(contact, start_, start_s_).width - end;
  return nearer > (restitution_ > 0 ? 0 : least_impact * bodies_.smaller_radius(contact.a, contact.b));
}

const Vector3& ContactFinder::velocity(int obstacle) const {
  return obstacle < 0 ? planes_[at(-1 - obstacle)].velocity : bodies_.velocity(obstacle);
}

Gap ContactFinder::follow(Contact& contact, const std::vector<CapsuleAxis>& axes, double time_s) const {
  const CapsuleAxis& a = axes[at(contact.a)];
  const double radius = bodies_.body(contact.a).radius;
  if (contact.b < 0) {
    const Plane& plane = planes_[at(-1 - contact.b)];
    const Vector3 end = a.at(contact.s);
    const double width = plane.height(end, time_s) - radius;
    const Vector3 surface = end - radius * plane.normal;
    return {width, surface, surface - width * plane.normal};
  }
  const CapsuleAxis& b = axes[at(contact.b)];
  const double other_radius = bodies_.body(contact.b).radius;
  const AxisPoints points = contact.place == AxisPlace::closest
                                ? closest_points(a, b)
                                : AxisPoints{contact.s, closest_point(b, a.at(contact.s))};
  const Vector3 on_a = a.at(points.s), on_b = b.at(points.t), between = on_a - on_b;
  const double distance = between.norm();
  if (distance > 1e-9 * (radius + other_radius) && contact.normal.dot(between) >= 0)
    contact.normal = between / distance;
  return {contact.normal.dot(between) - radius - other_radius, on_a - radius * contact.normal,
          on_b + other_radius * contact.normal};
}

}  // namespace rodsweep
