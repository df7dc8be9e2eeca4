#include "runner/command/compare_command.hpp"

#include <fmt/format.h>

#include "runner/command/compare_output.hpp"
#include "runner/file/file_error.hpp"
#include "runner/file/resume_check.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/file/task_table.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

FileError other_program(const FileSummary& file, const char* what) {
  return FileError(
      fmt::format("{} was made by a rodsweep that makes other {} of its job (revision {}): compare with that one",
                  file.path.native(), what, file.runs.empty() ? "unknown" : file.runs.back().provenance.revision));
}

bool is_as_written(const FileSummary& file, const Plan& plan) {
  try {
    check_same_tasks(file.path, plan);
  } catch (const FileError&) {
    return false;
  }
  return true;
}

/// The plan in a file. A model or data set that is gone is known by its name alone, with a warning.
Plan plan_of(const FileSummary& file, Console& console) {
  Job job = stored_job(file, {}, MissingFiles::accepted);
  bool all_there = true;
  for (auto& [written, input] : job.files) {
    if (!input.hash.empty()) continue;
    all_there = false;
    input.hash = input.path.filename();
    console.warn(fmt::format("{}: {}: {} is not there: it is taken for the same as any other of that name",
                             file.path.native(), input.key_path, input.path.native()));
  }
  Plan plan = planned(file, std::move(job));
  if (file.rerun_of_task) {
    if (*file.rerun_of_task < 0 || *file.rerun_of_task >= plan.size()) throw other_program(file, "tasks");
    plan = plan.alone(*file.rerun_of_task, plan.job().values["record"]["trajectory_every"]);
  } else if (all_there && !is_as_written(file, plan)) {
    console.warn(
        fmt::format("{}: the files that its job names have changed since, or this rodsweep expands it "
                    "differently: its tasks are known by what its job means now",
                    file.path.native()));
  }
  if (plan.size() != file.tasks) throw other_program(file, "tasks");
  if (plan.guess_labels() != file.guesses) throw other_program(file, "guesses");
  if (tolerance_ladder() != file.tolerances) throw other_program(file, "tolerances");
  return plan;
}

}  // namespace

ExitCode execute(const CompareOptions& options, Console& console) {
  const FileSummary a = inspect(options.a), b = inspect(options.b);
  const Plan plan_a = plan_of(a, console), plan_b = plan_of(b, console);
  const PlanMatch matched = match(plan_a, plan_b, options.by);
  ComparedFiles files{a,
                      b,
                      options.by,
                      TaskTable(options.a).headline(),
                      job_differences(plan_a.job(), plan_b.job()),
                      static_cast<std::int64_t>(matched.pairs.size()),
                      static_cast<std::int64_t>(matched.only_a.size()),
                      static_cast<std::int64_t>(matched.only_b.size()),
                      compare_sweeps(options.a, plan_a, options.b, plan_b, matched.pairs)};
  using Format = CompareOptions::Format;
  if (options.format == Format::json)
    console.result(comparison_json(files));
  else
    console.raw_result(options.format == Format::csv ? comparison_csv(files, options.tasks)
                                                     : comparison_text(files, options.tasks));
  if (!files.found.damaged.empty())
    console.warn(
        fmt::format("{} not what was written (checksum) in one of the files, and not compared: the first is "
                    "task {} of {}",
                    files.found.damaged.size() == 1 ? "one task is" : "some tasks are", files.found.damaged.front().a,
                    options.a.native()));
  if (files.found.compared == 0)
    throw FileError(fmt::format(
        "{}, so nothing was compared{}", files.both == 0 ? "no task is in both files" : "no task is done in both files",
        files.both == 0 && options.by == MatchBy::everything ? "; --by parameters matches tasks though the jobs differ"
                                                             : ""));
  return files.found.differing.empty() ? ExitCode::ok : ExitCode::tasks_failed;
}

}  // namespace rodsweep
