#include "runner/experiment/training_sets.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "runner/dataset/dataset_reader.hpp"

namespace rodsweep {

std::shared_ptr<const KnnSet> shared_knn_set(const std::filesystem::path& data, int simulations, KnnInputs inputs) {
  static std::map<std::tuple<std::filesystem::path, int, KnnInputs>, std::shared_ptr<const KnnSet>> sets;
  std::shared_ptr<const KnnSet>& shared = sets[{data, simulations, inputs}];
  if (shared) return shared;
  const DatasetReader reader(data);
  const std::int64_t count = simulations > 0 ? std::min<std::int64_t>(simulations, reader.size()) : reader.size();
  const auto set = std::make_shared<KnnSet>(inputs);
  for (std::int64_t i = 0; i < count; ++i) set->add(reader.read(i));
  set->finish();
  shared = set;
  return shared;
}

}  // namespace rodsweep
