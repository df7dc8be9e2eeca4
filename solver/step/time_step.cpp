#include "solver/step/time_step.hpp"

#include <cmath>

#include "solver/numbers/rotation.hpp"

namespace rodsweep {

TimeStepper::TimeStepper(Scene& scene, const StepSettings& settings)
    : scene_(scene), settings_(settings), start_time_s_(scene.time_s) {
  const auto check = [&scene](const char* what, int rod, int segment) {
    if (rod < 0 || rod >= static_cast<int>(scene.rods.size()) || segment < 0 ||
        segment >= scene.rods[static_cast<std::size_t>(rod)].segment_count())
      throw SceneError(std::string(what) + " refers to segment " + std::to_string(segment) + " of rod " +
                       std::to_string(rod) + ", which the scene does not have");
  };
  for (const PointLoad& load : scene.loads) check("a point load", load.rod, load.segment);
  for (const MovingClamp& clamp : scene.clamps) {
    check("a moving clamp", clamp.rod, clamp.segment);
    if (!scene.rods[static_cast<std::size_t>(clamp.rod)].segments[static_cast<std::size_t>(clamp.segment)].is_static)
      throw SceneError("a moving clamp needs a static segment; segment " + std::to_string(clamp.segment) + " is free");
  }
  for (const Rod& rod : scene.rods)
    old_.push_back({rod.position, rod.orientation, std::vector<Vector3>(rod.segments.size(), Vector3::Zero()),
                    std::vector<Vector3>(rod.segments.size(), Vector3::Zero())});
  if (scene.contact) contact_ = std::make_unique<ContactProjection>(scene, *scene.contact);
}

StepReport TimeStepper::step(Projection& projection) {
  if (contact_) contact_->start_step();
  predict();
  StepReport report;
  if (contact_ && !contact_->find()) {
    report.outcome = SolveOutcome::not_a_number;
    return report;
  }
  const double dt_c = constraint_dt();
  bool converged = false;
  for (int newton = 0; newton < settings_.newton_iterations && !converged; ++newton) {
    converged = true;
    for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
      const SolvePosition at{steps_, newton, static_cast<int>(r)};
      const SolveOutcome outcome = projection.project(scene_.rods[r], at, dt_c, settings_.newton_tolerance).outcome;
      if (outcome == SolveOutcome::not_run) continue;
      converged = false;
      report.newton_iterations = newton + 1;
      if (outcome == SolveOutcome::converged) continue;
      report.outcome = outcome;
      if (outcome != SolveOutcome::iteration_limit) return report;
    }
    if (contact_ && !contact_->project(dt_c)) {
      converged = false;
      report.newton_iterations = newton + 1;
    }
  }
  if (contact_) {
    report.contacts = static_cast<int>(contact_->contacts().size());
    const ContactState state = contact_->state();
    report.penetration = state.penetration;
    report.contact_residual = state.residual;
  }
  update_velocities();
  ++steps_;
  scene_.time_s = start_time_s_ + steps_ * settings_.dt;
  return report;
}

double constraint_dt(const Scene& scene, double dt) {
  // Drag slows the constraints' forces like the loads', so that it cancels at rest and cannot shift an equilibrium.
  return dt / std::sqrt(1 + scene.damping_per_s * dt);
}

void TimeStepper::predict() {
  const double dt = settings_.dt;
  const double damping = 1 / (1 + scene_.damping_per_s * dt);
  for (const PointLoad& load : scene_.loads) {
    OldPose& old = old_[static_cast<std::size_t>(load.rod)];
    const std::size_t s = static_cast<std::size_t>(load.segment);
    old.force[s].setZero();
    old.torque[s].setZero();
  }
  for (const PointLoad& load : scene_.loads) {
    OldPose& old = old_[static_cast<std::size_t>(load.rod)];
    const std::size_t s = static_cast<std::size_t>(load.segment);
    const Vector3 arm = scene_.rods[static_cast<std::size_t>(load.rod)].orientation[s] * load.arm_m;
    old.force[s] += load.force_n;
    old.torque[s] += load.torque_nm + arm.cross(load.force_n);
  }
  for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
    Rod& rod = scene_.rods[r];
    OldPose& old = old_[r];
    for (std::size_t s = 0; s < rod.segments.size(); ++s) {
      old.position[s] = rod.position[s];
      old.orientation[s] = rod.orientation[s];
      const Segment& segment = rod.segments[s];
      if (segment.is_static) continue;
      // Axisymmetric inertia: w x I w = (i_a - i_t) (t.w) w x t, transverse to t, and I^-1 = i_t^-1 + excess t t^T.
      const Vector3 axis = director(rod.orientation[s]);
      const Vector3& w = rod.angular_velocity[s];
      const double spin = (segment.inertia_axial - segment.inertia_transverse) * axis.dot(w);
      const Vector3 torque = old.torque[s] - spin * w.cross(axis);
      const double excess = segment.inverse_inertia_axial - segment.inverse_inertia_transverse;
      const Vector3 turn = segment.inverse_inertia_transverse * torque + (excess * axis.dot(torque)) * axis;
      Vector3 force = old.force[s];
      if (scene_.wind) force += scene_.wind->drag(segment, rod.position[s], axis, rod.velocity[s], scene_.time_s, dt);
      const Vector3 velocity = damping * (rod.velocity[s] + dt * (scene_.gravity_m_s2 + segment.inverse_mass * force));
      rod.position[s] += dt * velocity;
      rod.orientation[s] = rotated(rod.orientation[s], dt * damping * (w + dt * turn));
    }
    rod.lambda.setZero();
  }
  const double end = start_time_s_ + (steps_ + 1) * dt;
  for (const MovingClamp& clamp : scene_.clamps) {
    Rod& rod = scene_.rods[static_cast<std::size_t>(clamp.rod)];
    const Pose pose = clamp.pose(end);
    rod.position[static_cast<std::size_t>(clamp.segment)] = pose.position;
    rod.orientation[static_cast<std::size_t>(clamp.segment)] = pose.orientation.normalized();
  }
}

void TimeStepper::update_velocities() {
  const double inverse_dt = 1 / settings_.dt;
  for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
    Rod& rod = scene_.rods[r];
    for (std::size_t s = 0; s < rod.segments.size(); ++s) {
      rod.velocity[s] = inverse_dt * (rod.position[s] - old_[r].position[s]);
      rod.angular_velocity[s] = inverse_dt * rotation(rod.orientation[s], old_[r].orientation[s]);
    }
  }
}

}  // namespace rodsweep
