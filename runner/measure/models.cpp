#include "runner/measure/models.hpp"

#include <map>

#include "runner/training/model_file.hpp"

namespace rodsweep {

std::shared_ptr<const Model> shared_model(const std::filesystem::path& path) {
  static std::map<std::filesystem::path, std::shared_ptr<const Model>> models;
  std::shared_ptr<const Model>& model = models[path];
  if (!model) model = read_model(path).model;
  return model;
}

}  // namespace rodsweep
