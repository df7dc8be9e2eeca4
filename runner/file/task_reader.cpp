#include "runner/file/task_reader.hpp"

#include <string>
#include <type_traits>

#include "runner/file/columns.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/planned_columns.hpp"
#include "runner/file/record.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

std::vector<Task> read_tasks(const hdf5::File& file, std::size_t count) {
  std::vector<Task> tasks(count);
  const auto holds = [&](const RowPlace& place) { return hdf5::exists(file.id(), place.first); };
  visit_planned_columns(holds, [&](const char* path, const char*, auto member) {
    using T = std::decay_t<decltype(member(tasks[0]))>;
    const auto values = hdf5::read_all<T>(file.id(), path);
    if (values.size() != count) throw Damage(std::string(path) + " has another length than /tasks/state");
    for (std::size_t i = 0; i < count; ++i) member(tasks[i]) = values[i];
  });
  const bool contact = hdf5::exists(file.id(), "/steps/contacts");
  const bool balance = hdf5::exists(file.id(), "/systems/segments/free_position_m");
  for (std::size_t i = 0; i < count; ++i) {
    Task& task = tasks[i];
    auto& rows = task.rows;
    task.index = static_cast<std::int64_t>(i);
    task.steps = rows[Rows::step].count;
    rows[Rows::task] = {task.index, 1};
    if (contact) rows[Rows::contact_task] = rows[Rows::task], rows[Rows::contact_step] = rows[Rows::step];
    if (balance) rows[Rows::balanced_segment] = rows[Rows::system_segment];
    if (__builtin_mul_overflow(task.frames, task.segments, &rows[Rows::frame_segment].count))
      throw Damage("a task has rows outside /trajectories");
    rows[Rows::segment].count = task.frames > 0 ? task.segments : 0;
  }
  return tasks;
}

/// The size of axis `place` of a dataset; 0 if the file does not have it.
std::int64_t axis_size(const hdf5::File& file, const std::string& path, std::size_t place) {
  if (!hdf5::exists(file.id(), path)) return 0;
  return static_cast<std::int64_t>(hdf5::extent(hdf5::open_dataset(file.id(), path), path).at(place));
}

/// Throws Damage if rows are outside their dataset, or their width does not match the file's axes.
void check_rows(const RowRange& rows, std::int64_t width, const hdf5::RowDataset& dataset) {
  const auto most = static_cast<std::int64_t>(dataset.rows());
  if (rows.first < 0 || rows.count < 0 || rows.count > most || rows.first > most - rows.count)
    throw Damage("a task has rows outside " + dataset.path());
  if (static_cast<std::int64_t>(dataset.row_values()) != width)
    throw Damage(dataset.path() + " has axes of other lengths than /axes");
}

}  // namespace

TaskReader::TaskReader(const fs::path& path, Times times) : path_(path), file_(open_results(path)) {
  reading(path, [&] {
    // States before data: all data of a task with state 1 are in the file.
    states_ = read_states(file_, path);
    outcomes_ = hdf5::read_texts(file_.id(), "/tasks/outcome");
    if (outcomes_.size() != states_.size()) throw Damage("/tasks/outcome has another length than /tasks/state");
    tasks_ = read_tasks(file_, states_.size());
    sizes_ = {axis_size(file_, "/axes/guess", 0), axis_size(file_, "/axes/tolerance", 0),
              axis_size(file_, "/trajectories/first_row", 1)};
    const auto rows = [&](const char* dataset) { return hdf5::RowDataset(file_.id(), dataset); };
    for (const Column& column : columns())
      columns_.push_back(is_timing(column) && times == Times::left_out ? hdf5::RowDataset() : rows(column.path));
    message_ = rows("/tasks/message");
    checksum_ = rows("/tasks/checksum");
    rank_ = rows("/timing/tasks/rank");
    host_ = rows("/timing/tasks/host");
    run_ = rows("/timing/tasks/run");
    write_s_ = rows("/timing/tasks/write_s");
  });
}

TaskOutcome TaskReader::outcome(std::int64_t task) const {
  if (!done(task)) return TaskOutcome::pending;
  const std::string& text = outcomes_[static_cast<std::size_t>(task)];
  if (const auto outcome = outcome_called(text)) return *outcome;
  throw damaged_error(path_, "\"" + text + "\" is not an outcome of a task");
}

bool TaskReader::read(std::int64_t index, TaskRecord& record) const {
  return reading(path_, [&] {
    const Task& task = tasks_.at(static_cast<std::size_t>(index));
    for (std::size_t c = 0; c < columns_.size(); ++c)
      if (const Column& column = columns()[c]; columns_[c])
        check_rows(task.rows[column.rows], row_width(column, sizes_), columns_[c]);
    record.prepare(task, sizes_);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const Column& column = columns()[c];
      const RowRange& rows = task.rows[column.rows];
      if (!columns_[c])
        std::visit([](auto* values) { values->clear(); }, column.values(record));
      else if (rows.count > 0)
        columns_[c].read(column.type(), static_cast<hsize_t>(rows.first), static_cast<hsize_t>(rows.count),
                         data_of(column, record));
    }
    record.message = hdf5::read_text_row(message_, static_cast<hsize_t>(index));
    const auto outcome = outcome_called(outcomes_[static_cast<std::size_t>(index)]);
    record.outcome = outcome.value_or(TaskOutcome::error);
    return outcome && task_checksum(index, record) == hdf5::read_row<std::uint64_t>(checksum_, index);
  });
}

bool TaskReader::read_intact(std::int64_t task, TaskRecord& record) const try {
  return read(task, record);
} catch (const FileError&) {
  return false;
}

TaskOrigin TaskReader::origin(std::int64_t task) const {
  return {hdf5::read_row<std::int32_t>(rank_, task), hdf5::read_row<std::int32_t>(run_, task),
          hdf5::read_text_row(host_, static_cast<hsize_t>(task)), hdf5::read_row<double>(write_s_, task)};
}

}  // namespace rodsweep
