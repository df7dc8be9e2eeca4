#include "runner/command/commands.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/file_error.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/record.hpp"
#include "runner/file/results_file.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/file/task_reader.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/job/job.hpp"
#include "runner/terminal/formats.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// An input file, and the index of its first run in the new file.
struct Part {
  fs::path path;
  TaskReader reader;
  int first_run;

  TaskOrigin origin(std::int64_t task) const {
    TaskOrigin origin = reader.origin(task);
    origin.run = std::min(origin.run + first_run, run_rows - 1);
    return origin;
  }
};

std::string these(const std::vector<std::int64_t>& tasks) {
  return tasks.size() == 1 ? fmt::format("task {}", tasks.front())
                           : fmt::format("{} tasks (first: {})", tasks.size(), tasks.front());
}

std::vector<Part> open_parts(const std::vector<fs::path>& files, const FileSummary& first, const Plan& plan) {
  std::vector<Part> parts;
  int runs = 0;
  for (const fs::path& path : files) {
    const FileSummary file = inspect(path);
    if (file.rerun_of_task != first.rerun_of_task)
      throw FileError("{} and {} are reruns of different tasks", path.native(), first.path.native());
    if (const auto found = first_difference(plan.job(), stored_job(file, {}, MissingFiles::accepted)))
      throw FileError("{} and {} are of different jobs: {} is {} and {}; must be of the same job", first.path.native(),
                      path.native(), found->key, found->now, found->before);
    check_same_plan(path, plan, "Merge with that revision");
    parts.push_back({path, TaskReader(path), runs});
    runs += static_cast<int>(file.runs.size());
  }
  return parts;
}

}  // namespace

ExitCode execute(const MergeOptions& options, Console& console) {
  if (const std::string left = unfinished_text(options.output); !left.empty()) console.warn(left);
  const StopSignal signal;
  const FileSummary first = inspect(options.files.front());
  const Plan plan = stored_plan(first);
  const std::vector<Part> parts = open_parts(options.files, first, plan);
  ResultsFile merged = ResultsFile::create(options.output, plan, provenance_of_this_process(options.command),
                                           MPI_COMM_SELF, free_bytes, options.files);

  std::int64_t done = 0, failed = 0;
  std::vector<std::int64_t> damaged, different;
  TaskRecord record, other;
  for (const Task& task : plan.tasks()) {
    if (signal.received() != 0) {
      merged.close();
      fs::remove(options.output);
      console.note(fmt::format("stopped early by {}; nothing was written", signal_cause(signal.received())));
      return ExitCode::stopped;
    }
    bool taken = false, lost = false;
    for (const Part& part : parts) {
      if (!part.reader.done(task.index)) continue;
      TaskRecord& read = taken ? other : record;
      if (!part.reader.read_intact(task.index, read)) {
        lost = true;
        continue;
      }
      if (taken) {
        if (task_checksum(task.index, other) != task_checksum(task.index, record)) different.push_back(task.index);
        continue;
      }
      const TaskOrigin origin = part.origin(task.index);
      merged.write(task, record, &origin);
      taken = true;
      failed += record.outcome == TaskOutcome::ok ? 0 : 1;
    }
    done += taken ? 1 : 0;
    if (lost && !taken) damaged.push_back(task.index);
  }
  merged.commit();
  const ExitCode code = done < plan.size() ? ExitCode::stopped : (failed > 0 ? ExitCode::tasks_failed : ExitCode::ok);
  merged.end_run(utc_now(), static_cast<int>(code));
  merged.close();
  merged.check_written();

  if (!damaged.empty())
    console.warn(fmt::format("{} damaged (wrong checksum) and left to do: {}",
                             damaged.size() == 1 ? "one task is" : "some tasks are", these(damaged)));
  if (!different.empty())
    console.warn(fmt::format(
        "results differ between files for {} (machines round differently); the first file's results are used",
        these(different)));
  console.result(fmt::format("{}: {} of {} of {} from {}{}", options.output.native(), done,
                             count_text(plan.size(), "task"), first.job_name,
                             count_text(static_cast<std::int64_t>(parts.size()), "file"),
                             done == plan.size() ? "" : "; run the job with this output and --resume to complete it"));
  return code;
}

}  // namespace rodsweep
