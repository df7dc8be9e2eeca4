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
  return tasks;
}

}  // namespace rodsweep
