#include "solver/batch/batched_step.hpp"

namespace rodsweep {
namespace {

std::optional<BatchedBalance> balance_of(const std::vector<Scene>& scenes, const BatchedRods& rods, bool wanted) {
  return wanted ? std::optional(BatchedBalance(scenes, rods)) : std::nullopt;
}

}  // namespace

BatchedStepper::BatchedStepper(const std::vector<Scene>& scenes, const StepSettings& settings,
                               std::optional<double> momentum_tolerance)
    : settings_(settings),
      rods_(scenes, settings.dt),
      system_(rods_, balance_of(scenes, rods_, momentum_tolerance.has_value())),
      sound_{},
      running_{},
      balanced_{},
      momentum_tolerance_(momentum_tolerance),
      steps_(scenes.size(), 0),
      reports_(scenes.size()) {
  if (momentum_tolerance_) before_.resize(rods_.segments.size());
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
  if (!momentum_tolerance_) return;
  balanced_ = sound_;
  start_from_last_step();
}

bool BatchedStepper::linearize() {
  const int most = settings_.newton_iterations;
  if (newton_ == most) return false;
  if (momentum_tolerance_ && newton_ == balancing_iterations(most))
    take_back(running_ & balanced_ & ~system_.below(lost_joints, lost_momentum));
  system_.linearize(rods_, balanced_);
  running_ &= ~system_.below(settings_.newton_tolerance, momentum_tolerance_.value_or(0));
  return any(running_);
}

void BatchedStepper::solve() {
  const BatchedSystem::Outcome outcome = system_.solve(rods_);
  ++newton_;
  LaneMask solved = outcome.positive & outcome.finite;
  const LaneMask lost = running_ & balanced_ & ~solved;
  const bool again = newton_ < settings_.newton_iterations;
  for (int rod = 0; rod < rods_.rods; ++rod) {
    StepReport& report = reports_[static_cast<std::size_t>(rod)];
    if (!running_[rod]) continue;
    report.newton_iterations = newton_;
    if (again && lost[rod]) continue;
    if (!outcome.positive[rod])
      report.outcome = SolveOutcome::indefinite;
    else if (!outcome.finite[rod])
      report.outcome = SolveOutcome::not_a_number;
  }
  system_.apply(rods_, running_ & solved);
  if (again) {
    take_back(lost);
    solved |= lost;
  }
  sound_ &= ~running_ | solved;
  running_ &= solved;
}

const std::vector<StepReport>& BatchedStepper::end() {
  update_velocities();
  for (int rod = 0; rod < rods_.rods; ++rod) reports_[static_cast<std::size_t>(rod)].balanced = keeps_balance(rod);
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
  for (std::size_t s = 0; s < rods_.free.size(); ++s)
    rods_.free[s] = {rods_.segments[s].position, rods_.segments[s].orientation};
  if (!momentum_tolerance_) forget_multipliers(sound_);
}

void BatchedStepper::forget_multipliers(const LaneMask& where) {
  const Lane zero{};
  for (BatchedJoint& joint : rods_.joints)
    for (Lane& row : joint.lambda.row) row = where ? zero : row;
}

// FreeFlight::extrapolate().
void BatchedStepper::start_from_last_step() {
  const Lane dt = all_lanes(settings_.dt), twice = all_lanes(2);
  for (std::size_t s = 0; s < rods_.segments.size(); ++s) {
    BatchedSegment& segment = rods_.segments[s];
    Motion& before = before_[s];
    const Motion now = {segment.velocity, segment.angular_velocity};
    if (!segment.is_static && has_before_ && !rods_.joints.empty()) {
      const LaneVector velocity = twice * now.velocity - before.velocity, spin = twice * now.spin - before.spin;
      segment.position = select(sound_, segment.old_position + dt * velocity, segment.position);
      segment.orientation = select(sound_, rotated(segment.old_orientation, dt * spin), segment.orientation);
    }
    before = now;
  }
  has_before_ = true;
}

void BatchedStepper::take_back(const LaneMask& rods) {
  if (!any(rods)) return;
  for (std::size_t s = 0; s < rods_.segments.size(); ++s) {
    BatchedSegment& segment = rods_.segments[s];
    segment.position = select(rods, rods_.free[s].position, segment.position);
    segment.orientation = select(rods, rods_.free[s].orientation, segment.orientation);
  }
  forget_multipliers(rods);
  balanced_ &= ~rods;
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
