#include "runner/file/inspect.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "runner/file/file_lock.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/task_reader.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

const std::string ok_name = to_string(TaskOutcome::ok);

void count_tasks(const hdf5::File& file, const std::vector<std::uint8_t>& states, FileSummary& summary) {
  const auto run_of_task = hdf5::read_all<std::int32_t>(file.id(), "/timing/tasks/run");
  const auto seconds = hdf5::read_all<double>(file.id(), "/timing/tasks/elapsed_s");
  const hdf5::RowDataset messages(file.id(), "/tasks/message");  // stays open: its chunks may be compressed
  summary.tasks = static_cast<std::int64_t>(states.size());
  hdf5::visit_texts(file.id(), "/tasks/outcome", states.size(), [&](std::size_t task, const std::string& outcome) {
    if (states[task] == 0) return;
    ++summary.done;
    ++summary.done_by_outcome[outcome];
    if (const auto run = static_cast<std::size_t>(run_of_task.at(task)); run < summary.runs.size()) {
      ++summary.runs[run].tasks;
      if (seconds.at(task) > 0) summary.runs[run].task_seconds += seconds[task];  // NaN: not measured
    }
    if (outcome == ok_name) return;
    ++summary.failed;
    summary.failures.push_back({static_cast<std::int64_t>(task), outcome, messages.text(task)});
  });
  summary.pending = summary.tasks - summary.done;
}

void find_begun(const hdf5::File& file, const std::vector<std::uint8_t>& states, FileSummary& summary) {
  const char* path = "/timing/tasks/tries";
  if (!hdf5::exists(file.id(), path)) return;  // the file is older than this column
  const auto tries = hdf5::read_all<std::uint8_t>(file.id(), path);
  std::vector<std::size_t> begun;
  for (std::size_t task = 0; task < states.size(); ++task)
    if (states[task] == 0 && tries.at(task) > 0) begun.push_back(task);
  if (begun.empty()) return;
  const auto run_of_task = hdf5::read_all<std::int32_t>(file.id(), "/timing/tasks/run");
  const auto ranks = hdf5::read_all<std::int32_t>(file.id(), "/timing/tasks/rank");
  const hdf5::RowDataset hosts(file.id(), "/timing/tasks/host");
  for (const std::size_t task : begun)
    summary.begun.push_back({static_cast<std::int64_t>(task), run_of_task.at(task), ranks.at(task), hosts.text(task)});
}

void find_momentum_residual(const hdf5::File& file, const std::vector<std::uint8_t>& states, FileSummary& summary) {
  const char* path = "/tasks/momentum_residual";
  if (!hdf5::exists(file.id(), path)) return;  // the file is older than this column
  const auto residuals = hdf5::read_all<double>(file.id(), path);
  for (std::size_t task = 0; task < states.size(); ++task)
    if (states[task] != 0 && residuals.at(task) >= summary.momentum_residual.value_or(0))
      summary.momentum_residual = residuals[task];
}

}  // namespace

double silent_seconds(const fs::path& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return 0;
  return std::max(0.0, std::difftime(std::time(nullptr), file.st_mtime));
}

FileSummary inspect(const fs::path& path) {
  const hdf5::File file = open_results(path);
  return reading(path, [&] {
    FileSummary summary;
    summary.path = path;
    summary.bytes = fs::file_size(path);
    summary.silent_s = silent_seconds(path);
    summary.schema_version = schema_version;
    summary.job_name = hdf5::read_text_attribute(file.id(), "/job", "name");
    summary.job_kind = kind_of(file);
    summary.plan_hash = hdf5::read_text_attribute(file.id(), "/job", "plan_hash");
    if (hdf5::has_attribute(file.id(), "/job", "rerun_of_task"))
      summary.rerun_of_task = hdf5::read_int_attribute(file.id(), "/job", "rerun_of_task");
    summary.job_text = stored_job_text(file, path);
    if (hdf5::exists(file.id(), "/axes/guess")) summary.guesses = hdf5::read_all<std::string>(file.id(), "/axes/guess");
    summary.tolerances = hdf5::read_all<double>(file.id(), "/axes/tolerance");
    summary.being_written = FileLock::is_held(path);  // before /runs, where a run that ends meanwhile stores its end
    // States before data: all data of a task with state 1 are in the file.
    const std::vector<std::uint8_t> states = read_states(file, path);
    summary.runs = read_runs(file);
    count_tasks(file, states, summary);
    find_begun(file, states, summary);
    find_momentum_residual(file, states, summary);
    return summary;
  });
}

SolveCounts count_solves(const fs::path& path) {
  return reading(path, [&] {
    SolveCounts counts;
    const hdf5::File file = open_results(path);
    const hdf5::RowDataset timed(file.id(), "/timing/tasks/solves_timed"),
        missed(file.id(), "/timing/tasks/solves_missed");
    if (!timed || !missed || timed.row_values() == 0) return counts;
    const std::vector<std::uint8_t> states = read_states(file, path);
    std::vector<char> is_ok(states.size(), 0);
    hdf5::visit_texts(file.id(), "/tasks/outcome", states.size(), [&](std::size_t task, const std::string& outcome) {
      is_ok[task] = states[task] != 0 && outcome == ok_name;
    });
    constexpr std::size_t block = 4096;  // tasks read at once
    std::vector<std::int32_t> values;
    for (std::size_t first = 0; first < states.size(); first += block) {
      const std::size_t tasks = std::min(block, states.size() - first);
      for (const auto& [rows, sum] : {std::pair(&timed, &counts.timed), std::pair(&missed, &counts.missed)}) {
        const auto guesses = static_cast<std::size_t>(rows->row_values());
        values.resize(tasks * guesses);
        rows->read(hdf5::type_of<std::int32_t>(), first, tasks, values.data());
        for (std::size_t i = 0; i < values.size(); ++i)
          if (is_ok[first + i / guesses]) *sum += std::max(values[i], 0);
      }
    }
    return counts;
  });
}

Verification verify(const fs::path& path) {
  const TaskReader file(path, TaskReader::Times::left_out);
  Verification result;
  TaskRecord record;
  for (const Task& task : file.tasks()) {
    if (!file.done(task.index)) continue;
    ++result.checked;
    if (!file.read(task.index, record)) result.damaged.push_back(task.index);
  }
  return result;
}

}  // namespace rodsweep
