#include "runner/file/inspect.hpp"

#include <stdexcept>

#include "runner/file/file_reading.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/task_checksum.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Calls work(); what HDF5 or the sizes of a broken file make of it is the file's fault.
template <class Work>
auto reading(const fs::path& path, Work&& work) {
  try {
    return work();
  } catch (const FileError&) {
    throw;
  } catch (const std::exception& failure) {
    throw damaged_error(path, failure.what());
  }
}

std::vector<RunRow> read_runs(const hdf5::File& file) {
  const hid_t id = file.id();
  std::vector<RunRow> runs(static_cast<std::size_t>(runs_used(file)));
  const auto texts = [&](const char* path, auto&& place) {
    const std::vector<std::string> values = hdf5::read_texts(id, path);
    for (std::size_t row = 0; row < runs.size(); ++row) place(runs[row]) = values.at(row);
  };
  texts("/runs/begin", [](RunRow& run) -> std::string& { return run.provenance.begin_utc; });
  texts("/runs/end", [](RunRow& run) -> std::string& { return run.end_utc; });
  texts("/runs/host", [](RunRow& run) -> std::string& { return run.provenance.host; });
  texts("/runs/command", [](RunRow& run) -> std::string& { return run.provenance.user_command; });
  texts("/runs/revision", [](RunRow& run) -> std::string& { return run.provenance.revision; });
  texts("/runs/versions", [](RunRow& run) -> std::string& { return run.provenance.versions; });
  texts("/runs/petsc_options", [](RunRow& run) -> std::string& { return run.provenance.petsc_options; });
  const auto ranks = hdf5::read_all<std::int32_t>(id, "/runs/ranks");
  const auto exit_codes = hdf5::read_all<std::int32_t>(id, "/runs/exit_code");
  const auto oversubscribed = hdf5::read_all<std::uint8_t>(id, "/runs/oversubscribed");
  for (std::size_t row = 0; row < runs.size(); ++row) {
    runs[row].provenance.ranks = ranks.at(row);
    runs[row].exit_code = exit_codes.at(row);
    runs[row].provenance.oversubscribed = oversubscribed.at(row) != 0;
  }
  return runs;
}

void count_tasks(const hdf5::File& file, const std::vector<std::uint8_t>& states, FileSummary& summary) {
  const std::vector<std::string> outcomes = hdf5::read_texts(file.id(), "/tasks/outcome");
  const auto attempts = hdf5::read_all<std::int32_t>(file.id(), "/timing/tasks/attempt");
  const auto seconds = hdf5::read_all<double>(file.id(), "/timing/tasks/elapsed_s");
  summary.tasks = static_cast<std::int64_t>(states.size());
  for (std::size_t task = 0; task < states.size(); ++task) {
    if (states[task] == 0) continue;
    ++summary.done;
    ++summary.done_by_outcome[outcomes.at(task)];
    if (const auto run = static_cast<std::size_t>(attempts.at(task)); run < summary.runs.size()) {
      ++summary.runs[run].tasks;
      if (seconds.at(task) > 0) summary.runs[run].task_seconds += seconds[task];  // NaN: not measured
    }
    if (outcomes[task] == to_string(TaskOutcome::ok)) continue;
    ++summary.failed;
    summary.failures.push_back(
        {static_cast<std::int64_t>(task), outcomes[task], hdf5::read_text_row(file.id(), "/tasks/message", task)});
  }
  summary.pending = summary.tasks - summary.done;
}

/// A column and its dataset; without one where the file leaves it out.
struct StoredColumn {
  Column column;
  hid_t type;  ///< in memory
  hdf5::RowDataset dataset;
};

/// The task's rows, as bytes.
void read_rows(const StoredColumn& stored, const Task& task, std::vector<char>& bytes) {
  bytes.clear();
  const RowRange rows = rows_of(task, stored.column.rows);
  if (!stored.dataset || rows.count == 0) return;
  const auto most = static_cast<std::int64_t>(stored.dataset.rows());
  if (rows.first < 0 || rows.count < 0 || rows.count > most || rows.first > most - rows.count) {
    throw std::out_of_range(std::string("a task has rows outside ") + stored.column.path);
  }
  bytes.resize(static_cast<std::size_t>(rows.count) * stored.dataset.row_values() * H5Tget_size(stored.type));
  stored.dataset.read(stored.type, rows.first, rows.count, bytes.data());
}

/// The rows of every task, as the file tells them.
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

}  // namespace

FileSummary inspect(const fs::path& path) {
  const hdf5::File file = open_results(path);
  return reading(path, [&] {
    FileSummary summary;
    summary.path = path;
    summary.bytes = fs::file_size(path);
    summary.schema_version = schema_version;
    summary.job_name = hdf5::read_text_attribute(file.id(), "/job", "name");
    summary.plan_hash = hdf5::read_text_attribute(file.id(), "/job", "plan_hash");
    summary.job_text = hdf5::read_texts(file.id(), "/job/text").at(0);
    if (hdf5::exists(file.id(), "/axes/guess")) summary.guesses = hdf5::read_texts(file.id(), "/axes/guess");
    summary.tolerances = hdf5::read_all<double>(file.id(), "/axes/tolerance");
    // The states first: of a task that is complete now, everything else is there to be read.
    const std::vector<std::uint8_t> states = read_states(file, path);
    summary.runs = read_runs(file);
    count_tasks(file, states, summary);
    return summary;
  });
}

Verification verify(const fs::path& path) {
  const hdf5::File file = open_results(path);
  return reading(path, [&] {
    const std::vector<std::uint8_t> states = read_states(file, path);
    const std::vector<Task> tasks = read_tasks(file, states.size());
    const auto checksums = hdf5::read_all<std::uint64_t>(file.id(), "/tasks/checksum");
    const std::vector<std::string> outcomes = hdf5::read_texts(file.id(), "/tasks/outcome");
    std::vector<StoredColumn> columns;
    const TaskRecord record;
    visit_columns(record, [&](const Column& column, const auto& values) {
      using T = typename std::decay_t<decltype(values)>::value_type;
      if (!TaskChecksum::covers(column)) return;
      columns.push_back({column, hdf5::type_of<T>(), hdf5::RowDataset(file.id(), column.path)});
    });

    Verification result;
    std::vector<char> bytes;
    for (const Task& task : tasks) {
      const auto index = static_cast<std::size_t>(task.index);
      if (states[index] == 0) continue;
      TaskChecksum sum(task.index, outcomes.at(index), hdf5::read_text_row(file.id(), "/tasks/message", index));
      for (const StoredColumn& stored : columns) {
        read_rows(stored, task, bytes);
        sum.add(stored.column, bytes.data(), bytes.size());
      }
      ++result.checked;
      if (sum.value() != checksums.at(index)) result.damaged.push_back(task.index);
    }
    return result;
  });
}

}  // namespace rodsweep
