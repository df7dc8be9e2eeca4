#include "runner/file/task_reader.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <type_traits>

#include "runner/file/columns.hpp"
#include "runner/file/file_reading.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Which optional kinds of rows a file has.
struct Kinds {
  bool contact, balance, force, frame_joint, state;

  explicit Kinds(const hdf5::File& file)
      : contact(hdf5::exists(file.id(), "/steps/contacts")),
        balance(hdf5::exists(file.id(), "/systems/segments/free_position_m")),
        force(hdf5::exists(file.id(), "/steps/clamp_force_n")),
        frame_joint(hdf5::exists(file.id(), "/trajectories/joint_force_n")),
        state(hdf5::exists(file.id(), "/trajectories/state/lambda")) {}
};

/// Completes a task whose planned columns were read. Throws Damage for numbers of rows that no file has.
void complete(Task& task, const Kinds& kinds) {
  constexpr std::int64_t most = 1'000'000'000'000;
  auto& rows = task.rows;
  task.steps = rows[Rows::step].count;
  rows[Rows::task].count = 1;
  if (kinds.contact) rows[Rows::contact_task].count = 1, rows[Rows::contact_step].count = task.steps;
  if (kinds.balance) rows[Rows::balanced_segment].count = rows[Rows::system_segment].count;
  if (kinds.force) rows[Rows::force_step].count = task.steps;
  const std::int64_t joints = kinds.frame_joint ? task.joints : 0;
  if (__builtin_mul_overflow(task.frames, task.segments, &rows[Rows::frame_segment].count) ||
      __builtin_mul_overflow(task.frames, joints, &rows[Rows::frame_joint].count) ||
      __builtin_mul_overflow(task.frames, kinds.state ? task.joints : 0, &rows[Rows::state_joint].count))
    throw Damage("a task has rows outside /trajectories");
  if (kinds.state) rows[Rows::state_segment].count = rows[Rows::frame_segment].count;
  rows[Rows::segment].count = task.frames > 0 ? task.segments : 0;
  rows[Rows::joint].count = task.frames > 0 ? joints : 0;
  for (const RowRange& range : rows)
    if (range.count < 0 || range.count > most) throw Damage("a task has a number of rows that no file can have");
}

/// Reads some thousand tasks at a time. Throws Damage unless the rows of each task follow those of the task before.
TaskList read_tasks(const hdf5::File& file, std::size_t count) {
  constexpr std::size_t block = 1 << 14;
  const Kinds kinds(file);
  std::map<std::string, hdf5::RowDataset> columns;
  const auto column = [&](const std::string& path) -> const hdf5::RowDataset& {
    const auto [place, is_new] = columns.try_emplace(path);
    if (is_new) place->second = hdf5::RowDataset(file.id(), path);
    if (place->second.rows() != count) throw Damage(path + " has another length than /tasks/state");
    return place->second;
  };
  const auto holds = [&](const RowPlace& place) { return hdf5::exists(file.id(), place.first); };
  TaskList tasks;
  for (std::size_t begin = 0; begin < count; begin += block) {
    std::vector<Task> read(std::min(block, count - begin));
    visit_planned_columns(holds, [&](const char* path, const char*, auto member) {
      using T = std::decay_t<decltype(member(read[0]))>;
      std::vector<T> values(read.size());
      column(path).read(hdf5::type_of<T>(), begin, values.size(), values.data());
      for (std::size_t i = 0; i < read.size(); ++i) member(read[i]) = values[i];
    });
    for (Task& task : read) {
      complete(task, kinds);
      tasks.add(task);
    }
    visit_planned_columns(holds, [&](const char* path, const char*, auto member) {
      auto task = tasks.from(static_cast<std::int64_t>(begin));
      for (std::size_t i = 0; i < read.size(); ++i, ++task)
        if (const Task listed = *task; member(listed) != member(read[i]))
          throw Damage("{} of task {} is {}; must be {}", path, begin + i, member(read[i]), member(listed));
    });
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

TaskReader::TaskReader(const fs::path& path, Times times, const TaskList* tasks)
    : path_(path), file_(open_results(path)), tasks_(std::shared_ptr<void>(), tasks) {
  reading(path, [&] {
    // States before data: all data of a task with state 1 are in the file.
    states_ = read_states(file_, path);
    outcomes_.resize(states_.size());
    hdf5::visit_texts(file_.id(), "/tasks/outcome", states_.size(),
                      [&](std::size_t task, const std::string& text) { outcomes_[task] = outcome_called(text); });
    if (!tasks_) tasks_ = std::make_shared<const TaskList>(read_tasks(file_, states_.size()));
    sizes_ = {axis_size(file_, "/axes/guess", 0), axis_size(file_, "/axes/tolerance", 0),
              axis_size(file_, "/trajectories/first_row", 1)};
    for (const Column& column : columns())
      columns_.push_back(is_timing(column) && times == Times::left_out ? hdf5::RowDataset()
                                                                       : hdf5::RowDataset(file_.id(), column.path));
    rows_ = TaskRows(file_.id());
  });
}

TaskOutcome TaskReader::outcome(std::int64_t task) const {
  if (!done(task)) return TaskOutcome::pending;
  if (const auto outcome = outcomes_[static_cast<std::size_t>(task)]) return *outcome;
  const std::string text = rows_.outcome.text(static_cast<std::size_t>(task));
  throw damaged_error(path_, "\"" + text + "\" is not an outcome of a task");
}

bool TaskReader::read(std::int64_t index, TaskRecord& record) const {
  return reading(path_, [&] {
    const Task task = tasks_->at(index);
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
    record.message = rows_.message.text(static_cast<hsize_t>(index));
    const auto outcome = outcomes_[static_cast<std::size_t>(index)];
    record.outcome = outcome.value_or(TaskOutcome::error);
    return outcome && task_checksum(index, record) == rows_.checksum.number<std::uint64_t>(index);
  });
}

bool TaskReader::read_intact(std::int64_t task, TaskRecord& record) const try {
  return read(task, record);
} catch (const FileError&) {
  return false;
}

TaskOrigin TaskReader::origin(std::int64_t task) const {
  return {rows_.rank.number<std::int32_t>(task), rows_.run.number<std::int32_t>(task),
          rows_.host.text(static_cast<hsize_t>(task)), rows_.write_s.number<double>(task)};
}

}  // namespace rodsweep
