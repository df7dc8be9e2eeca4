#include "runner/measure/plugin_sources.hpp"

#include "runner/text/beside_program.hpp"

namespace rodsweep {

PluginSource plugin_source(const PluginFile& file) {
  return {file.library, file.options, "plug-in " + file.library.filename().native()};
}

PluginSource plugin_source(const PythonFile& file, PythonClass kind) {
  const std::filesystem::path library = beside_program({"rodsweep-python.so", "../lib/rodsweep/rodsweep-python.so"});
  const std::string name = file.file.filename().native();
  if (library.empty())
    throw PluginError(
        name + ": this program was built without Python; install pybind11-dev and python3-dev, and build it again");
  const char* word = kind == PythonClass::guess ? "Guess" : "Preconditioner";
  std::string options = std::string(word) + '\n' + std::filesystem::absolute(file.file).native() + '\n';
  options += std::to_string(file.inputs.size()) + '\n';
  for (const std::filesystem::path& input : file.inputs) options += std::filesystem::absolute(input).native() + '\n';
  return {library, options + file.options, name};
}

}  // namespace rodsweep
