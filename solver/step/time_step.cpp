#include "solver/step/time_step.hpp"

#include <algorithm>
#include <cmath>

#include "solver/linear/interruption.hpp"
#include "solver/numbers/rotation.hpp"

namespace rodsweep {

/// The iterations of a step that try to keep the balance of momentum before the attempt is undone; all if they are few.
static int balancing_iterations(int most) {
  constexpr int fewest_to_share = 6;
  return most < fewest_to_share ? most : (2 * most + 2) / 3;
}

TimeStepper::TimeStepper(Scene& scene, const StepSettings& settings)
    : scene_(scene), settings_(settings), start_time_s_(scene.time_s) {
  const auto check = [&scene](const char* what, int rod, int segment) {
    if (rod < 0 || rod >= static_cast<int>(scene.rods.size()) || segment < 0 ||
        segment >= scene.rods[at(rod)].segment_count())
      throw SceneError(std::string(what) + " refers to segment " + std::to_string(segment) + " of rod " +
                       std::to_string(rod) + ", which the scene does not have");
  };
  for (const PointLoad& load : scene.loads) check("a point load", load.rod, load.segment);
  for (const MovingClamp& clamp : scene.clamps) {
    check("a moving clamp", clamp.rod, clamp.segment);
    if (!scene.rods[at(clamp.rod)].segments[at(clamp.segment)].is_static)
      throw SceneError("a moving clamp needs a static segment; segment " + std::to_string(clamp.segment) + " is free");
  }
  for (Rod& rod : scene.rods) {
    if (scene.internal_damping_s > 0) dampings_.emplace_back(rod, scene.internal_damping_s);
    flights_.emplace_back(rod, settings.integrator, settings.dt);
    const std::vector<Vector3> none(rod.segments.size(), Vector3::Zero());
    loads_.push_back({none, none});
  }
  torques_nm_.resize(scene.loads.size());
  for (const PointLoad& load : scene.loads) {
    Rod& rod = scene.rods[at(load.rod)];
    rod.load_torque_nm.assign(rod.segments.size(), Vector3::Zero());
  }
  if (scene.contact) {
    ContactSettings contact = *scene.contact;
    contact.tolerance = contact.tolerance_in(settings.dt);
    contact_ = std::make_unique<ContactProjection>(scene, contact, rodsweep::constraint_dt(scene, settings.dt),
                                                   settings.integrator == Integrator::bdf2);
  }
}

StepReport TimeStepper::step(Projection& projection) {
  StepReport report;
  const bool tries = projection.keep_balance(paused_ == 0);
  report.balanced = tries;

  // Predict.
  start();
  find_loads();
  predict(report.balanced);

  // Detect.
  if (contact_ && !contact_->find(report.balanced)) {
    report.outcome = SolveOutcome::not_a_number;
    return report;
  }

  // Newton.
  const int most = settings_.newton_iterations;
  Newton newton = report.balanced ? iterate(projection, balancing_iterations(most), report) : Newton::open;
  if (report.balanced && report.newton_iterations < most && is_lost(newton)) {
    take_back(projection, report);
    newton = Newton::open;
  }
  if (newton == Newton::open) newton = iterate(projection, most, report);
  if (report.balanced)
    for (Rod& rod : scene_.rods) unstiffen(rod);
  report.balanced &= newton == Newton::converged || (newton == Newton::open && is_near_balance(1e-3));
  pause_balance(tries, report.balanced);
  if (newton == Newton::failed) return report;

  // Update.
  if (contact_) {
    const ContactState state = contact_->state();
    report.contacts = static_cast<int>(contact_->contacts().size());
    report.penetration = state.penetration;
    report.contact_residual = state.residual;
  }
  for (std::size_t r = 0; r < scene_.rods.size(); ++r) flights_[r].update_velocities(scene_.rods[r]);
  ++steps_;
  scene_.time_s = start_time_s_ + steps_ * settings_.dt;
  return report;
}

void TimeStepper::pause_balance(bool tried, bool balanced) {
  constexpr int longest = 16;
  if (!tried) {
    paused_ = std::max(0, paused_ - 1);
    return;
  }
  pause_ = balanced ? 0 : std::clamp(2 * pause_, 1, longest);
  paused_ = pause_;
}

void TimeStepper::continue_from(int rod, const RodMotion& before) {
  flights_[at(rod)].continue_from(scene_.rods[at(rod)], before);
  if (dampings_.empty()) return;
  Rod earlier = scene_.rods[at(rod)];
  earlier.position = before.position;
  earlier.orientation = before.orientation;
  dampings_[at(rod)].remember(earlier);
}

Reactions TimeStepper::reactions() const {
  Reactions out;
  for (const Rod& rod : scene_.rods) add_clamp_actions(rod, out.clamps);
  if (contact_) contact_->add_actions(out.obstacles, out.clamps);
  return out;
}

bool TimeStepper::is_lost(Newton balanced) const {
  constexpr double lost = 0.1;
  return balanced == Newton::failed || (balanced == Newton::open && !is_near_balance(lost));
}

bool TimeStepper::is_near_balance(double momentum) const {
  constexpr double joints = 1e-6;
  return newton_residual_ < joints && momentum_residual_ < momentum;
}

/// Starts the step again without the balance of momentum.
void TimeStepper::take_back(Projection& projection, StepReport& report) {
  predict(false);
  for (Rod& rod : scene_.rods) unstiffen(rod);
  report.balanced = projection.keep_balance(false);
  report.outcome = SolveOutcome::converged;
  if (contact_) contact_->find(false);
}

// Iterates from the report's number of iterations up to `until`.
TimeStepper::Newton TimeStepper::iterate(Projection& projection, int until, StepReport& report) {
  for (int newton = report.newton_iterations; newton < until; ++newton) {
    bool converged = true;
    newton_residual_ = momentum_residual_ = 0;
    for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
      const SolvePosition at{steps_, newton, static_cast<int>(r)};
      check_interrupted(static_cast<std::int64_t>(scene_.rods[r].joints.size()) * 500);
      const ProjectionReport done =
          projection.project(scene_.rods[r], at, scene_.rods[r].constraint_dt, settings_.newton_tolerance);
      newton_residual_ = larger_or_nan(newton_residual_, done.newton_residual);
      momentum_residual_ = larger_or_nan(momentum_residual_, done.momentum_residual);
      if (done.outcome == SolveOutcome::not_run) continue;
      converged = false;
      report.newton_iterations = newton + 1;
      if (done.outcome == SolveOutcome::converged) continue;
      report.outcome = done.outcome;
      if (done.outcome != SolveOutcome::iteration_limit) return Newton::failed;
    }
    if (contact_ && !contact_->project()) {
      converged = false;
      report.newton_iterations = newton + 1;
    }
    if (converged) return Newton::converged;
  }
  return Newton::open;
}

double constraint_dt(const Scene& scene, double h) {
  // Drag scales the constraints' forces like the loads, so that it cancels at rest and does not shift an equilibrium.
  return h / std::sqrt(1 + scene.damping_per_s * h);
}

void TimeStepper::start() {
  if (contact_) contact_->start_step(end_of_step());
  for (std::size_t r = 0; r < dampings_.size(); ++r) dampings_[r].remember(scene_.rods[r]);
  for (std::size_t r = 0; r < scene_.rods.size(); ++r) flights_[r].start(scene_.rods[r]);
  if (contact_ && settings_.integrator == Integrator::bdf2) {
    const std::vector<char>& hit = contact_->impacts();
    for (std::size_t r = 0; r < scene_.rods.size(); ++r)
      if (hit[r]) flights_[r].start_anew(scene_.rods[r]);
  }
  for (std::size_t r = 0; r < dampings_.size(); ++r)
    dampings_[r].start(scene_.rods[r], flights_[r].h(), flights_[r].uses_two_steps());
  for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
    scene_.rods[r].constraint_dt = constraint_dt(scene_, flights_[r].h());
    if (!contact_) continue;
    PastPoses& past = contact_->past(r);
    past.h = flights_[r].h();
    flights_[r].put_past(scene_.rods[r], past.position.data(), past.orientation.data());
  }
}

void TimeStepper::find_loads() {
  if (!scene_.wind)
    for (const PointLoad& load : scene_.loads) loads_[at(load.rod)].force_n[at(load.segment)].setZero();
  else
    for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
      const Rod& rod = scene_.rods[r];
      const double time_s = flights_[r].uses_two_steps() ? end_of_step() : scene_.time_s;
      for (std::size_t s = 0; s < rod.segments.size(); ++s)
        if (!rod.segments[s].is_static)
          loads_[r].force_n[s] = scene_.wind->drag(rod.segments[s], rod.position[s], director(rod.orientation[s]),
                                                   rod.velocity[s], time_s, settings_.dt);
    }
  for (std::size_t i = 0; i < scene_.loads.size(); ++i) {
    const PointLoad& load = scene_.loads[i];
    const auto r = at(load.rod), s = at(load.segment);
    const double factor = load.schedule.at(end_of_step());
    const Vector3 force_n = factor * load.force_n;
    loads_[r].force_n[s] += force_n;
    torques_nm_[i] = factor * load.torque_nm + (scene_.rods[r].orientation[s] * load.arm_m).cross(force_n);
  }
}

// Ends at p*, or with the balance where the last step leads to. Without joints Newton does nothing and p* is the result,
// so it must have the torques.
void TimeStepper::predict(bool balanced) {
  const auto torque = [this](const PointLoad& load, bool in_balance) -> Vector3& {
    const auto r = at(load.rod), s = at(load.segment);
    return in_balance ? scene_.rods[r].load_torque_nm[s] : loads_[r].torque_nm[s];
  };
  for (const PointLoad& load : scene_.loads)
    for (const bool in_balance : {false, true}) torque(load, in_balance).setZero();
  for (std::size_t i = 0; i < scene_.loads.size(); ++i) {
    const PointLoad& load = scene_.loads[i];
    torque(load, balanced && !scene_.rods[at(load.rod)].joints.empty()) += torques_nm_[i];
  }
  const bool loaded = scene_.wind || !scene_.loads.empty();
  const Vector3 gravity = scene_.gravity_at(end_of_step());
  for (std::size_t r = 0; r < scene_.rods.size(); ++r)
    flights_[r].predict(scene_.rods[r], scene_.damping_per_s, gravity, loaded ? &loads_[r] : nullptr);
  const double end = end_of_step();
  for (const MovingClamp& clamp : scene_.clamps) {
    Rod& rod = scene_.rods[at(clamp.rod)];
    const Pose pose = clamp.pose(end);
    rod.position[at(clamp.segment)] = pose.position;
    rod.orientation[at(clamp.segment)] = pose.orientation.normalized();
  }
  for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
    Rod& rod = scene_.rods[r];
    rod.free_position = rod.position;
    rod.free_orientation = rod.orientation;
    if (!balanced)
      rod.lambda.setZero();
    else if (!rod.joints.empty())
      flights_[r].extrapolate(rod);
  }
}

}  // namespace rodsweep
