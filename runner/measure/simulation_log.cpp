#include "runner/measure/simulation_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "runner/measure/projections.hpp"
#include "solver/numbers/narrow.hpp"
#include "solver/rod/rod_arrays.hpp"
#include "solver/step/observables.hpp"

namespace rodsweep {
namespace {

// Upper bounds of the joint gap, in joint lengths.
constexpr double whole_rod = 1, meaningless_gap = 100;

TaskOutcome outcome_of(SolveOutcome solve) {
  switch (solve) {
    case SolveOutcome::indefinite: return TaskOutcome::indefinite;
    case SolveOutcome::not_a_number: return TaskOutcome::not_a_number;
    case SolveOutcome::iteration_limit: return TaskOutcome::iteration_limit;
    case SolveOutcome::diverged: return TaskOutcome::diverged;
    default: return TaskOutcome::ok;
  }
}

/// Logs the constant properties of the segments in a trajectory's frames.
void log_segments(const Scene& scene, TaskRecord& record) {
  std::size_t row = 0;
  for (std::size_t rod = 0; rod < scene.rods.size(); ++rod) {
    for (const Segment& segment : scene.rods[rod].segments) {
      record.trajectories.segments.length_m[row] = segment.length_m;
      record.trajectories.segments.radius_m[row] = segment.radius_m;
      record.trajectories.segments.rod[row] = narrow<std::int16_t>(static_cast<std::int64_t>(rod));
      record.trajectories.segments.is_static[row] = segment.is_static ? 1 : 0;
      ++row;
    }
  }
}

/// Logs the segments of each joint.
void log_ends(const Scene& scene, TaskRecord& record) {
  std::size_t row = 0;
  int first = 0;
  for (const Rod& rod : scene.rods) {
    for (const Joint& joint : rod.joints) {
      record.trajectories.joints.first[row] = first + joint.a;
      record.trajectories.joints.second[row] = first + joint.b;
      ++row;
    }
    first += rod.segment_count();
  }
}

void put(const Vector3& vector, Cells<double>& column, std::size_t row) {
  for (std::size_t i = 0; i < 3; ++i) column(row, i) = vector[static_cast<Eigen::Index>(i)];
}

constexpr const char* slip = " turned past half a turn, where its torque changes sign: use more segments";

/// The turns in a step [rad] up to which motions were found right: of a body whose spin term is explicit, and of a rod
/// that rolls.
constexpr double most_tumbled = 1, most_rolled = 7;

/// To one digit, so that tasks that say nearly the same say it in the same words.
double rounded_down(double value) {
  const double digit = std::pow(10, std::floor(std::log10(value)));
  return digit * std::floor(value / digit);
}

}  // namespace

void end_late(const TaskSpec& spec, TaskRecord& record, const std::string& where) {
  int& step = record.tasks.steps_done[0];
  step = std::max(step, 0);  // the negative fill value until the scene is built
  record.outcome = TaskOutcome::timed_out;
  record.message =
      fmt::format("step {}: the time limit of {:g} s has passed (task_time_limit_s or --task-time-limit){}{}", step,
                  spec.time_limit_s, where.empty() ? "" : " in ", where);
}

SimulationLog::SimulationLog(const Task& task, const TaskSpec& spec, TaskRecord& record, const Scene& scene,
                             const TimeStepper& stepper)
    : task_(task), spec_(spec), record_(record), stepper_(stepper) {
  for (const Rod& rod : scene.rods) {
    initial_length_ += rod_length(rod);
    observed_.push_back({Linearization(rod), MomentumBalance(rod), {}});
    linearize(rod, observed_.back().at);
  }
  record_.outcome = TaskOutcome::ok;
  record_.tasks.steps_done[0] = 0;
  if (spec_.output.trajectory_every > 0) {
    log_segments(scene, record_);
    if (spec_.output.forces) log_ends(scene, record_);
    log_frame(0, scene);
  }
}

/// Writes the observables of a finished step to row `step` of /steps.
void SimulationLog::log_step(std::size_t step, const Scene& scene, const StepReport& report) {
  double length = 0, gap = 0, residual = 0, imbalance = 0, kinetic = 0, potential = 0, elastic = 0, open = 0;
  Vector3 momentum = Vector3::Zero(), spin = Vector3::Zero();
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    const Rod& rod = scene.rods[r];
    auto& [at, balance, before] = observed_[r];
    before = at.constraint;
    linearize(rod, at);
    balance_momentum(rod, at, balance);
    length += rod_length(rod);
    gap = std::max(gap, joint_gap(rod));
    residual = larger_or_nan(residual, newton_residual(rod, at, rod.constraint_dt));
    imbalance = larger_or_nan(imbalance, balance.residual);
    kinetic += kinetic_energy(rod);
    potential += gravitational_energy(rod, scene.gravity_at(scene.time_s));
    elastic += elastic_energy(rod, at);
    open += gap_energy(rod, at);
    momentum += linear_momentum(rod);
    spin += angular_momentum(rod);
  }
  record_.steps.time_s[step] = scene.time_s;
  record_.steps.length_drift[step] = length / initial_length_ - 1;
  record_.steps.joint_gap[step] = gap;
  record_.steps.kinetic_energy_j[step] = kinetic;
  record_.steps.potential_energy_j[step] = potential;
  record_.steps.elastic_energy_j[step] = elastic;
  record_.steps.gap_energy_j[step] = open;
  put(momentum, record_.steps.momentum_kg_m_s, step);
  put(spin, record_.steps.angular_momentum_kg_m2_s, step);
  if (spec_.output.forces) log_reactions(step);
  record_.steps.newton_iterations[step] = static_cast<std::int16_t>(report.newton_iterations);
  record_.steps.newton_residual[step] = residual;
  record_.steps.momentum_residual[step] = imbalance;
  record_.tasks.momentum_residual[0] = std::fmax(record_.tasks.momentum_residual[0], imbalance);
  if (!scene.contact) return;
  record_.steps.contacts[step] = report.contacts;
  record_.steps.penetration[step] = report.penetration;
  record_.steps.contact_residual[step] = report.contact_residual;
  record_.tasks.penetration[0] = std::fmax(record_.tasks.penetration[0], report.penetration);
}

bool SimulationLog::out_of_time(double elapsed_s) {
  if (spec_.time_limit_s <= 0 || elapsed_s <= spec_.time_limit_s) return false;
  end_late(spec_, record_);
  return true;
}

bool SimulationLog::finish_step(int step, const Scene& scene, const StepReport& report) {
  if (report.outcome == SolveOutcome::iteration_limit && record_.outcome == TaskOutcome::ok)
    fail(TaskOutcome::iteration_limit, step, "a solve that advances the rod hit its iteration limit (and others may)");
  else if (report.outcome != SolveOutcome::converged && report.outcome != SolveOutcome::iteration_limit) {
    fail(outcome_of(report.outcome), step,
         projection_failed(spec_.solve.method) + std::string(to_string(report.outcome)));
    return false;
  }
  if (spec_.time.balance && solves_systems(spec_.solve.method) && !report.balanced) ++unbalanced_;
  const auto row = static_cast<std::size_t>(step);
  log_step(row, scene, report);
  record_.tasks.steps_done[0] = step + 1;
  const int every = spec_.output.trajectory_every;
  if (every > 0 && (step + 1) % every == 0) log_frame(static_cast<std::size_t>((step + 1) / every), scene);

  if (!std::all_of(scene.rods.begin(), scene.rods.end(), [](const Rod& rod) { return is_finite(rod); })) {
    fail(TaskOutcome::not_a_number, step, "the rod's state is not finite");
    return false;
  }
  if (const double gap = record_.steps.joint_gap[row]; gap > whole_rod) {
    fail(gap > meaningless_gap ? TaskOutcome::diverged : TaskOutcome::torn, step,
         "a joint is open by " + std::to_string(gap) + " joint lengths");
    return false;
  }
  if (const std::string joint = slipped_ ? "" : slipped_joint(); !joint.empty()) {
    slipped_ = true;
    if (!scene.clamps.empty()) {  // a prescribed turn is lost
      fail(TaskOutcome::torn, step, joint + slip);
      return false;
    }
  }
  note_turns(scene);
  return true;
}

void SimulationLog::finish_at_rest(int step, const Scene& scene) {
  const int every = spec_.output.trajectory_every;
  if (every > 0 && (step + 1) % every != 0) log_frame(static_cast<std::size_t>((step + 1) / every + 1), scene);
  lacking_ = 0;
}

void SimulationLog::finish() {
  if (record_.outcome == TaskOutcome::ok) record_.message = warnings();
}

/// A joint whose rotation from rest passed half a turn in the last step, where the torque changes its sign; "" if none.
/// With d = (w, C / 2), w >= 0, before and after: the shorter way between them is the one through half a turn if the
/// product of the two is negative.
std::string SimulationLog::slipped_joint() const {
  const auto w = [](const Vector3& c) { return std::sqrt(std::max(0.0, 1 - c.squaredNorm() / 4)); };
  for (std::size_t r = 0; r < observed_.size(); ++r) {
    const VectorX &after = observed_[r].at.constraint, &before = observed_[r].before;
    for (Eigen::Index row = 3; row < after.size(); row += 6) {
      const Vector3 c = after.segment<3>(row), old = before.segment<3>(row);
      if (w(c) * w(old) + c.dot(old) / 4 < 0) return fmt::format("joint {} of rod {}", row / 6, r);
    }
  }
  return "";
}

void SimulationLog::note_turns(const Scene& scene) {
  for (const Rod& rod : scene.rods)
    for (std::size_t s = 0; s < rod.segments.size(); ++s) {
      const Vector3 turn = spec_.time.step_s * rod.angular_velocity[s], axis = rod.orientation[s] * Vector3::UnitZ();
      tumbled_ = std::max(tumbled_, turn.cross(axis).norm());
      if (scene.contact) rolled_ = std::max(rolled_, std::abs(turn.dot(axis)));
    }
}

std::string SimulationLog::warnings() const {
  std::vector<std::string> all;
  if (slipped_) all.push_back(std::string("a joint") + slip);
  if (const double excess = std::max(tumbled_ / most_tumbled, rolled_ / most_rolled); excess > 1) {
    const bool rolls = rolled_ / most_rolled == excess;
    all.push_back(fmt::format(
        "a segment turned by more than {:g} rad {} in a step, where its motion is wrong: use a step_s of {:g}",
        rolls ? most_rolled : most_tumbled, rolls ? "about its axis, in contact," : "across its axis",
        rounded_down(spec_.time.step_s / excess)));
  }
  if (lacking_ > 0)
    all.push_back(fmt::format("not at rest: a segment lacks {:.0e} of the largest force: use more steps", lacking_));
  if (unbalanced_ > 0)
    all.push_back(fmt::format("{:g} % of the steps do not balance momentum",
                              std::max(1.0, rounded_down(100.0 * unbalanced_ / static_cast<double>(task_.steps)))));
  return fmt::format("{}", fmt::join(all, "; "));
}

void SimulationLog::fail(TaskOutcome outcome, int step, const std::string& why) {
  record_.outcome = outcome;
  record_.message = "step " + std::to_string(step) + ": " + why;
}

void SimulationLog::log_frame(std::size_t frame, const Scene& scene) {
  const std::size_t first = frame * static_cast<std::size_t>(task_.segments);
  record_.trajectories.first_row[frame] = task_.rows[Rows::frame_segment].first + static_cast<std::int64_t>(first);
  record_.trajectories.time_s[frame] = scene.time_s;
  std::size_t row = first;
  for (const Rod& rod : scene.rods) {
    store(rod.position, record_.trajectories.position_m.row(row));
    store(rod.orientation, record_.trajectories.orientation.row(row));
    row += rod.segments.size();
  }
  if (spec_.output.forces) log_joints(frame, scene);
  if (spec_.output.states) log_state(frame, scene);
}

void SimulationLog::log_state(std::size_t frame, const Scene& scene) {
  TaskRecord::Trajectories::States& states = record_.trajectories.states;
  std::size_t row = frame * static_cast<std::size_t>(task_.segments),
              joint = frame * static_cast<std::size_t>(task_.joints);
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    const Rod& rod = scene.rods[r];
    store(rod.velocity, states.velocity_m_s.row(row));
    store(rod.angular_velocity, states.angular_velocity_rad_s.row(row));
    const RodMotion before = stepper_.before(static_cast<int>(r));
    if (!before.position.empty()) {
      store(before.position, states.before_position_m.row(row));
      store(before.orientation, states.before_orientation.row(row));
      store(before.velocity, states.before_velocity_m_s.row(row));
      store(before.angular_velocity, states.before_angular_velocity_rad_s.row(row));
    }
    if (rod.joint_count() > 0) std::copy(rod.lambda.begin(), rod.lambda.end(), states.lambda.row(joint));
    row += rod.segments.size();
    joint += rod.joints.size();
  }
}

void SimulationLog::log_reactions(std::size_t step) {
  const Reactions reactions = stepper_.reactions();
  put(reactions.clamps.force_n, record_.steps.clamp_force_n, step);
  put(reactions.clamps.moment_nm, record_.steps.clamp_moment_nm, step);
  put(reactions.obstacles.force_n, record_.steps.obstacle_force_n, step);
}

void SimulationLog::log_joints(std::size_t frame, const Scene& scene) {
  std::size_t row = frame * static_cast<std::size_t>(task_.joints);
  for (const Rod& rod : scene.rods)
    for (int k = 0; k < rod.joint_count(); ++k, ++row) {
      const Joint& joint = rod.joints[at(k)];
      const Action action = joint_action(rod, k);
      put((point_on_a(rod, joint) + point_on_b(rod, joint)) / 2, record_.trajectories.joint_position_m, row);
      put(action.force_n, record_.trajectories.joint_force_n, row);
      put(action.moment_nm, record_.trajectories.joint_moment_nm, row);
    }
}

}  // namespace rodsweep
