#include "runner/measure/shared_inputs.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "runner/dataset/dataset_reader.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/text/beside_program.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {
namespace {

using Wanted = std::tuple<std::filesystem::path, int, KnnInputs>;

std::shared_ptr<const KnnSet> read_set(const Wanted& wanted, std::optional<MPI_Comm> ranks) {
  static std::map<Wanted, std::shared_ptr<const KnnSet>> sets;
  std::shared_ptr<const KnnSet>& shared = sets[wanted];
  if (shared) return shared;
  const auto& [data, simulations, inputs] = wanted;
  const DatasetReader reader(data, ranks);
  const std::int64_t count = simulations > 0 ? std::min<std::int64_t>(simulations, reader.size()) : reader.size();
  const auto set = std::make_shared<KnnSet>(inputs);
  for (std::int64_t i = 0; i < count; ++i) set->add(reader.read(i));
  set->finish();
  shared = set;
  return shared;
}

}  // namespace

std::shared_ptr<const Model> shared_model(const std::filesystem::path& path) {
  static std::map<std::filesystem::path, std::shared_ptr<const Model>> models;
  std::shared_ptr<const Model>& model = models[path];
  if (!model) model = read_model(path).model;
  return model;
}

std::shared_ptr<const KnnSet> shared_knn_set(const std::filesystem::path& data, int simulations, KnnInputs inputs) {
  return read_set({data, simulations, inputs}, std::nullopt);
}

void read_knn_sets(const Plan& plan, MPI_Comm ranks) {
  const InputFiles& files = plan.job().files;
  const auto is_set = [](const auto& file) { return file.second.is_used_as(FileKind::data_set); };
  if (std::none_of(files.begin(), files.end(), is_set)) return;
  std::set<Wanted> all;
  for (const Task& task : plan.tasks())
    for (const GuessSpec& guess : plan.spec(task.index).guesses)
      if (const auto* knn = find_guess<guess::Knn>(guess)) all.emplace(knn->data, knn->simulations, knn->inputs);
  collectively(ranks, [&] {
    for (const Wanted& wanted : all) read_set(wanted, ranks);
  });
}

PluginSource plugin_source(const PluginFile& file) {
  return {file.library, file.options, "plug-in " + file.library.filename().native()};
}

PluginSource plugin_source(const PythonFile& file, PythonClass kind) {
  const std::filesystem::path library = beside_program({"rodsweep-python.so", "../lib/rodsweep/rodsweep-python.so"});
  const std::string name = file.file.filename().native();
  if (library.empty())
    throw PluginError(
        name + ": this program was built without Python; install pybind11-dev and python3-dev, and build it again");
  const char* word = kind == PythonClass::guess ? "Guess" : "Preconditioner";
  std::string options = std::string(word) + '\n' + std::filesystem::absolute(file.file).native() + '\n';
  options += std::to_string(file.inputs.size()) + '\n';
  for (const std::filesystem::path& input : file.inputs) options += std::filesystem::absolute(input).native() + '\n';
  return {library, options + file.options, name};
}

}  // namespace rodsweep
