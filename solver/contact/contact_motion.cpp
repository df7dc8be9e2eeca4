#include "solver/contact/contact_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

void move_in_world(Rod& rod, std::size_t segment, const Lane8& motion) {
  if (rod.segments[segment].is_static) return;
  rod.position[segment] += Vector3(motion[0], motion[1], motion[2]);
  rod.orientation[segment] = rotated(rod.orientation[segment], Vector3(motion[3], motion[4], motion[5]));
}

/// I^-1 m of an axisymmetric segment.
Vector3 turn(const Segment& segment, const Vector3& moment, const CapsuleAxis& axis) {
  const Vector3 along = axis.half / (segment.length_m / 2);
  return segment.turn_mobility * moment +
         (segment.inverse_inertia_axial - segment.turn_mobility) * along.dot(moment) * along;
}

}  // namespace

ContactMotion::ContactMotion(Scene& scene, const ContactBodies& bodies)
    : scene_(scene),
      bodies_(bodies),
      motion_(static_cast<std::size_t>(bodies.count()), Lane8{}),
      settled_(static_cast<std::size_t>(bodies.count()), Lane8{}) {
  int first_body = 0;
  for (const Rod& rod : scene.rods) {
    rods_.push_back({first_body});
    first_body += rod.segment_count();
  }
}

void ContactMotion::start_step(double unit_dt) {
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    const double ratio = scene_.rods[r].constraint_dt / unit_dt;
    rods_[r].share = ratio * ratio;
  }
}

const Segment& ContactMotion::segment(const Body& of) const {
  return scene_.rods[static_cast<std::size_t>(of.rod)].segments[static_cast<std::size_t>(of.segment)];
}

Matrix3 ContactMotion::mobility(int body, const Vector3& arm, const CapsuleAxis& axis) const {
  Matrix3 w = Matrix3::Zero();
  if (!bodies_.body(body).is_free) return w;
  const Segment& of = segment(bodies_.body(body));
  for (int c = 0; c < 3; ++c) w.col(c) = turn(of, arm.cross(Vector3::Unit(c)), axis).cross(arm);
  w.diagonal().array() += of.inverse_mass;
  return share(bodies_.body(body).rod) * w;
}

void ContactMotion::push(int body, const Vector3& arm, const Vector3& impulse, const CapsuleAxis& axis) {
  const Body& of = bodies_.body(body);
  if (!of.is_free) return;
  const Segment& pushed = segment(of);
  const Vector3 own = share(of.rod) * impulse;
  const Vector3 dx = pushed.inverse_mass * own, dtheta = turn(pushed, arm.cross(own), axis);
  motion_[static_cast<std::size_t>(body)] += Lane8{dx.x(), dx.y(), dx.z(), dtheta.x(), dtheta.y(), dtheta.z(), 0, 0};
  rods_[static_cast<std::size_t>(of.rod)].pushed = true;
}

Vector3 ContactMotion::of(int body, const Vector3& arm) const {
  const Lane8& motion = motion_[static_cast<std::size_t>(body)];
  return Vector3(motion[0], motion[1], motion[2]) + Vector3(motion[3], motion[4], motion[5]).cross(arm);
}

void ContactMotion::settle() {
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    Coupled& coupled = rods_[r];
    if (!coupled.pushed) continue;
    const Rod& rod = scene_.rods[r];
    if (!coupled.response) coupled.response.emplace(rod);
    if (!coupled.assembled) coupled.response->assemble(rod, rod.constraint_dt);
    coupled.assembled = true;
    coupled.pushed = false;
    Lane8* motion = motion_.data() + coupled.first_body;
    Lane8* settled = settled_.data() + coupled.first_body;
    for (int s = 0; s < rod.segment_count(); ++s) motion[s] -= settled[s];
    coupled.response->respond(rod, motion);
    for (int s = 0; s < rod.segment_count(); ++s) motion[s] = settled[s] += motion[s];
  }
}

void ContactMotion::apply(bool keeps_balance) {
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    Coupled& coupled = rods_[r];
    if (!coupled.assembled) continue;
    coupled.assembled = false;
    Rod& rod = scene_.rods[r];
    rod.lambda += coupled.response->multipliers();
    const auto move = [&] {
      for (int s = 0; s < rod.segment_count(); ++s) {
        const auto body = static_cast<std::size_t>(coupled.first_body + s);
        move_in_world(rod, static_cast<std::size_t>(s), settled_[body]);
        motion_[body] = settled_[body] = Lane8{};
      }
    };
    if (keeps_balance)
      with_forces_held(rod, move);
    else
      move();
  }
}

void ContactMotion::clear() {
  std::fill(motion_.begin(), motion_.end(), Lane8{});
  for (Coupled& coupled : rods_) coupled.pushed = false;
}

}  // namespace rodsweep
