#include "solver/step/free_flight.hpp"

#include "solver/numbers/lane_records.hpp"

namespace rodsweep {

FreeFlight::FreeFlight(const Rod& rod, Integrator integrator, double dt) : integrator_(integrator), dt_(dt) {
  const int count = rod.segment_count();
  for (int first = 0; first < count; first += lane_width) {
    Group group{};
    for (int lane = 0; lane < lane_width; ++lane) {
      const Segment& segment = rod.segments[at(std::min(first + lane, count - 1))];
      group.is_free[lane] = segment.is_static ? 0 : -1;
      group.inverse_mass[lane] = segment.inverse_mass;
      group.inverse_inertia_transverse[lane] = segment.inverse_inertia_transverse;
      group.excess[lane] = segment.inverse_inertia_axial - segment.inverse_inertia_transverse;
      group.gyration[lane] = (segment.inertia_axial - segment.inertia_transverse) * segment.inverse_inertia_transverse;
    }
    groups_.push_back(group);
  }
}

/// Calls visit(group, its first segment, how many it has).
template <class Groups, class Visit>
static void visit_groups(Groups& groups, const Rod& rod, Visit visit) {
  std::size_t s = 0;
  for (auto& group : groups) {
    visit(group, s, rod.segment_count() - static_cast<int>(s));
    s += lane_width;
  }
}

/// Moves free segments; the others stay where they are now.
template <class Group>
static void move_free(Rod& rod, const Group& group, std::size_t s, int count, const LaneVector& position,
                      const LaneQuaternion& orientation) {
  store(select(group.is_free, position, group.now.position), &rod.position[s], count);
  store(select(group.is_free, orientation, group.now.orientation), &rod.orientation[s], count);
}

static void set_velocities(Rod& rod, const LaneMotion& motion, std::size_t s, int count) {
  store(motion.velocity, &rod.velocity[s], count);
  store(motion.spin, &rod.angular_velocity[s], count);
}

void FreeFlight::start(Rod& rod) {
  known_ = std::min(known_ + 1, 2);
  uses_two_steps_ = integrator_ == Integrator::bdf2 && known_ == 2;
  const Lane step = all_lanes(h());
  visit_groups(groups_, rod, [&](Group& group, std::size_t s, int count) {
    group.before = group.now;
    group.now = {load(&rod.position[s], count), load(&rod.orientation[s], count), load(&rod.velocity[s], count),
                 load(&rod.angular_velocity[s], count)};
    group.past = {group.now.position, group.now.orientation};
    if (!uses_two_steps_) return;
    group.past = past_pose(group.now, group.before);
    group.expected = expected(group.past, group.now, group.before, step);
    move_free(rod, group, s, count, group.expected.position, group.expected.orientation);
    set_velocities(rod, group.expected, s, count);
  });
}

void FreeFlight::start_anew(Rod& rod) {
  known_ = -1;  // the velocity after this step still has a part of that before the impact
  uses_two_steps_ = false;
  visit_groups(groups_, rod, [&](Group& group, std::size_t s, int count) {
    group.past = {group.now.position, group.now.orientation};
    move_free(rod, group, s, count, group.now.position, group.now.orientation);
    set_velocities(rod, group.now, s, count);
  });
}

void FreeFlight::predict(Rod& rod, double damping_per_s, const Vector3& gravity_m_s2, const SegmentLoads* loads) {
  if (uses_two_steps_) return predict_by_two_steps(rod, damping_per_s, gravity_m_s2, loads);
  const double damped_dt = dt_ / (1 + damping_per_s * dt_);
  const LaneVector gain = all_lanes(dt_ * gravity_m_s2);
  visit_groups(groups_, rod, [&](Group& group, std::size_t s, int count) {
    const LaneMotion& now = group.now;
    const LaneVector axis = director(now.orientation);
    LaneVector velocity = now.velocity + gain;
    LaneVector spin = gyrated(now.spin, axis, dt_ * group.gyration);
    if (loads) {
      const LaneVector torque = load(&loads->torque_nm[s], count);
      velocity = velocity + (dt_ * group.inverse_mass) * load(&loads->force_n[s], count);
      spin = spin + (dt_ * group.inverse_inertia_transverse) * torque + (dt_ * group.excess * dot(axis, torque)) * axis;
    }
    move_free(rod, group, s, count, now.position + all_lanes(damped_dt) * velocity,
              rotated(now.orientation, all_lanes(damped_dt) * spin));
  });
}

void FreeFlight::predict_by_two_steps(Rod& rod, double damping_per_s, const Vector3& gravity_m_s2,
                                      const SegmentLoads* loads) {
  const double h = this->h();
  const Lane step = all_lanes(h);
  const LaneVector gain = all_lanes(h * gravity_m_s2);
  visit_groups(groups_, rod, [&](Group& group, std::size_t s, int count) {
    Flight flight{group.gyration, all_lanes(1 / (1 + damping_per_s * h)), gain};
    if (loads) {
      const LaneVector torque = load(&loads->torque_nm[s], count);
      flight.gain = flight.gain + (h * group.inverse_mass) * load(&loads->force_n[s], count);
      flight.turning = (h * group.inverse_inertia_transverse) * torque;
      flight.axial_turning =
          h * (group.inverse_inertia_transverse + group.excess) * dot(director(group.expected.orientation), torque);
    }
    const LanePose end = flown(group.past, group.now, group.before, group.expected, flight, step);
    move_free(rod, group, s, count, end.position, end.orientation);
    set_velocities(rod, group.now, s, count);
  });
}

void FreeFlight::extrapolate(Rod& rod) const {
  if (known_ < 2) return;
  const Lane step = all_lanes(h());
  visit_groups(groups_, rod, [&](const Group& group, std::size_t s, int count) {
    const LaneMotion motion = uses_two_steps_ ? group.expected : expected(group.past, group.now, group.before, step);
    const LaneVector position = load(&rod.position[s], count);
    const LaneQuaternion orientation = load(&rod.orientation[s], count);
    store(select(group.is_free, motion.position, position), &rod.position[s], count);
    store(select(group.is_free, motion.orientation, orientation), &rod.orientation[s], count);
  });
}

void FreeFlight::update_velocities(Rod& rod) const {
  const Lane inverse_h = all_lanes(1 / h());
  visit_groups(groups_, rod, [&](const Group& group, std::size_t s, int count) {
    store(inverse_h * (load(&rod.position[s], count) - group.past.position), &rod.velocity[s], count);
    store(inverse_h * rotation(load(&rod.orientation[s], count), group.past.orientation), &rod.angular_velocity[s],
          count);
  });
}

RodMotion FreeFlight::before(const Rod& rod) const {
  RodMotion out;
  if (known_ < 1) return out;
  out = {rod.position, rod.velocity, rod.angular_velocity, rod.orientation};
  visit_groups(groups_, rod, [&](const Group& group, std::size_t s, int count) {
    store(group.now.position, &out.position[s], count);
    store(group.now.velocity, &out.velocity[s], count);
    store(group.now.spin, &out.angular_velocity[s], count);
    store(group.now.orientation, &out.orientation[s], count);
  });
  return out;
}

void FreeFlight::continue_from(const Rod& rod, const RodMotion& before) {
  known_ = 1;
  visit_groups(groups_, rod, [&](Group& group, std::size_t s, int count) {
    group.now = {load(&before.position[s], count), load(&before.orientation[s], count),
                 load(&before.velocity[s], count), load(&before.angular_velocity[s], count)};
  });
}

void FreeFlight::put_past(const Rod& rod, Vector3* position, Quaternion* orientation) const {
  visit_groups(groups_, rod, [&](const Group& group, std::size_t s, int count) {
    store(group.past.position, position + s, count);
    store(group.past.orientation, orientation + s, count);
  });
}

}  // namespace rodsweep
