// The plug-ins of a job: its shared libraries, and the one that runs its Python files.
#pragma once

#include "runner/specs/plugin_file.hpp"
#include "solver/plugin/plugin.hpp"

namespace rodsweep {

enum class PythonClass { guess, preconditioner };

PluginSource plugin_source(const PluginFile& file);
/// Throws PluginError if the program was built without Python.
PluginSource plugin_source(const PythonFile& file, PythonClass kind);

}  // namespace rodsweep
