// What tasks share of a job's input files: models and training sets of nearest neighbours, each read once per process, and
// plug-ins: shared libraries, and the one that runs Python files.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <memory>

#include "network/guess/knn.hpp"
#include "network/processor/model.hpp"
#include "runner/plan/plan.hpp"
#include "runner/specs/guess_spec.hpp"
#include "solver/plugin/plugin.hpp"

namespace rodsweep {

/// Throws FileError if the file is not a model.
std::shared_ptr<const Model> shared_model(const std::filesystem::path& path);

/// The set of the first `simulations` simulations of a data set; 0: all. Only one simulation is in memory at a time.
/// Throws FileError if the file is not a data set, SceneError if a rod is not a chain.
std::shared_ptr<const KnnSet> shared_knn_set(const std::filesystem::path& data, int simulations,
                                             KnnInputs inputs = KnnInputs::all);

/// Collective: reads the sets of all guesses of a plan, so that only one rank reads from the disk. Throws CollectiveError.
void read_knn_sets(const Plan& plan, MPI_Comm ranks);

enum class PythonClass { guess, preconditioner };

PluginSource plugin_source(const PluginFile& file);
/// Throws PluginError if the program was built without Python.
PluginSource plugin_source(const PythonFile& file, PythonClass kind);

}  // namespace rodsweep
