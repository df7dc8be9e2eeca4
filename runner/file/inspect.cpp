#include "runner/file/inspect.hpp"

#include <stdexcept>

#include "runner/file/file_reading.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/task_checksum.hpp"
#include "runner/file/task_rows.hpp"

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
  if (hdf5::exists(id, "/runs/job")) texts("/runs/job", [](RunRow& run) -> std::string& { return run.provenance.job; });
  texts("/runs/command", [](RunRow& run) -> std::string& { return run.provenance.user_command; });
  texts("/runs/revision", [](RunRow& run) -> std::string& { return run.provenance.revision; });
  texts("/runs/versions", [](RunRow& run) -> std::string& { return run.provenance.versions; });
  texts("/runs/petsc_options", [](RunRow& run) -> std::string& { return run.provenance.petsc_options; });
  if (hdf5::exists(id, "/runs/source")) texts("/runs/source", [](RunRow& run) -> std::string& { return run.source; });
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
  const hdf5::RowDataset messages(file.id(), "/tasks/message");  // kept open: its chunks may be compressed
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
    summary.failures.push_back({static_cast<std::int64_t>(task), outcomes[task], hdf5::read_text_row(messages, task)});
  }
  summary.pending = summary.tasks - summary.done;
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
    summary.job_kind = kind_of(file);
    summary.plan_hash = hdf5::read_text_attribute(file.id(), "/job", "plan_hash");
    if (hdf5::has_attribute(file.id(), "/job", "rerun_of_task"))
      summary.rerun_of_task = hdf5::read_int_attribute(file.id(), "/job", "rerun_of_task");
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
    const std::vector<StoredColumn> columns = stored_columns(file);
    const hdf5::RowDataset messages(file.id(), "/tasks/message");
    Verification result;
    std::vector<char> bytes;
    for (const Task& task : tasks) {
      const auto index = static_cast<std::size_t>(task.index);
      if (states[index] == 0) continue;
      TaskChecksum sum(task.index, outcomes.at(index), hdf5::read_text_row(messages, index));
      for (const StoredColumn& stored : columns) {
        read_rows(stored, task.rows[stored.column.rows], bytes);
        sum.add(stored.column, bytes.data(), bytes.size());
      }
      ++result.checked;
      if (sum.value() != checksums.at(index)) result.damaged.push_back(task.index);
    }
    return result;
  });
}

}  // namespace rodsweep
