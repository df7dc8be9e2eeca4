#include "solver/contact/contact_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

/// Beyond it, the response of the whole rod after each sweep is cheaper.
///
/// Nearly inextensible rods have no Delassus operator. An exact response to a blow from the tip would compress them
/// beyond any buckling load, and fling them away in the next step. Sweeps over free segments find first how a rod bends.
int most_touched(const Rod& rod) { return can_be_condensed(rod) ? 160 : 0; }

/// |h w| = 2 tan(angle / 2) up to which contacts turn a segment in a step, 152 degrees: there friction slides on. Joints
/// that close near half a turn could reverse the spin.
constexpr double most_turned = 8;

/// q after an impulse: its part about the axis of the turn h w from q^ adds to h w, so that the spin gets what the impulse
/// has. The rest turns the segment further, as it moves the surface.
Quaternion turned(const Quaternion& q, const Quaternion& past, const Vector3& dtheta) {
  const Vector3 turn = rotation(q, past);
  const double size = turn.norm(), most = std::max(most_turned, size);
  const Vector3 axis = size > 0 ? Vector3(turn / size) : Vector3::Zero();
  const double about = axis.dot(dtheta);
  const Quaternion out = rotated(rotated(past, std::clamp(size + about, -most, most) * axis), dtheta - about * axis);
  const Vector3 total = rotation(out, past);
  const double all = total.norm();
  return all > most ? rotated(past, most / all * total) : out;
}

void move_in_world(Rod& rod, const PastPoses& past, std::size_t segment, const Lane8& motion) {
  if (rod.segments[segment].is_static) return;
  rod.position[segment] += Vector3(motion[0], motion[1], motion[2]);
  rod.orientation[segment] =
      turned(rod.orientation[segment], past.orientation[segment], Vector3(motion[3], motion[4], motion[5]));
}

/// I^-1 m of an axisymmetric segment.
Vector3 turn(const Segment& segment, const Vector3& moment, const CapsuleAxis& axis) {
  const Vector3 along = axis.half / (segment.length_m / 2);
  return segment.turn_mobility * moment +
         (segment.inverse_inertia_axial - segment.turn_mobility) * along.dot(moment) * along;
}

Lane8 joined(const Vector3& a, const Vector3& b) { return Lane8{a.x(), a.y(), a.z(), b.x(), b.y(), b.z(), 0, 0}; }

Vector3 at_point(const Lane8& motion, const Vector3& arm) {
  return Vector3(motion[0], motion[1], motion[2]) + Vector3(motion[3], motion[4], motion[5]).cross(arm);
}

bool is_zero(const Lane8& v) {
  for (int i = 0; i < 6; ++i)
    if (v[i] != 0) return false;
  return true;
}

Lane8 product(const Block6& block, const Lane8& v) {
  Lane8 sum = block.column[0] * v[0];
#pragma GCC unroll 6
  for (int c = 1; c < 6; ++c) sum += block.column[c] * v[c];
  return sum;
}

}  // namespace

ContactMotion::ContactMotion(Scene& scene, const ContactBodies& bodies)
    : scene_(scene),
      bodies_(bodies),
      motion_(at(bodies.count()), Lane8{}),
      settled_(at(bodies.count()), Lane8{}),
      wrench_(at(bodies.count()), Lane8{}) {
  int first_body = 0;
  for (const Rod& rod : scene.rods) {
    rods_.push_back(
        {first_body, {rod.position, rod.orientation}, 1, {}, DelassusOperator(rod.segment_count(), most_touched(rod))});
    first_body += rod.segment_count();
  }
}

void ContactMotion::start_step(double unit_dt) {
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    const double ratio = scene_.rods[r].constraint_dt / unit_dt;
    rods_[r].share = ratio * ratio;
    rods_[r].assembled = false;
  }
}

void ContactMotion::respond() {
  responds_ = true;
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    Coupled& coupled = rods_[r];
    coupled.touched = false;
    if (coupled.assembled && (coupled.delassus.is_full() || coupled.response->is_stale(scene_.rods[r])))
      coupled.assembled = false;
  }
}

void ContactMotion::touch(int body) {
  if (body < 0) return;
  const Body& of = bodies_.body(body);
  if (!of.is_free) return;
  Coupled& coupled = rods_[at(of.rod)];
  const Rod& rod = scene_.rods[at(of.rod)];
  if (!coupled.response) coupled.response.emplace(rod);
  if (!coupled.assembled) {
    coupled.response->assemble(rod, rod.constraint_dt);
    coupled.delassus.clear();
    coupled.assembled = true;
  }
  coupled.touched = true;
  coupled.delassus.touch(of.segment);
}

void ContactMotion::update() {
  for (std::size_t r = 0; r < rods_.size(); ++r)
    if (rods_[r].touched) rods_[r].delassus.update(scene_.rods[r], *rods_[r].response);
}

const Segment& ContactMotion::segment(const Body& of) const { return scene_.rods[at(of.rod)].segments[at(of.segment)]; }

Lane8 ContactMotion::free_motion(int body, const Lane8& wrench) const {
  const Segment& of = segment(bodies_.body(body));
  const Vector3 force(wrench[0], wrench[1], wrench[2]), moment(wrench[3], wrench[4], wrench[5]);
  return joined(of.inverse_mass * force, turn(of, moment, (*axes_)[at(body)]));
}

int ContactMotion::group(int body) const {
  if (body < 0 || !bodies_.body(body).is_free) return -1;
  const int rod = bodies_.body(body).rod;
  return responds_ && !rods_[at(rod)].delassus.is_full() ? rod : static_cast<int>(rods_.size()) + body;
}

Matrix3 ContactMotion::coupling(const BodyPoint& of, const BodyPoint& by) const {
  const Body &moved = bodies_.body(of.body), &pushed = bodies_.body(by.body);
  const Coupled& coupled = rods_[at(moved.rod)];
  const bool is_free = !responds_ || coupled.delassus.is_full();
  Matrix3 w;
  for (int c = 0; c < 3; ++c) {
    const Vector3 impulse = coupled.share * Vector3::Unit(c);
    const Lane8 wrench = joined(impulse, by.arm.cross(impulse));
    const Lane8 motion =
        is_free ? free_motion(by.body, wrench) : product(coupled.delassus.block(moved.segment, pushed.segment), wrench);
    w.col(c) = at_point(motion, of.arm);
  }
  return w;
}

Matrix3 ContactMotion::mobility(const BodyPoint& a, const BodyPoint& b) const {
  Matrix3 w = Matrix3::Zero();
  const int group_a = group(a.body), group_b = group(b.body);
  if (group_a >= 0) w += coupling(a, a);
  if (group_b >= 0) w += coupling(b, b);
  if (group_a < 0 || group_a != group_b) return w;
  const Matrix3 cross = coupling(a, b);
  return w - cross - cross.transpose();
}

bool ContactMotion::is_single(int body) const {
  return body >= 0 && bodies_.body(body).is_free && scene_.rods[at(bodies_.body(body).rod)].joints.empty();
}

void ContactMotion::push(const BodyPoint& point, const Vector3& impulse) {
  if (point.body < 0) return;
  const Body& of = bodies_.body(point.body);
  if (!of.is_free) return;
  Coupled& coupled = rods_[at(of.rod)];
  const Vector3 own = coupled.share * impulse;
  const Lane8 wrench = joined(own, point.arm.cross(own));
  if (responds_) {
    wrench_[at(point.body)] += wrench;
    coupled.pushed = true;
  } else {
    motion_[at(point.body)] += free_motion(point.body, wrench);
  }
}

Vector3 ContactMotion::velocity(const BodyPoint& point) const {
  const Coupled& rod = coupled(point.body);
  const auto s = at(bodies_.body(point.body).segment);
  const Rod& now = scene_.rods[at(bodies_.body(point.body).rod)];
  const Vector3 turn = rotation(now.orientation[s], rod.past.orientation[s]);
  return (now.position[s] - rod.past.position[s] + turn.cross(point.arm)) / rod.past.h;
}

Vector3 ContactMotion::velocity_before(const BodyPoint& point) const {
  const auto s = at(bodies_.body(point.body).segment);
  const Rod& rod = scene_.rods[at(bodies_.body(point.body).rod)];
  return rod.velocity[s] + rod.angular_velocity[s].cross(point.arm);
}

// The balance measures a turn from q*. About one axis, tan(x - y) = (tan x - tan y) / (1 + tan x tan y).
Vector3 ContactMotion::turning(int segment, const Vector3& moment) const {
  const auto s = at(bodies_.body(segment).segment);
  const Rod& now = scene_.rods[at(bodies_.body(segment).rod)];
  const Quaternion& past = coupled(segment).past.orientation[s];
  const Vector3 turn = rotation(now.orientation[s], past), free = rotation(now.free_orientation[s], past);
  return moment - turn * (free.dot(moment) / (4 + free.dot(turn)));
}

Vector3 ContactMotion::of(const BodyPoint& point) const {
  if (point.body < 0) return Vector3::Zero();
  return at_point(motion_[at(point.body)], point.arm);
}

bool ContactMotion::needs_settling() const {
  return std::any_of(rods_.begin(), rods_.end(),
                     [](const Coupled& coupled) { return coupled.touched && coupled.delassus.is_full(); });
}

bool ContactMotion::couples_segments() const {
  return std::any_of(rods_.begin(), rods_.end(),
                     [](const Coupled& coupled) { return coupled.touched && !coupled.delassus.is_full(); });
}

void ContactMotion::settle() {
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    Coupled& coupled = rods_[r];
    if (!coupled.pushed) continue;
    coupled.pushed = false;
    const Rod& rod = scene_.rods[r];
    Lane8* const motion = motion_.data() + coupled.first_body;
    Lane8* const settled = settled_.data() + coupled.first_body;
    Lane8* const wrench = wrench_.data() + coupled.first_body;
    for (int s = 0; s < rod.segment_count(); ++s)
      motion[s] = is_zero(wrench[s]) ? Lane8{} : coupled.response->free_motion(rod, s, wrench[s]);
    coupled.response->respond(rod, motion);
    for (int s = 0; s < rod.segment_count(); ++s) {
      motion[s] = settled[s] += motion[s];
      wrench[s] = Lane8{};
    }
  }
}

void ContactMotion::apply(bool keeps_balance) {
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    Coupled& coupled = rods_[r];
    if (!coupled.touched) continue;
    Rod& rod = scene_.rods[r];
    rod.lambda += coupled.response->multipliers();
    coupled.response->forget_multipliers();
    const auto move = [&] {
      for (int s = 0; s < rod.segment_count(); ++s) {
        const auto body = at(coupled.first_body + s);
        move_in_world(rod, coupled.past, at(s), settled_[body]);
        motion_[body] = settled_[body] = Lane8{};
      }
    };
    if (keeps_balance)
      with_forces_held(rod, move);
    else
      move();
  }
}

void ContactMotion::clear() { std::fill(motion_.begin(), motion_.end(), Lane8{}); }

}  // namespace rodsweep
