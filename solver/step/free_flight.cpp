#include "solver/step/free_flight.hpp"

#include "solver/numbers/lane_records.hpp"

namespace rodsweep {

FreeFlight::FreeFlight(const Rod& rod) {
  const int count = rod.segment_count();
  for (int first = 0; first < count; first += lane_width) {
    Group group{};
    for (int lane = 0; lane < lane_width; ++lane) {
      const Segment& segment = rod.segments[static_cast<std::size_t>(std::min(first + lane, count - 1))];
      group.is_free[lane] = segment.is_static ? 0 : -1;
      group.inverse_mass[lane] = segment.inverse_mass;
      group.inverse_inertia_transverse[lane] = segment.inverse_inertia_transverse;
      group.excess[lane] = segment.inverse_inertia_axial - segment.inverse_inertia_transverse;
      group.gyration[lane] = (segment.inertia_axial - segment.inertia_transverse) * segment.inverse_inertia_transverse;
    }
    groups_.push_back(group);
  }
}

void FreeFlight::predict(Rod& rod, double dt, double damping_per_s, const Vector3& gravity_m_s2,
                         const SegmentLoads* loads) {
  const double damped_dt = dt / (1 + damping_per_s * dt);
  const LaneVector gain = {all_lanes(dt * gravity_m_s2.x()), all_lanes(dt * gravity_m_s2.y()),
                           all_lanes(dt * gravity_m_s2.z())};
  std::size_t s = 0;
  for (Group& group : groups_) {
    const int count = rod.segment_count() - static_cast<int>(s);
    const LaneVector position = load(&rod.position[s], count);
    const LaneQuaternion orientation = load(&rod.orientation[s], count);
    const LaneVector axis = director(orientation);
    LaneVector velocity = load(&rod.velocity[s], count) + gain;
    LaneVector spin = gyrated(load(&rod.angular_velocity[s], count), axis, dt * group.gyration);
    if (loads) {
      const LaneVector torque = load(&loads->torque_nm[s], count);
      velocity = velocity + (dt * group.inverse_mass) * load(&loads->force_n[s], count);
      spin = spin + (dt * group.inverse_inertia_transverse) * torque + (dt * group.excess * dot(axis, torque)) * axis;
    }
    group.old_position = position;
    group.old_orientation = orientation;
    store(select(group.is_free, position + all_lanes(damped_dt) * velocity, position), &rod.position[s], count);
    store(select(group.is_free, rotated(orientation, all_lanes(damped_dt) * spin), orientation), &rod.orientation[s],
          count);
    s += lane_width;
  }
}

void FreeFlight::extrapolate(Rod& rod, double dt) {
  const Lane step = all_lanes(dt), twice = all_lanes(2);
  std::size_t s = 0;
  for (Group& group : groups_) {
    const int count = rod.segment_count() - static_cast<int>(s);
    const LaneVector velocity = load(&rod.velocity[s], count), spin = load(&rod.angular_velocity[s], count);
    if (extrapolates_) {
      const LaneVector position = load(&rod.position[s], count);
      const LaneQuaternion orientation = load(&rod.orientation[s], count);
      store(select(group.is_free, group.old_position + step * (twice * velocity - group.velocity_before), position),
            &rod.position[s], count);
      store(
          select(group.is_free, rotated(group.old_orientation, step * (twice * spin - group.spin_before)), orientation),
          &rod.orientation[s], count);
    }
    group.velocity_before = velocity;
    group.spin_before = spin;
    s += lane_width;
  }
  extrapolates_ = true;
}

void FreeFlight::update_velocities(Rod& rod, double dt) const {
  const Lane inverse_dt = all_lanes(1 / dt);
  std::size_t s = 0;
  for (const Group& group : groups_) {
    const int count = rod.segment_count() - static_cast<int>(s);
    store(inverse_dt * (load(&rod.position[s], count) - group.old_position), &rod.velocity[s], count);
    store(inverse_dt * rotation(load(&rod.orientation[s], count), group.old_orientation), &rod.angular_velocity[s],
          count);
    s += lane_width;
  }
}

}  // namespace rodsweep
