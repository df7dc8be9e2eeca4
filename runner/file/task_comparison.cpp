#include "runner/file/task_comparison.hpp"

#include <string_view>

#include "runner/file/columns.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/task_reader.hpp"
#include "runner/file/task_table.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// A task's record, and every how many steps it has a frame.
struct Written {
  Task task;
  TaskRecord record;
  std::int64_t every;
};

Written read(const fs::path& path, std::int64_t task, std::int64_t every) {
  const TaskReader file(path, TaskReader::Times::left_out);
  Written written{reading(path, [&] { return file.tasks().at(static_cast<std::size_t>(task)); }), {}, every};
  file.read(task, written.record);  // damaged or not: the comparison tells
  return written;
}

/// Frame by frame, where both have one of the same step.
bool same_frames(const Written& a, std::string_view bytes_a, const Written& b, std::string_view bytes_b) {
  const std::size_t frame_bytes = bytes_a.size() / static_cast<std::size_t>(a.task.frames);
  const auto of_frame = [&](std::string_view bytes, std::int64_t frame) {
    return bytes.substr(static_cast<std::size_t>(frame) * frame_bytes, frame_bytes);
  };
  for (std::int64_t frame = 0; frame < a.task.frames; ++frame) {
    const std::int64_t step = frame * a.every, other = step / b.every;
    if (step % b.every != 0 || other >= b.task.frames) continue;
    if (of_frame(bytes_a, frame) != of_frame(bytes_b, other)) return false;
  }
  return true;
}

void compare_results(const Written& a, const Written& b, TaskComparison& result) {
  for (const Column& column : columns()) {
    const std::string_view bytes_a = bytes_of(column, a.record), bytes_b = bytes_of(column, b.record);
    if (is_timing(column) || bytes_a.empty()) continue;
    const bool of_trajectory = std::string_view(column.path).rfind("/trajectories/", 0) == 0;
    if (of_trajectory && (a.every == 0 || b.every == 0)) continue;
    if (of_trajectory && column.rows == Rows::task) continue;  // places and times of frames
    ++result.compared;
    const bool same = column.rows == Rows::frame_segment ? same_frames(a, bytes_a, b, bytes_b) : bytes_a == bytes_b;
    if (!same) result.differing.emplace_back(column.path);
  }
}

/// Outcome, message and parameters, by the text of their values.
void compare_values(const TaskTable& sweep, std::size_t task, const TaskTable& rerun, TaskComparison& result) {
  for (const TaskColumn& column : sweep.columns()) {
    const bool told = column.path == "/tasks/outcome" || column.path == "/tasks/message";
    if (!column.parameter && !told) continue;
    ++result.compared;
    const auto other = rerun.find(column.name);
    const ColumnValues a = sweep.read(column), b = other ? rerun.read(*other) : ColumnValues{};
    const bool same =
        other && (column.is_number() ? a.numbers[task] == b.numbers[0] ||
                                           (a.numbers[task] != a.numbers[task] && b.numbers[0] != b.numbers[0])
                                     : a.texts[task] == b.texts[0]);
    if (!same) result.differing.push_back(column.path);
  }
}

}  // namespace

TaskComparison compare_task(const fs::path& sweep_path, std::int64_t task, std::int64_t sweep_every,
                            const fs::path& rerun_path, std::int64_t rerun_every) {
  TaskComparison result;
  compare_values(TaskTable(sweep_path), static_cast<std::size_t>(task), TaskTable(rerun_path), result);
  compare_results(read(sweep_path, task, sweep_every), read(rerun_path, 0, rerun_every), result);
  return result;
}

}  // namespace rodsweep
