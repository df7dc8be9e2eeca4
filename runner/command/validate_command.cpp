#include "runner/command/validate_command.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "runner/experiment/inputs.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {
namespace {

std::string extent_text(const Job& job) {
  if (is_training(job)) return "trains a model";
  const Plan plan(job);
  return fmt::format("{} task{}", plan.size(), plan.size() == 1 ? "" : "s");
}

/// jobs/schema.json stands among the jobs, and `validate jobs/*.json` should pass.
bool is_json_schema(const std::filesystem::path& path) {
  std::ifstream in(path);
  const auto json = nlohmann::json::parse(in, nullptr, false);
  const auto found = json.is_object() ? json.find("$schema") : json.end();
  return json.is_object() && found != json.end() && found->is_string() &&
         found->get<std::string>().find("json-schema.org/") != std::string::npos;
}

}  // namespace

ExitCode execute(const ValidateOptions& options, Console& console) {
  ExitCode code = ExitCode::ok;
  for (const auto& path : options.jobs) {
    if (is_json_schema(path)) {
      console.result(fmt::format("{}: a JSON Schema for editors, not a job", path.native()));
      continue;
    }
    try {
      const Job job = read_job(path, MissingFiles::accepted);
      check_inputs(job);
      console.result(fmt::format("{}: sound, {}", path.native(), extent_text(job)));
      for (const auto& [written, file] : job.files)
        if (file.hash.empty())
          console.note(fmt::format("{}: {}: {} is not there yet", path.native(), file.key_path, file.path.native()));
    } catch (const JobError& error) {
      console.error(error.what());
      code = ExitCode::user_error;
    }
  }
  return code;
}

}  // namespace rodsweep
