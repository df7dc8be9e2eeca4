#include "runner/file/task_comparison.hpp"

#include "runner/file/file_reading.hpp"
#include "runner/file/task_rows.hpp"
#include "runner/file/task_table.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// The two files, and the task's rows in each.
struct Pair {
  const hdf5::File &sweep, &rerun;
  Task in_sweep, in_rerun;
  std::int64_t sweep_every, rerun_every;
};

bool same_rows(const StoredColumn& a, const RowRange& rows_a, const StoredColumn& b, const RowRange& rows_b) {
  std::vector<char> bytes_a, bytes_b;
  read_rows(a, rows_a, bytes_a);
  read_rows(b, rows_b, bytes_b);
  return bytes_a == bytes_b;
}

/// Frame by frame, where both have one of the same step.
bool same_frames(const Pair& pair, const StoredColumn& a, const StoredColumn& b) {
  const std::int64_t segments = pair.in_sweep.segments;
  for (std::int64_t frame = 0; frame < pair.in_sweep.frames; ++frame) {
    const std::int64_t step = frame * pair.sweep_every, other = step / pair.rerun_every;
    if (step % pair.rerun_every != 0 || other >= pair.in_rerun.frames) continue;
    if (!same_rows(a, {pair.in_sweep.rows[Rows::frame_segment].first + frame * segments, segments}, b,
                   {other * segments, segments}))
      return false;
  }
  return true;
}

void compare_results(const Pair& pair, TaskComparison& result) {
  const std::vector<StoredColumn> a = stored_columns(pair.sweep), b = stored_columns(pair.rerun);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Column& column = a[i].column;
    if (!a[i].dataset) continue;
    const bool frames = column.rows == Rows::frame_segment;
    const bool of_trajectory = std::string(column.path).rfind("/trajectories/", 0) == 0;
    if (of_trajectory && (pair.sweep_every == 0 || pair.rerun_every == 0)) continue;
    if (of_trajectory && column.rows == Rows::task) continue;  // places and times of frames
    ++result.compared;
    const bool same = frames ? same_frames(pair, a[i], b[i])
                             : same_rows(a[i], pair.in_sweep.rows[column.rows], b[i], pair.in_rerun.rows[column.rows]);
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
  const auto index = static_cast<std::size_t>(task);
  const TaskTable sweep_table(sweep_path), rerun_table(rerun_path);
  const hdf5::File sweep = open_results(sweep_path), rerun = open_results(rerun_path);
  TaskComparison result;
  compare_values(sweep_table, index, rerun_table, result);
  try {
    const auto tasks = static_cast<std::size_t>(sweep_table.size());
    compare_results(
        {sweep, rerun, read_tasks(sweep, tasks).at(index), read_tasks(rerun, 1).at(0), sweep_every, rerun_every},
        result);
  } catch (const std::exception& failure) {
    throw damaged_error(sweep_path, failure.what());
  }
  return result;
}

}  // namespace rodsweep
