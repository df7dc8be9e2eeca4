#include "runner/plan/plan.hpp"

#include <algorithm>

#include "runner/specs/scene_keys.hpp"
#include "runner/specs/solve_keys.hpp"
#include "solver/numbers/counter_random.hpp"

namespace rodsweep {
namespace {

constexpr std::int64_t most_tasks = 1000000;
constexpr double most_rows = 1e15;  // of a dataset: far above any disk, far below overflow

/// The product of `factors`, capped at 2 * most_rows.
std::int64_t product(std::initializer_list<std::int64_t> factors) {
  double all = 1;
  for (const std::int64_t factor : factors) all *= static_cast<double>(factor);
  return static_cast<std::int64_t>(std::min(all, 2 * most_rows));
}

JobError too_large(const Job& job) {
  return job_error(job.path, "", "this job is too large: more than {} tasks or {} rows", most_tasks, most_rows);
}

/// The number of parameter points. Throws JobError if too large.
std::int64_t point_count(const SweepSpace& space, const Job& job) {
  const std::int64_t points = space.grid_points();
  if (static_cast<double>(points) * static_cast<double>(job.samples) <= most_tasks) return points * job.samples;
  throw job_error(job.path, "", "{} grid points with {} samples each are too many tasks; must be at most {}", points,
                  job.samples, most_tasks);
}

}  // namespace

const std::vector<double>& tolerance_ladder() {
  static const std::vector<double> ladder{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  return ladder;
}

void size_rows(Task& task, const SceneSpec& scene, const TimeSpec& time, const OutputSpec& output) {
  const int rods = rod_count(scene);
  task.segments = segment_count(scene);
  task.joints = joint_count(scene);
  task.steps = time.steps;
  task.frames = output.trajectory_every > 0 ? 1 + task.steps / output.trajectory_every : 0;
  if (time.until && task.frames > 0 && task.steps % output.trajectory_every != 0) ++task.frames;  // at rest
  const std::int64_t stored = task.steps * output.stored_iterations(time.newton_iterations);
  const auto set = [&](Rows kind, std::initializer_list<std::int64_t> factors) {
    task.rows[kind].count = product(factors);
  };
  set(Rows::task, {1});
  set(Rows::step, {task.steps});
  set(Rows::contact_step, {task.rows[Rows::contact_task].count, task.steps});
  set(Rows::solve, {output.solves ? task.steps : 0, time.newton_iterations, rods});
  set(Rows::frame_segment, {task.frames, task.segments});
  set(Rows::segment, {task.frames > 0 ? task.segments : 0});
  set(Rows::force_step, {output.forces ? task.steps : 0});
  set(Rows::frame_joint, {output.forces ? task.frames : 0, task.joints});
  set(Rows::joint, {output.forces && task.frames > 0 ? task.joints : 0});
  set(Rows::state_segment, {output.states ? task.frames : 0, task.segments});
  set(Rows::state_joint, {output.states ? task.frames : 0, task.joints});
  set(Rows::system, {stored, rods});
  set(Rows::system_segment, {stored, task.segments});
  set(Rows::system_joint, {stored, task.joints});
}

Plan::Plan(Job job)
    : job_(std::move(job)),
      space_(job_.values, job_.path),
      guess_labels_(rodsweep::guess_labels(job_.guesses())),
      task_time_limit_s_(job_.values["task_time_limit_s"]) {
  expand();
}

/// Checks every parameter point and adds its tasks. Builds the scene of each first sample, up to some 50 ms in all.
void Plan::expand() {
  constexpr std::int64_t most_built = 100'000;
  std::int64_t built = 0;
  const std::int64_t points = point_count(space_, job_);
  const OutputSpec output = output_spec(job_.values["record"]);
  bool contact = false, balance = false;
  Point values;
  for (std::int64_t point = 0; point < points; ++point) {
    fill(values, point);
    const SceneSpec scene = scene_spec(values, job_);
    check_scene(scene, job_);
    if (point % job_.samples == 0 && (built += segment_count(scene)) <= most_built) check_built(scene, job_);
    check_method(values, guess_labels_, job_);
    check_output(output, values, job_);
    contact = contact || rod_parameters(scene).contact;
    const TimeSpec time = time_spec(values, job_);
    balance = balance || time.balance;
    Task task;
    task.point = point;
    task.sample = point % job_.samples;
    task.rows[Rows::contact_task].count = 1;
    size_rows(task, scene, time, output);
    task.rows[Rows::balanced_segment].count = task.rows[Rows::system_segment].count;
    task.cost = static_cast<double>(task.segments) * time.steps * time.newton_iterations;
    const bool own_trajectories =
        evaluation(values) == Evaluation::closed_loop && solve_spec(values, job_).method == Method::cg;
    const int copies = own_trajectories ? static_cast<int>(guess_labels_.size()) : 1;
    for (int copy = 0; copy < copies; ++copy) {
      task.own_guess = own_trajectories ? copy : -1;
      add(task);
    }
  }
  if (!contact) tasks_.drop(Rows::contact_task), tasks_.drop(Rows::contact_step);
  if (!balance) tasks_.drop(Rows::balanced_segment);
}

void Plan::add(const Task& task) {
  tasks_.add(task);
  max_frames_ = std::max(max_frames_, task.frames);
  const auto& rows = tasks_.rows();
  if (size() > most_tasks ||
      std::any_of(rows.begin(), rows.end(), [](std::int64_t count) { return static_cast<double>(count) > most_rows; }))
    throw too_large(job_);
}

Plan Plan::single_task(std::int64_t index, int trajectory_every) const {
  Plan plan(*this);
  plan.task_alone_ = index;
  for (const ParameterColumn& column : parameters()) plan.kept_.push_back(column.path);
  plan.job_.values["record"]["trajectory_every"] = trajectory_every;
  plan.tasks_ = TaskList();
  plan.max_frames_ = 0;
  Task task = tasks_.at(index);
  const TaskSpec spec = this->spec(index);
  size_rows(task, spec.scene, spec.time, output_spec(plan.job_.values["record"]));
  plan.add(task);
  return plan;
}

void Plan::fill(Point& point, std::int64_t index) const {
  space_.fill(point, index / job_.samples, index % job_.samples);
}

TaskSpec Plan::spec(std::int64_t index) const {
  const Task task = tasks_.at(index);
  Point point;
  fill(point, task.point);
  TaskSpec spec;
  spec.scene = scene_spec(point, job_);
  spec.start = start_spec(point, job_);
  spec.time = time_spec(point, job_);
  spec.solve = solve_spec(point, job_);
  spec.evaluation = evaluation(point);
  if (spec.solve.method == Method::cg) spec.guesses = guess_specs(point, guess_labels_, job_);
  spec.own_guess = task.own_guess;
  spec.output = output_spec(job_.values["record"]);
  spec.seed = random_bits(job_.seed, static_cast<std::uint64_t>(task.sample), random_stream("guesses"));
  spec.time_limit_s = task_time_limit_s_;
  return spec;
}

SceneSpec scene_spec(const Point& point, const Job& job) {
  auto scene = kind_named<SceneSpec>(point.text("scene.type"));
  scene_keys().fill(scene, {point, job, "scene"});
  return scene;
}

void check_scene(const SceneSpec& scene, const Job& job) {
  const OpenRod* rod = open_rod(scene);
  if (rod && segment_count(scene) < 2) {
    throw job_error(
        job.path, "scene.segments",

        "{} is not allowed with clamp \"{}\": there is no joint; must be at least 2, or 1 with clamp \"wall\"",
        rod->segments, rod->clamp == Clamp::free ? "free" : "segment");
  }
  try {
    validate(scene);
  } catch (const SceneError& error) {
    throw job_error(job.path, "scene", error.what());
  }
}

void check_built(const SceneSpec& scene, const Job& job) {
  try {
    build_scene(scene);
  } catch (const SceneError& error) {
    throw job_error(job.path, "scene", error.what());
  }
}

}  // namespace rodsweep
