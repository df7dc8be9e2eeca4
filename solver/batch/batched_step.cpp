#include "solver/batch/batched_step.hpp"

namespace rodsweep {
namespace {

std::optional<BatchedBalance> balance_of(const std::vector<Scene>& scenes, const BatchedRods& rods, bool wanted) {
  return wanted ? std::optional(BatchedBalance(scenes, rods)) : std::nullopt;
}

// FreeFlight::predict() by a step of Euler.
LanePose flown(const LaneMotion& now, const Flight& flight, const Lane& h) {
  const Lane damped = h * flight.damping;
  const LaneVector turn = gyrated(now.spin, director(now.orientation), h * flight.gyration);
  return {now.position + damped * (now.velocity + flight.gain), rotated(now.orientation, damped * turn)};
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
      past_(rods_.segments.size()),
      h_(settings.dt),
      steps_(scenes.size(), 0),
      reports_(scenes.size()) {
  for (int rod = 0; rod < rods_.rods; ++rod) {
    sound_[rod] = -1;
    start_time_s_.push_back(scenes[static_cast<std::size_t>(rod)].time_s);
  }
  if (momentum_tolerance || settings.integrator == Integrator::bdf2) before_.resize(rods_.segments.size());
}

const std::vector<StepReport>& BatchedStepper::step() {
  begin();
  while (linearize()) solve();
  return end();
}

void BatchedStepper::begin() {
  fly();
  running_ = sound_;
  newton_ = 0;
  for (StepReport& report : reports_) report.newton_iterations = 0;
  if (momentum_tolerance_)
    balanced_ = sound_;
  else
    forget_multipliers(sound_);
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

// FreeFlight::start(), predict() and, in balance, extrapolate().
void BatchedStepper::fly() {
  known_ = std::min(known_ + 1, 2);
  uses_two_steps_ = settings_.integrator == Integrator::bdf2 && known_ == 2;
  const bool extrapolates = momentum_tolerance_ && known_ == 2 && !rods_.joints.empty();
  if (const double h = implicit_dt(settings_.dt, uses_two_steps_); h != h_) rods_.set_step(h_ = h);
  const Lane h = all_lanes(h_), damping = rods_.damping;
  const LaneVector gain = h * rods_.gravity;
  const LaneMask sound = sound_;
  for (std::size_t s = 0; s < rods_.segments.size(); ++s) {
    BatchedSegment& segment = rods_.segments[s];
    const LaneMotion now = {segment.position, segment.orientation, segment.velocity, segment.angular_velocity};
    LanePose& past = past_[s];
    past = uses_two_steps_ ? past_pose(now, before_[s]) : LanePose{now.position, now.orientation};
    const auto move = [&](const LaneVector& position, const LaneQuaternion& orientation) {
      segment.position = select(sound, position, now.position);
      segment.orientation = select(sound, orientation, now.orientation);
    };
    if (!segment.is_static) {
      const Flight flight{segment.gyration, damping, gain};
      const LanePose pose = uses_two_steps_
                                ? flown(past, now, before_[s], expected(past, now, before_[s], h), flight, h)
                                : flown(now, flight, h);
      move(pose.position, pose.orientation);
    }
    rods_.free[s] = {segment.position, segment.orientation};
    if (extrapolates && !segment.is_static) {
      const LaneMotion motion = expected(past, now, before_[s], h);
      move(motion.position, motion.orientation);
    }
    if (!before_.empty()) before_[s] = now;
  }
}

void BatchedStepper::forget_multipliers(const LaneMask& where) {
  const Lane zero{};
  for (BatchedJoint& joint : rods_.joints)
    for (Lane& row : joint.lambda.row) row = where ? zero : row;
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
    const LanePose& past = past_[s];
    segment.velocity = select(sound_, inverse_h * (segment.position - past.position), segment.velocity);
    segment.angular_velocity =
        select(sound_, inverse_h * rotation(segment.orientation, past.orientation), segment.angular_velocity);
  }
}

}  // namespace rodsweep
