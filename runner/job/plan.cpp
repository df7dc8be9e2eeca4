#include "runner/job/plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "runner/job/counter_random.hpp"
#include "runner/job/guess_keys.hpp"
#include "runner/job/scene_spec.hpp"
#include "runner/job/task_spec.hpp"

namespace rodsweep {
namespace {

constexpr std::int64_t most_tasks = 1000000;
constexpr double most_rows = 1e15;  // of a dataset: far beyond any disk, far below overflow

}  // namespace

const std::vector<double>& tolerance_ladder() {
  static const std::vector<double> ladder{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  return ladder;
}

Plan::Plan(Job job)
    : job_(std::move(job)), space_(job_.values, job_.path), guess_labels_(rodsweep::guess_labels(job_)) {
  const std::int64_t points = space_.grid_points();
  if (static_cast<double>(points) * static_cast<double>(job_.samples) > most_tasks) {
    throw job_error(job_.path, "",
                    fmt::format("{} grid points with {} samples each are too many tasks; the most is {}", points,
                                job_.samples, most_tasks));
  }
  const RecordSpec record = record_spec(job_);
  Point values;
  for (std::int64_t point = 0; point < points * job_.samples; ++point) {
    fill(values, point);
    const SceneSpec scene = scene_spec(values, job_);
    check_scene(scene, job_);
    check_method(values, job_);
    contact_rows_ = contact_rows_ || rod_parameters(scene).contact;
    const TimeSpec time = time_spec(values, job_);

    Task task;
    task.point = point;
    task.sample = point % job_.samples;
    task.segments = segment_count(scene);
    task.joints = joint_count(scene);
    task.steps = time.steps;
    const int rods = rod_count(scene);
    task.solves = record.solves ? task.steps * time.newton_iterations * rods : 0;
    task.frames = record.trajectory_every > 0 ? 1 + task.steps / record.trajectory_every : 0;
    const std::int64_t recorded = task.steps * record.recorded_iterations(time.newton_iterations);
    task.systems = recorded * rods;
    task.system_segments = recorded * task.segments;
    task.system_joints = recorded * task.joints;
    task.cost = static_cast<double>(task.segments) * time.steps * time.newton_iterations;

    const bool own_trajectories =
        evaluation(values) == Evaluation::closed_loop && solve_spec(values, job_).method == Method::cg;
    const int copies = own_trajectories ? static_cast<int>(guess_labels_.size()) : 1;
    for (int copy = 0; copy < copies; ++copy) {
      task.index = size();
      task.own_guess = own_trajectories ? copy : -1;
      task.first_step = step_rows_;
      task.first_solve = solve_rows_;
      task.first_frame_row = frame_rows_;
      task.first_segment_row = segment_rows_;
      task.first_system = system_rows_;
      task.first_system_segment = system_segment_rows_;
      task.first_system_joint = system_joint_rows_;
      const double frame_rows = static_cast<double>(task.frames) * task.segments + static_cast<double>(frame_rows_);
      const double system_rows = static_cast<double>(task.system_segments) + static_cast<double>(system_segment_rows_);
      if (size() == most_tasks || frame_rows > most_rows || system_rows > most_rows ||
          static_cast<double>(solve_rows_) > most_rows) {
        throw job_error(job_.path, "",
                        fmt::format("this job is too large: more than {} tasks or {} rows", most_tasks, most_rows));
      }
      step_rows_ += task.steps;
      solve_rows_ += task.solves;
      frame_rows_ += task.frames * task.segments;
      segment_rows_ += task.segment_rows();
      max_frames_ = std::max(max_frames_, task.frames);
      system_rows_ += task.systems;
      system_segment_rows_ += task.system_segments;
      system_joint_rows_ += task.system_joints;
      tasks_.push_back(task);
    }
  }
  for (Task& task : tasks_) task.contact_rows = contact_rows_;
}

Plan Plan::alone(std::int64_t index, int trajectory_every) const {
  Plan plan(*this);
  plan.task_alone_ = index;
  for (const ParameterColumn& column : parameters()) plan.kept_.push_back(column.path);
  plan.job_.values["record"]["trajectory_every"] = trajectory_every;
  Task task = tasks_.at(static_cast<std::size_t>(index));
  task.index = task.first_step = task.first_solve = task.first_frame_row = task.first_segment_row = 0;
  task.first_system = task.first_system_segment = task.first_system_joint = 0;
  task.frames = trajectory_every > 0 ? 1 + task.steps / trajectory_every : 0;
  plan.step_rows_ = task.steps;
  plan.solve_rows_ = task.solves;
  plan.frame_rows_ = task.frames * task.segments;
  plan.segment_rows_ = task.segment_rows();
  plan.max_frames_ = task.frames;
  plan.system_rows_ = task.systems;
  plan.system_segment_rows_ = task.system_segments;
  plan.system_joint_rows_ = task.system_joints;
  plan.tasks_ = {task};
  return plan;
}

void Plan::fill(Point& point, std::int64_t index) const {
  space_.fill(point, index / job_.samples, job_.seed, index % job_.samples);
}

TaskSpec Plan::spec(std::int64_t index) const {
  const Task& task = tasks_.at(static_cast<std::size_t>(index));
  Point point;
  fill(point, task.point);
  TaskSpec spec;
  spec.scene = scene_spec(point, job_);
  spec.time = time_spec(point, job_);
  spec.solve = solve_spec(point, job_);
  spec.evaluation = evaluation(point);
  if (spec.solve.method == Method::cg) spec.guesses = guess_specs(point, job_);
  spec.own_guess = task.own_guess;
  spec.record = record_spec(job_);
  spec.seed = random_bits(job_.seed, static_cast<std::uint64_t>(task.sample), random_stream("guesses"));
  spec.time_limit_s = job_.values["task_time_limit_s"];
  return spec;
}

}  // namespace rodsweep
