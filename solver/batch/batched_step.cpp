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
      history_(rods_.segments.size()),
      h_(settings.dt),
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
  remember();
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

// FreeFlight::start().
void BatchedStepper::remember() {
  known_ = std::min(known_ + 1, 2);
  const bool uses_two_steps = settings_.integrator == Integrator::bdf2 && known_ == 2;
  if (const double h = implicit_dt(settings_.dt, uses_two_steps); h != h_) rods_.set_step(h_ = h);
  for (std::size_t s = 0; s < rods_.segments.size(); ++s) {
    const BatchedSegment& segment = rods_.segments[s];
    History& history = history_[s];
    history.before = history.now;
    history.now = {segment.position, segment.orientation, segment.velocity, segment.angular_velocity};
    history.past = {segment.position, segment.orientation};
    if (uses_two_steps) history.past = past_pose(history.now, history.before);
  }
}

// FreeFlight::predict().
void BatchedStepper::predict() {
  const LaneVector gain = all_lanes(h_) * rods_.gravity;
  const bool uses_two_steps = h_ != settings_.dt;
  for (std::size_t s = 0; s < rods_.segments.size(); ++s) {
    BatchedSegment& segment = rods_.segments[s];
    if (segment.is_static) continue;
    const auto& [now, before, past] = history_[s];
    LaneVector position;
    LaneQuaternion orientation;
    if (uses_two_steps) {
      const Lane h = all_lanes(h_);
      const Flight flight{segment.gyration, rods_.damping, gain};
      position = past.position + h * free_velocity(now, before, flight);
      orientation = rotated(past.orientation, free_turn(now, before, expected(past, now, before, h), flight, h));
    } else {
      const LaneVector turn = gyrated(now.spin, director(now.orientation), h_ * segment.gyration);
      position = now.position + (h_ * rods_.damping) * (now.velocity + gain);
      orientation = rotated(now.orientation, (h_ * rods_.damping) * turn);
    }
    segment.position = select(sound_, position, segment.position);
    segment.orientation = select(sound_, orientation, segment.orientation);
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
  if (known_ < 2 || rods_.joints.empty()) return;
  for (std::size_t s = 0; s < rods_.segments.size(); ++s) {
    BatchedSegment& segment = rods_.segments[s];
    if (segment.is_static) continue;
    const auto& [now, before, past] = history_[s];
    const LaneMotion motion = expected(past, now, before, all_lanes(h_));
    segment.position = select(sound_, motion.position, segment.position);
    segment.orientation = select(sound_, motion.orientation, segment.orientation);
  }
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
  const Lane inverse_h = all_lanes(1 / h_);
  for (std::size_t s = 0; s < rods_.segments.size(); ++s) {
    BatchedSegment& segment = rods_.segments[s];
    const LanePose& past = history_[s].past;
    segment.velocity = select(sound_, inverse_h * (segment.position - past.position), segment.velocity);
    segment.angular_velocity =
        select(sound_, inverse_h * rotation(segment.orientation, past.orientation), segment.angular_velocity);
  }
}

}  // namespace rodsweep
