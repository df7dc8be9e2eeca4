// What readers of files need to know besides the files. `rodsweep schema` prints it under "x-files", and `make schema`
// writes it for the Python package (analysis/rodsweep/reading/constants.json).
#pragma once

#include <nlohmann/json.hpp>

namespace rodsweep {

/// Versions of the files, outcomes of tasks, columns of /tasks that are known before a task runs, names of the job's keys
/// whose values are paths, and the default of solve.iterations, which has no column if no task sets it.
nlohmann::ordered_json reader_constants();

}  // namespace rodsweep
