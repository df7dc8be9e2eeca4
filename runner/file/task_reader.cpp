#include "runner/file/task_reader.hpp"

#include <fmt/format.h>

#include "runner/file/file_reading.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/resume_check.hpp"
#include "runner/file/task_checksum.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

TaskOutcome outcome_of(const std::string& text, const fs::path& path) {
  for (int i = 0; i <= static_cast<int>(TaskOutcome::error); ++i)
    if (text == to_string(static_cast<TaskOutcome>(i))) return static_cast<TaskOutcome>(i);
  throw damaged_error(path, "\"" + text + "\" is no outcome of a task");
}

template <class T>
T value_of(const hdf5::RowDataset& dataset, std::int64_t row) {
  T value{};
  dataset.read(hdf5::type_of<T>(), static_cast<hsize_t>(row), 1, &value);
  return value;
}

}  // namespace

TaskReader::TaskReader(const fs::path& path, const Plan& plan, const char* advice)
    : file_(open_results(path)), plan_(&plan), sizes_(axis_sizes(plan)) {
  try {
    if (hdf5::has_attribute(file_.id(), "/job", "rerun_of_task")) {
      throw FileError(fmt::format(
          "{} holds one task of a sweep, made by `rodsweep rerun`: extend the file of the sweep", path.native()));
    }
    check_same_plan(file_, path, plan, advice);
    const std::vector<std::uint8_t> states = read_states(file_, path);
    const std::vector<std::string> outcomes = hdf5::read_texts(file_.id(), "/tasks/outcome");
    outcomes_.assign(states.size(), TaskOutcome::pending);
    for (std::size_t i = 0; i < states.size(); ++i)
      if (states[i] == 1) outcomes_[i] = outcome_of(outcomes.at(i), path);
    const auto rows = [&](const char* dataset) { return hdf5::RowDataset(file_.id(), dataset); };
    checksum_ = rows("/tasks/checksum");
    rank_ = rows("/timing/tasks/rank");
    attempt_ = rows("/timing/tasks/attempt");
    write_s_ = rows("/timing/tasks/write_s");
    const TaskRecord record;
    visit_columns(record, [&](const Column& column, const auto&) { columns_.push_back(rows(column.path)); });
  } catch (const Hdf5Error& failure) {
    throw damaged_error(path, failure.what());
  }
}

bool TaskReader::read(std::int64_t index, TaskRecord& record) const try {
  const Task& task = plan_->task(index);
  record.prepare(task, sizes_);
  record.outcome = outcome(index);
  record.message = hdf5::read_text_row(file_.id(), "/tasks/message", static_cast<hsize_t>(index));
  TaskChecksum sum(index, to_string(record.outcome), record.message);
  std::size_t next = 0;
  visit_columns(record, [&](const Column& column, auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    const hdf5::RowDataset& dataset = columns_[next++];
    const RowRange rows = task.rows[column.rows];
    if (!values.empty()) {
      dataset.read(hdf5::type_of<T>(), static_cast<hsize_t>(rows.first), static_cast<hsize_t>(rows.count),
                   values.data());
    }
    sum.add(column, values.data(), values.size() * sizeof(T));
  });
  return sum.value() == value_of<std::uint64_t>(checksum_, index);
} catch (const Hdf5Error&) {
  return false;
}

TaskOrigin TaskReader::origin(std::int64_t task) const {
  return {value_of<std::int32_t>(rank_, task), value_of<std::int32_t>(attempt_, task),
          hdf5::read_text_row(file_.id(), "/timing/tasks/host", static_cast<hsize_t>(task)),
          value_of<double>(write_s_, task)};
}

}  // namespace rodsweep
