#include "runner/experiment/evaluation.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "runner/dataset/system_recording.hpp"
#include "runner/experiment/measured_solve.hpp"
#include "runner/experiment/projections.hpp"
#include "runner/file/state_rows.hpp"
#include "solver/observables.hpp"
#include "solver/stopwatch.hpp"
#include "solver/time_step.hpp"

namespace rodsweep {
namespace {

constexpr double meaningless_gap = 100;  // joint lengths: the simulation has blown up

TaskOutcome outcome_of(SolveOutcome solve) {
  switch (solve) {
    case SolveOutcome::indefinite: return TaskOutcome::indefinite;
    case SolveOutcome::not_a_number: return TaskOutcome::not_a_number;
    case SolveOutcome::iteration_limit: return TaskOutcome::iteration_limit;
    case SolveOutcome::diverged: return TaskOutcome::diverged;
    default: return TaskOutcome::ok;
  }
}

std::string number(double value) { return std::to_string(value); }

/// Writes the observables of one finished step into row `step` of /steps.
void record_step(TaskRecord& record, std::size_t step, const Scene& scene, const StepReport& report,
                 double constraint_dt, double initial_length) {
  double length = 0, gap = 0, residual = 0, kinetic = 0, potential = 0, elastic = 0;
  Vector3 momentum = Vector3::Zero(), spin = Vector3::Zero();
  for (const Rod& rod : scene.rods) {
    length += rod_length(rod);
    gap = std::max(gap, joint_gap(rod));
    residual = std::max(residual, newton_residual(rod, constraint_dt));
    kinetic += kinetic_energy(rod);
    potential += gravitational_energy(rod, scene.gravity_m_s2);
    elastic += elastic_energy(rod);
    momentum += linear_momentum(rod);
    spin += angular_momentum(rod);
  }
  record.time_s[step] = scene.time_s;
  record.length_drift[step] = length / initial_length - 1;
  record.joint_gap[step] = gap;
  record.kinetic_energy_j[step] = kinetic;
  record.potential_energy_j[step] = potential;
  record.elastic_energy_j[step] = elastic;
  for (std::size_t i = 0; i < 3; ++i) {
    record.momentum_kg_m_s[3 * step + i] = momentum[static_cast<Eigen::Index>(i)];
    record.angular_momentum_kg_m2_s[3 * step + i] = spin[static_cast<Eigen::Index>(i)];
  }
  record.newton_iterations[step] = static_cast<std::int16_t>(report.newton_iterations);
  record.step_newton_residual[step] = residual;
}

void record_frame(TaskRecord& record, const Task& task, std::size_t frame, const Scene& scene) {
  const std::size_t first = frame * static_cast<std::size_t>(task.segments);
  record.first_row[frame] = task.first_frame_row + static_cast<std::int64_t>(first);
  record.frame_time_s[frame] = scene.time_s;
  std::size_t row = first;
  for (const Rod& rod : scene.rods) {
    store(rod.position, record.position_m.data() + 3 * row);
    store(rod.orientation, record.orientation.data() + 4 * row);
    row += rod.segments.size();
  }
}

void record_segments(TaskRecord& record, const Scene& scene) {
  std::size_t row = 0;
  for (std::size_t rod = 0; rod < scene.rods.size(); ++rod) {
    for (const Segment& segment : scene.rods[rod].segments) {
      record.segment_length_m[row] = segment.length_m;
      record.segment_radius_m[row] = segment.radius_m;
      record.segment_rod[row] = static_cast<std::int16_t>(rod);
      record.segment_static[row] = segment.is_static ? 1 : 0;
      ++row;
    }
  }
}

/// Runs the steps; sets outcome and message. Returns false when abandoned.
bool simulate(const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested& stop,
              const Stopwatch& watch) {
  Scene scene = build_scene(spec.scene);
  double initial_length = 0;
  for (const Rod& rod : scene.rods) initial_length += rod_length(rod);

  MeasuredSolve solve(scene, spec, record);
  std::optional<RecordingSolve> recording;
  if (const int iterations = spec.record.recorded_iterations(spec.time.newton_iterations); iterations > 0)
    recording.emplace(scene, iterations, solve, record);
  const std::unique_ptr<Projection> projection =
      make_projection(scene, spec, record, recording ? static_cast<LinearSolve&>(*recording) : solve);
  TimeStepper stepper(scene, {spec.time.step_s, spec.time.newton_iterations, spec.time.newton_tolerance});
  const int every = spec.record.trajectory_every;
  if (every > 0) {
    record_segments(record, scene);
    record_frame(record, task, 0, scene);
  }

  record.outcome = TaskOutcome::ok;
  record.steps_done[0] = 0;
  const auto fail = [&record](TaskOutcome outcome, const std::string& why) {
    record.outcome = outcome;
    record.message = why;
  };
  for (int step = 0; step < spec.time.steps; ++step) {
    if (stop && stop()) return false;
    if (spec.time_limit_s > 0 && watch.seconds() > spec.time_limit_s) {
      fail(TaskOutcome::timed_out, "step " + std::to_string(step) + ": the limit task_time_limit_s of " +
                                       number(spec.time_limit_s) + " s has passed");
      break;
    }
    solve.take_elapsed_s();
    const Stopwatch step_watch;
    const StepReport report = stepper.step(*projection);
    record.rest_s[static_cast<std::size_t>(step)] = static_cast<float>(step_watch.seconds() - solve.take_elapsed_s());

    const std::string where = "step " + std::to_string(step) + ": ";
    if (report.outcome == SolveOutcome::iteration_limit && record.outcome == TaskOutcome::ok)
      fail(TaskOutcome::iteration_limit,
           where + "a solve that advances the rod hit its iteration limit (and others may)");
    else if (report.outcome != SolveOutcome::converged && report.outcome != SolveOutcome::iteration_limit) {
      fail(outcome_of(report.outcome), where + projection_failed(spec.solve.method) + to_string(report.outcome));
      break;
    }
    record_step(record, static_cast<std::size_t>(step), scene, report, stepper.constraint_dt(), initial_length);
    record.steps_done[0] = step + 1;
    if (every > 0 && (step + 1) % every == 0)
      record_frame(record, task, static_cast<std::size_t>((step + 1) / every), scene);

    const double gap = record.joint_gap[static_cast<std::size_t>(step)];
    const bool finite = std::all_of(scene.rods.begin(), scene.rods.end(), [](const Rod& r) { return is_finite(r); });
    if (!finite) {
      fail(TaskOutcome::not_a_number, where + "the rod's state is not finite");
      break;
    }
    if (gap > meaningless_gap) {
      fail(TaskOutcome::diverged, where + "a joint is open by " + number(gap) + " joint lengths");
      break;
    }
  }
  solve.finish();
  return true;
}

}  // namespace

bool evaluate(const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested& stop) {
  const Stopwatch watch;
  bool finished = true;
  try {
    finished = simulate(task, spec, record, stop, watch);
  } catch (const std::exception& error) {
    record.outcome = TaskOutcome::error;
    record.message = error.what();
  }
  record.elapsed_s[0] = watch.seconds();
  return finished;
}

}  // namespace rodsweep
