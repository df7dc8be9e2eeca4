#include "runner/measure/start_state.hpp"

#include <cmath>
#include <utility>

#include "runner/file/file_error.hpp"
#include "runner/file/task_reader.hpp"
#include "solver/rod/rod_arrays.hpp"

namespace rodsweep {
namespace {

constexpr const char* how = "; run its job with \"record\": {\"trajectory_every\": ..., \"states\": true}";

/// Keeps the last one, since tasks that follow each other often start alike.
std::shared_ptr<const TaskRecord> shared_record(const StartSpec& spec) {
  static std::pair<std::filesystem::path, int> of;
  static std::shared_ptr<const TaskRecord> shared;
  if (shared && of == std::pair(spec.file, spec.task)) return shared;
  const TaskReader reader(spec.file, TaskReader::Times::left_out);
  const auto count = static_cast<std::int64_t>(reader.tasks().size());
  if (spec.task >= count)
    throw FileError("{} has no task {}: it has {} tasks, from 0", spec.file.native(), spec.task, count);
  if (const TaskOutcome outcome = reader.outcome(spec.task); outcome != TaskOutcome::ok)
    throw FileError("task {} of {} is not ok but {}", spec.task, spec.file.native(), to_string(outcome));
  auto record = std::make_shared<TaskRecord>();
  if (!reader.read(spec.task, *record))
    throw FileError("task {} of {} is damaged: its checksum is wrong", spec.task, spec.file.native());
  of = {spec.file, spec.task};
  return shared = record;
}

/// Of the time, or of the last frame.
std::size_t frame_of(const TaskRecord& record, const StartSpec& spec) {
  constexpr double rounding_s = 1e-9;
  const auto& times_s = record.trajectories.time_s;
  const auto& rows = record.trajectories.first_row;
  std::size_t count = 0;
  while (count < rows.size() && rows[count] >= 0) ++count;
  if (count == 0 || record.trajectories.states.velocity_m_s.empty())
    throw FileError("task {} of {} has no states{}", spec.task, spec.file.native(), how);
  if (!spec.time_s) return count - 1;
  std::size_t nearest = 0;
  for (std::size_t frame = 0; frame < count; ++frame)
    if (std::abs(times_s[frame] - *spec.time_s) < std::abs(times_s[nearest] - *spec.time_s)) nearest = frame;
  if (std::abs(times_s[nearest] - *spec.time_s) > rounding_s * (1 + *spec.time_s))
    throw FileError("task {} of {} has no frame at {:g} s; the nearest is at {:.10g} s", spec.task, spec.file.native(),
                    *spec.time_s, times_s[nearest]);
  return nearest;
}

/// Joints of a frame; the axis of frames may be longer than those of this task.
std::size_t joints_of(const TaskRecord& record) {
  const auto& states = record.trajectories.states;
  const std::size_t frames = states.velocity_m_s.size() / 3 / record.trajectories.segments.length_m.size();
  return states.lambda.size() / 6 / frames;
}

/// The frame must be of these segments and joints; which joint is where follows from the scene.
void compare(const Scene& scene, const TaskRecord& record, const StartSpec& spec) {
  const auto& segments = record.trajectories.segments;
  std::size_t row = 0, joints = 0;
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    joints += scene.rods[r].joints.size();
    for (const Segment& segment : scene.rods[r].segments) {
      const bool same = row < segments.length_m.size() && segments.rod[row] == static_cast<int>(r) &&
                        (segments.is_static[row] != 0) == segment.is_static &&
                        std::abs(segments.length_m[row] - segment.length_m) <= 1e-9 * segment.length_m;
      if (!same)
        throw FileError("task {} of {} has other segments than this scene, from segment {} on", spec.task,
                        spec.file.native(), row);
      ++row;
    }
  }
  const std::size_t had = joints_of(record);
  if (row != segments.length_m.size() || joints != had)
    throw FileError("task {} of {} has {} segments and {} joints; this scene has {} and {}", spec.task,
                    spec.file.native(), segments.length_m.size(), had, row, joints);
}

}  // namespace

StartState::StartState(const StartSpec& spec, Scene& scene) : StartState(shared_record(spec), spec, scene) {}

StartState::StartState(std::shared_ptr<const TaskRecord> record, const StartSpec& spec, Scene& scene)
    : record_(std::move(record)), scene_(scene) {
  const auto& frames = record_->trajectories;
  const std::size_t frame = frame_of(*record_, spec);
  compare(scene, *record_, spec);
  std::size_t joint = frame * joints_of(*record_);
  std::size_t row = first_segment_ = frame * frames.segments.length_m.size();
  for (Rod& rod : scene.rods) {
    const std::size_t count = rod.segments.size();
    load(frames.position_m.row(row), count, rod.position);
    load(frames.orientation.row(row), count, rod.orientation);
    load(frames.states.velocity_m_s.row(row), count, rod.velocity);
    load(frames.states.angular_velocity_rad_s.row(row), count, rod.angular_velocity);
    if (rod.joint_count() > 0) rod.lambda = VectorX::Map(frames.states.lambda.row(joint), rod.lambda.size());
    row += count;
    joint += rod.joints.size();
  }
  scene.time_s = spec.clock_s.value_or(frames.time_s[frame]);
}

void StartState::continue_steps(TimeStepper& stepper) const {
  const auto& states = record_->trajectories.states;
  std::size_t row = first_segment_;
  for (std::size_t r = 0; r < scene_.rods.size(); ++r) {
    const std::size_t count = scene_.rods[r].segments.size();
    RodMotion before;
    load(states.before_position_m.row(row), count, before.position);
    load(states.before_orientation.row(row), count, before.orientation);
    load(states.before_velocity_m_s.row(row), count, before.velocity);
    load(states.before_angular_velocity_rad_s.row(row), count, before.angular_velocity);
    if (before.position[0].allFinite()) stepper.continue_from(static_cast<int>(r), before);
    row += count;
  }
}

}  // namespace rodsweep
