// A cache of training sets of nearest neighbours: each is read once per process and shared by all tasks. Ranks can read
// sets collectively, so that only one of them reads from the disk.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <memory>

#include "network/guess/knn.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// The set of the first `simulations` simulations of a data set; 0: all. Only one simulation is in memory at a time.
/// Throws FileError if the file is not a data set, SceneError if a rod is not a chain.
std::shared_ptr<const KnnSet> shared_knn_set(const std::filesystem::path& data, int simulations,
                                             KnnInputs inputs = KnnInputs::all);

/// Collective: reads the sets of all guesses of a plan. Throws CollectiveError.
void read_knn_sets(const Plan& plan, MPI_Comm ranks);

}  // namespace rodsweep
