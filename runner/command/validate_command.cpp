#include "runner/command/commands.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "runner/file/file_error.hpp"
#include "runner/measure/plan_check.hpp"
#include "runner/plan/plan.hpp"
#include "runner/specs/training_job.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/training/learning_sets.hpp"

namespace rodsweep {
namespace {

std::string extent_text(const Job& job) {
  if (is_training(job)) return "trains a model";
  const Plan plan = missing_files(job).empty() ? checked_plan(job) : Plan(job);
  return count_text(plan.size(), "task");
}

/// The JSON of a file, without the checks for a job; null if the file cannot be read or is not JSON.
nlohmann::json glance(const std::filesystem::path& path) {
  try {
    return nlohmann::json::parse(read_job_text(path), nullptr, false);
  } catch (const JobError&) {
    return nullptr;
  }
}

std::string text_of(const nlohmann::json& json, const char* key) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return json.is_object() && found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

/// Throws JobError if a training cannot use its data sets. Skipped while a file is missing.
void check_data(const Job& job) {
  if (!is_training(job) || !missing_files(job).empty()) return;
  try {
    const LearningSets sets(training_job(job.values, job.path), job);
  } catch (const FileError& error) {
    throw job_error(job.path, "data", error.what());
  }
}

/// jobs/schema.json is in the folder of the jobs; `validate jobs/*.json` must accept it.
bool is_json_schema(const nlohmann::json& json) {
  return text_of(json, "$schema").find("json-schema.org/") != std::string::npos;
}

/// Maps NAME to the job that makes the data set or model NAME.h5.
std::map<std::string, std::filesystem::path> makers(const std::vector<std::filesystem::path>& jobs) {
  std::map<std::string, std::filesystem::path> found;
  for (const auto& path : jobs) {
    const nlohmann::json job = glance(path);
    if (text_of(job, "kind") != "sweep") found.emplace(text_of(job, "name"), path);
  }
  return found;
}

class Validation {
 public:
  Validation(const ValidateOptions& options, Console& console)
      : options_(options), makers_(makers(options.jobs)), console_(console) {}

  /// Throws JobError.
  void check(const std::filesystem::path& path) {
    const Job job = read_job(path, MissingFiles::accepted);
    const std::vector<std::string> notes = check_missing(job);
    check_inputs(job);
    check_data(job);
    console_.result(fmt::format("{}: valid, {}", path.native(), extent_text(job)));
    for (const std::string& note : notes) console_.note(note);
    for (const std::string& warning : job.warnings) console_.warn(warning);
  }

 private:
  /// One note per missing file that another job makes. Throws JobError for the other missing files.
  std::vector<std::string> check_missing(const Job& job) const {
    std::string mistakes;
    std::vector<std::string> notes;
    for (const MissingFile& file : missing_files(job)) {
      const auto maker = makers_.find(file.path.stem().native());
      const bool made = maker != makers_.end() && maker->second != job.path;
      if (made || options_.later)
        notes.push_back(fmt::format("{}: {}: {} does not exist yet{}", job.path.native(), file.key_path,
                                    file.path.native(), made ? "; " + maker->second.native() + " makes it" : ""));
      else
        mistakes += (mistakes.empty() ? "" : "\n") + missing_file_text(job.path, file);
    }
    if (!mistakes.empty())
      throw JobError("{}\n{}: to accept a file that another job makes, also give that job, or use --later", mistakes,
                     job.path.native());
    return notes;
  }

  const ValidateOptions& options_;
  std::map<std::string, std::filesystem::path> makers_;
  Console& console_;
};

}  // namespace

ExitCode execute(const ValidateOptions& options, Console& console) {
  ExitCode code = ExitCode::ok;
  Validation validation(options, console);
  for (const auto& path : options.jobs) {
    if (is_json_schema(glance(path))) {
      console.result(fmt::format("{}: a JSON Schema for editors, not a job", path.native()));
      continue;
    }
    try {
      validation.check(path);
    } catch (const JobError& error) {
      console.error(error.what());
      code = ExitCode::user_error;
    }
  }
  return code;
}

}  // namespace rodsweep
