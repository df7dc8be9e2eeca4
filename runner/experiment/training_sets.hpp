// Training sets of nearest neighbours by data set, each read once in a process: every task that uses one shares it.
#pragma once

#include <filesystem>
#include <memory>

#include "network/guess/knn.hpp"

namespace rodsweep {

/// Of the first so many simulations of a data set, or as many as it has; 0: all. One simulation is in memory at a time.
/// Throws FileError for what is not a data set, SceneError for rods that are no chains.
std::shared_ptr<const KnnSet> shared_knn_set(const std::filesystem::path& data, int simulations,
                                             KnnInputs inputs = KnnInputs::all);

}  // namespace rodsweep
