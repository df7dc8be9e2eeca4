// Training sets of nearest neighbours by data set, each read once in a process: every task that uses one shares it.
// Ranks can read what they will need together, so that one of them reads it from the disk.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <memory>

#include "network/guess/knn.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Of the first so many simulations of a data set, or as many as it has; 0: all. One simulation is in memory at a time.
/// Throws FileError for what is not a data set, SceneError for rods that are no chains.
std::shared_ptr<const KnnSet> shared_knn_set(const std::filesystem::path& data, int simulations,
                                             KnnInputs inputs = KnnInputs::all);

/// Collective: of all guesses of a plan. Throws CollectiveError.
void read_knn_sets(const Plan& plan, MPI_Comm ranks);

}  // namespace rodsweep
