#include "solver/batch/batched_step.hpp"

namespace rodsweep {

BatchedStepper::BatchedStepper(const std::vector<Scene>& scenes, const StepSettings& settings)
    : settings_(settings),
      rods_(scenes, settings.dt),
      system_(rods_),
      sound_{},
      running_{},
      steps_(scenes.size(), 0),
      reports_(scenes.size()) {
  for (int rod = 0; rod < rods_.rods; ++rod) {
    sound_[rod] = -1;
    start_time_s_.push_back(scenes[static_cast<std::size_t>(rod)].time_s);
  }
}

const std::vector<StepReport>& BatchedStepper::step() {
  begin();
  while (linearize()) solve();
  return end();
}

void BatchedStepper::begin() {
  predict();
  running_ = sound_;
  newton_ = 0;
  for (StepReport& report : reports_) report.newton_iterations = 0;
}

bool BatchedStepper::linearize() {
  if (newton_ == settings_.newton_iterations) return false;
  system_.linearize(rods_);
  running_ &= ~system_.below(settings_.newton_tolerance);
  return any(running_);
}

void BatchedStepper::solve() {
  const BatchedSystem::Outcome outcome = system_.solve(rods_);
  ++newton_;
  for (int rod = 0; rod < rods_.rods; ++rod) {
    StepReport& report = reports_[static_cast<std::size_t>(rod)];
    if (!running_[rod]) continue;
    report.newton_iterations = newton_;
    if (!outcome.positive[rod])
      report.outcome = SolveOutcome::indefinite;
    else if (!outcome.finite[rod])
      report.outcome = SolveOutcome::not_a_number;
  }
  const LaneMask solved = outcome.positive & outcome.finite;
  sound_ &= ~running_ | solved;
  running_ &= solved;
  system_.apply(rods_, running_);
}

const std::vector<StepReport>& BatchedStepper::end() {
  update_velocities();
  for (int rod = 0; rod < rods_.rods; ++rod) steps_[static_cast<std::size_t>(rod)] += sound_[rod] != 0;
  return reports_;
}

void BatchedStepper::write(int rod, Scene& scene) const {
  rods_.write(rod, scene);
  scene.time_s = start_time_s_[static_cast<std::size_t>(rod)] + steps_taken(rod) * settings_.dt;
}

void BatchedStepper::predict() {
  const double dt = settings_.dt;
  const LaneVector gain = all_lanes(dt) * rods_.gravity;
  for (BatchedSegment& segment : rods_.segments) {
    segment.old_position = segment.position;
    segment.old_orientation = segment.orientation;
    if (segment.is_static) continue;
    const LaneVector turn = gyrated(segment.angular_velocity, director(segment.orientation), dt * segment.gyration);
    segment.position =
        select(sound_, segment.position + (dt * rods_.damping) * (segment.velocity + gain), segment.position);
    segment.orientation =
        select(sound_, rotated(segment.orientation, (dt * rods_.damping) * turn), segment.orientation);
  }
  const Lane zero{};
  for (BatchedJoint& joint : rods_.joints)
    for (Lane& row : joint.lambda.row) row = sound_ ? zero : row;
}

void BatchedStepper::update_velocities() {
  const double inverse_dt = 1 / settings_.dt;
  for (BatchedSegment& segment : rods_.segments) {
    segment.velocity =
        select(sound_, all_lanes(inverse_dt) * (segment.position - segment.old_position), segment.velocity);
    segment.angular_velocity =
        select(sound_, all_lanes(inverse_dt) * rotation(segment.orientation, segment.old_orientation),
               segment.angular_velocity);
  }
}

}  // namespace rodsweep
