// A cache of models by path: each is read once per process and shared by all tasks.
#pragma once

#include <filesystem>
#include <memory>

#include "network/processor/model.hpp"

namespace rodsweep {

/// Throws FileError if the file is not a model.
std::shared_ptr<const Model> shared_model(const std::filesystem::path& path);

}  // namespace rodsweep
