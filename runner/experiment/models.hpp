// Models by path, each read once in a process: every task that uses one shares it.
#pragma once

#include <filesystem>
#include <memory>

#include "network/processor/model.hpp"

namespace rodsweep {

/// Throws FileError for what is not a model.
std::shared_ptr<const Model> shared_model(const std::filesystem::path& path);

}  // namespace rodsweep
