#include "runner/file/task_rows.hpp"

#include <stdexcept>
#include <string>

#include "runner/file/task_checksum.hpp"

namespace rodsweep {

std::vector<StoredColumn> stored_columns(const hdf5::File& file) {
  std::vector<StoredColumn> columns;
  const TaskRecord record;
  visit_columns(record, [&](const Column& column, const auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    if (!TaskChecksum::covers(column)) return;
    columns.push_back({column, hdf5::type_of<T>(), hdf5::RowDataset(file.id(), column.path)});
  });
  return columns;
}

void read_rows(const StoredColumn& stored, const RowRange& rows, std::vector<char>& bytes) {
  bytes.clear();
  if (!stored.dataset || rows.count == 0) return;
  const auto most = static_cast<std::int64_t>(stored.dataset.rows());
  if (rows.first < 0 || rows.count < 0 || rows.count > most || rows.first > most - rows.count) {
    throw std::out_of_range(std::string("a task has rows outside ") + stored.column.path);
  }
  bytes.resize(static_cast<std::size_t>(rows.count) * stored.dataset.row_values() * H5Tget_size(stored.type));
  stored.dataset.read(stored.type, rows.first, rows.count, bytes.data());
}

std::vector<Task> read_tasks(const hdf5::File& file, std::size_t count) {
  const auto numbers = [&](const char* path) {
    auto values = hdf5::read_all<std::int64_t>(file.id(), path);
    if (values.size() != count) throw std::length_error(std::string(path) + " has another length than /tasks/state");
    return values;
  };
  const auto segments = numbers("/tasks/segments"), first_step = numbers("/tasks/first_step"),
             steps = numbers("/tasks/steps"), first_solve = numbers("/tasks/first_solve"),
             solves = numbers("/tasks/solves"), first_frame_row = numbers("/tasks/first_frame_row"),
             frames = numbers("/tasks/frames");
  std::vector<Task> tasks(count);
  for (std::size_t i = 0; i < count; ++i) {
    tasks[i].index = static_cast<std::int64_t>(i);
    tasks[i].segments = static_cast<int>(segments[i]);
    tasks[i].first_step = first_step[i], tasks[i].steps = steps[i];
    tasks[i].first_solve = first_solve[i], tasks[i].solves = solves[i];
    tasks[i].first_frame_row = first_frame_row[i], tasks[i].frames = frames[i];
  }
  const bool contact_rows = hdf5::exists(file.id(), "/steps/contacts");
  for (Task& task : tasks) task.contact_rows = contact_rows;
  if (hdf5::exists(file.id(), "/tasks/first_segment_row")) {
    const auto first_segment_row = numbers("/tasks/first_segment_row");
    for (std::size_t i = 0; i < count; ++i) tasks[i].first_segment_row = first_segment_row[i];
  }
  if (!hdf5::exists(file.id(), "/tasks/systems")) return tasks;
  const auto first_system = numbers("/tasks/first_system"), systems = numbers("/tasks/systems"),
             first_segment = numbers("/tasks/first_system_segment"), segment_rows = numbers("/tasks/system_segments"),
             first_joint = numbers("/tasks/first_system_joint"), joint_rows = numbers("/tasks/system_joints");
  for (std::size_t i = 0; i < count; ++i) {
    tasks[i].first_system = first_system[i], tasks[i].systems = systems[i];
    tasks[i].first_system_segment = first_segment[i], tasks[i].system_segments = segment_rows[i];
    tasks[i].first_system_joint = first_joint[i], tasks[i].system_joints = joint_rows[i];
  }
  return tasks;
}

}  // namespace rodsweep
