#include "runner/experiment/inputs.hpp"

#include "runner/dataset/dataset_reader.hpp"
#include "runner/experiment/factor_check.hpp"
#include "runner/experiment/guess_check.hpp"
#include "runner/experiment/models.hpp"
#include "runner/experiment/plugin_sources.hpp"
#include "runner/file/file_reading.hpp"

namespace rodsweep {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void open_input(const InputFile& file) {
  if (ends_with(file.key_path, "model"))
    shared_model(file.path);
  else if (ends_with(file.key_path, "library"))
    Plugin(plugin_source({file.path, ""}));
  else if (ends_with(file.key_path, "python.file"))
    PluginInstance(plugin_source({file.path, ""}, PythonClass::guess), nullptr, 0);
  else if (ends_with(file.key_path, "python_preconditioner.file"))
    PluginInstance(plugin_source({file.path, ""}, PythonClass::preconditioner), nullptr, 0);
  else if (!ends_with(file.key_path, "skeleton") && !ends_with(file.key_path, "curves"))  // the plan reads these
    DatasetReader reader(file.path);
}

}  // namespace

void check_inputs(const Job& job) {
  for (const auto& [written, file] : job.files) {
    if (file.hash.empty()) continue;
    try {
      open_input(file);
    } catch (const FileError& error) {
      throw job_error(job.path, file.key_path, error.what());
    } catch (const PluginError& error) {
      throw job_error(job.path, file.key_path, error.what());
    }
  }
}

Plan checked_plan(const Job& job) {
  Plan plan(job);
  check_guesses(plan);
  check_factors(plan);
  return plan;
}

}  // namespace rodsweep
