#include "runner/measure/inputs.hpp"

#include "runner/dataset/dataset_reader.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/measure/factor_check.hpp"
#include "runner/measure/guess_check.hpp"
#include "runner/measure/models.hpp"
#include "runner/measure/plugin_sources.hpp"

namespace rodsweep {
namespace {

/// Executes a file of Python; does nothing with another.
void open_python(const std::filesystem::path& path, FileKind kind) {
  if (kind == FileKind::python_guess) PluginInstance(plugin_source({path, ""}, PythonClass::guess), nullptr, 0);
  if (kind == FileKind::python_preconditioner)
    PluginInstance(plugin_source({path, ""}, PythonClass::preconditioner), nullptr, 0);
}

void open_input(const std::filesystem::path& path, FileKind kind) {
  switch (kind) {
    case FileKind::any: return;
    case FileKind::model: shared_model(path); return;
    case FileKind::data_set: DatasetReader{path}; return;
    case FileKind::skeleton:
    case FileKind::curves: return;  // the plan reads these
    case FileKind::plugin: Plugin(plugin_source({path, ""})); return;
    case FileKind::python_guess:
    case FileKind::python_preconditioner: open_python(path, kind); return;
  }
}

}  // namespace

void check_inputs(const Job& job) {
  for (const auto& [written, file] : job.files) {
    if (file.hash.empty()) continue;
    for (const auto& [key_path, kind] : file.uses) {
      try {
        open_input(file.path, kind);
      } catch (const FileError& error) {
        throw job_error(job.path, key_path, error.what());
      } catch (const PluginError& error) {
        throw job_error(job.path, key_path, error.what());
      }
    }
  }
}

void load_python(const Job& job) {
  for (const auto& [written, file] : job.files)
    for (const FileUse& use : file.uses) open_python(file.path, use.kind);
}

Plan checked_plan(const Job& job) {
  Plan plan(job);
  check_guesses(plan);
  check_factors(plan);
  return plan;
}

}  // namespace rodsweep
