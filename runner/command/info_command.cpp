#include "runner/command/info_command.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "runner/command/file_report.hpp"
#include "runner/command/training_summary.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/resume_check.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {

namespace {

std::string provenance_text(const FileSummary& file) {
  std::string text =
      fmt::format("file     {}, {}, schema {}\njob      {} ({})\nplan     {}, hash {}\n", file.path.native(),
                  bytes_text(static_cast<std::int64_t>(file.bytes)), file.schema_version, file.job_name, file.job_kind,
                  counted(file.tasks, "task"), file.plan_hash);
  if (file.rerun_of_task)
    text += fmt::format("holds    only task {} of the job, from `rodsweep rerun`\n", *file.rerun_of_task);
  if (!file.guesses.empty()) text += fmt::format("guesses  {}\n", fmt::join(file.guesses, ", "));
  text += fmt::format("done     {} of {}: {}\n", file.done, counted(file.tasks, "task"), outcomes_text(file));
  if (file.momentum_residual)
    text += fmt::format("momentum residual of a segment: at most {:.2g} of the greatest joint force in a step\n",
                        *file.momentum_residual);
  for (std::size_t i = 0; i < file.runs.size(); ++i) {
    const Provenance& p = file.runs[i].provenance;
    text += run_text(file, i);
    text += fmt::format("  command   {}\n  revision  {}\n  versions  {}\n", p.user_command, p.revision, p.versions);
    if (!p.petsc_options.empty()) text += fmt::format("  PETSC_OPTIONS  {}\n", p.petsc_options);
  }
  text.pop_back();
  return text;
}

ExitCode show_model(const InfoOptions& options, Console& console) {
  const StoredModel stored = read_training(options.file);
  if (options.job) {
    console.raw_result(stored.card.job_text);
  } else if (options.json) {
    console.result(json_text(to_json(stored, options.file)));
  } else {
    console.result(training_summary(stored.card, options.file) + '\n' + provenance_text(stored));
    if (options.verify) console.result("verified: the model is intact");  // reading it checks this
  }
  return ExitCode::ok;
}

/// Checks what task checksums don't cover (parameters, axes, row positions) against a plan rebuilt from the job.
/// Returns false if it can't: a rerun, a file of another revision, or a job with input files.
bool verify_plan(const FileSummary& file) {
  if (file.rerun_of_task || file.runs.empty() || file.runs.front().provenance.revision != source_revision())
    return false;
  try {
    const Job job = parse_job(file.job_text, stored_job_path(file), MissingFiles::accepted);
    if (!job.files.empty()) return false;  // they may have changed
    check_same_plan(file.path, Plan(job), "This is that revision, so the file is damaged: create it again");
    return true;
  } catch (const JobError& error) {
    throw damaged_error(file.path, error.what());
  }
}

}  // namespace

ExitCode execute(const InfoOptions& options, Console& console) {
  if (is_model_file(options.file)) return show_model(options, console);
  const FileSummary file = inspect(options.file);
  if (options.job) {
    console.raw_result(file.job_text);
    return ExitCode::ok;
  }
  const Verification verified = options.verify ? verify(options.file) : Verification{};
  const bool plan_verified = options.verify && verify_plan(file);
  if (options.json) {
    using Json = nlohmann::ordered_json;
    Json json = to_json(file);
    json["bytes"] = file.bytes;
    json["kind"] = file.job_kind;
    json["schema_version"] = file.schema_version;
    json["plan_hash"] = file.plan_hash;
    if (file.rerun_of_task) json["rerun_of_task"] = *file.rerun_of_task;
    json["guesses"] = file.guesses;
    json["momentum_residual"] = file.momentum_residual ? Json(*file.momentum_residual) : Json();
    json["tolerances"] = file.tolerances;
    if (options.verify) json["verified"] = {{"checked", verified.checked}, {"damaged", verified.damaged}};
    console.result(json_text(json));
  } else {
    console.result(provenance_text(file));
    if (options.verify)
      console.result(
          fmt::format("verified {} finished tasks: {}{}", verified.checked,
                      verified.damaged.empty() ? "all intact" : fmt::format("{} damaged", verified.damaged.size()),
                      plan_verified ? "; the parameters match the job" : ""));
  }
  if (verified.damaged.empty()) return ExitCode::ok;
  console.error(
      fmt::format("{} is damaged: wrong checksum of task{} {}. Run its job with --resume to repeat damaged tasks; if "
                  "it is a compressed copy, copy the original again",
                  options.file.native(), verified.damaged.size() == 1 ? "" : "s", fmt::join(verified.damaged, ", ")));
  return ExitCode::damaged;
}

}  // namespace rodsweep
