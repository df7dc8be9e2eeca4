#include "runner/file/task_rows.hpp"

#include <stdexcept>
#include <string>

#include "runner/file/planned_columns.hpp"
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
  std::vector<Task> tasks(count);
  visit_planned_columns([&](const RowPlace& place) { return hdf5::exists(file.id(), place.first); },
                        [&](const char* path, const char*, auto member) {
                          const auto values = numbers(path);
                          for (std::size_t i = 0; i < count; ++i)
                            member(tasks[i]) = static_cast<std::decay_t<decltype(member(tasks[i]))>>(values[i]);
                        });
  const bool contact = hdf5::exists(file.id(), "/steps/contacts");
  for (std::size_t i = 0; i < count; ++i) {
    Task& task = tasks[i];
    const auto index = static_cast<std::int64_t>(i);
    task.index = index;
    task.steps = task.rows[Rows::step].count;
    task.rows[Rows::task] = {index, 1};
    if (contact)
      task.rows[Rows::contact_task] = task.rows[Rows::task], task.rows[Rows::contact_step] = task.rows[Rows::step];
    task.rows[Rows::frame_segment].count = task.frames * task.segments;
    task.rows[Rows::segment].count = task.frames > 0 ? task.segments : 0;
  }
  return tasks;
}

}  // namespace rodsweep
