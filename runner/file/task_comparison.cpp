#include "runner/file/task_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "runner/file/columns.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/hdf5.hpp"
#include "runner/file/task_reader.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// A task's record, and the number of steps between its frames.
struct Written {
  Task task;
  TaskRecord record;
  std::int64_t every;
};

Written read(const fs::path& path, std::int64_t task, std::int64_t every) {
  const TaskReader file(path, TaskReader::Times::left_out);
  Written written{reading(path, [&] { return file.tasks().at(task); }), {}, every};
  file.read(task, written.record);  // even if damaged: the comparison detects this
  return written;
}

/// Compares the frames of common steps.
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
    if (of_trajectory && column.rows == Rows::task) continue;  // row numbers and times of frames
    ++result.compared;
    const bool same = column.rows == Rows::frame_segment ? same_frames(a, bytes_a, b, bytes_b) : bytes_a == bytes_b;
    if (!same) result.differing.emplace_back(column.path);
  }
}

bool same_value(hid_t a, std::int64_t row_a, hid_t b, const std::string& path) {
  if (!hdf5::exists(b, path)) return false;
  const hdf5::RowDataset here(a, path), there(b, path);
  const auto of_a = static_cast<std::size_t>(row_a);
  if (H5Tget_class(here.type().id()) == H5T_STRING)
    return hdf5::read_text_row(here, of_a) == hdf5::read_text_row(there, 0);
  std::vector<double> value_a(here.row_values()), value_b(there.row_values());
  here.read(hdf5::type_of<double>(), of_a, 1, value_a.data());
  there.read(hdf5::type_of<double>(), 0, 1, value_b.data());
  const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return std::equal(value_a.begin(), value_a.end(), value_b.begin(), value_b.end(), same);
}

/// Compares outcome, message and parameters.
void compare_values(const fs::path& sweep_path, std::int64_t task, const fs::path& rerun_path, TaskComparison& result) {
  const hdf5::File sweep = open_results(sweep_path), rerun = open_results(rerun_path);
  std::vector<std::string> paths{"/tasks/outcome", "/tasks/message"};
  const std::string group = "/tasks/parameters";
  const hdf5::Object parameters(hdf5::check(H5Oopen(sweep.id(), group.c_str(), H5P_DEFAULT), "H5Oopen", group));
  for (const std::string& name : hdf5::members(parameters.id())) paths.push_back(group + "/" + name);
  for (const std::string& path : paths) {
    ++result.compared;
    if (!same_value(sweep.id(), task, rerun.id(), path)) result.differing.push_back(path);
  }
}

}  // namespace

TaskComparison compare_task(const fs::path& sweep_path, std::int64_t task, std::int64_t sweep_every,
                            const fs::path& rerun_path, std::int64_t rerun_every) {
  TaskComparison result;
  reading(sweep_path, [&] { compare_values(sweep_path, task, rerun_path, result); });
  compare_results(read(sweep_path, task, sweep_every), read(rerun_path, 0, rerun_every), result);
  return result;
}

}  // namespace rodsweep
