// The reading functions of runner/training/model_file.hpp.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "runner/file/file_reading.hpp"
#include "runner/file/runs.hpp"
#include "runner/keys/job_reader.hpp"
#include "runner/specs/training_job.hpp"
#include "runner/text/strict_json.hpp"
#include "runner/training/model_file.hpp"
#include "runner/training/model_layout.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Reads a whole dataset. Throws Damage if its extent differs.
template <class T>
std::vector<T> read(hid_t file, const std::string& path, const std::vector<hsize_t>& extent) {
  const std::vector<hsize_t> found = hdf5::extent(hdf5::open_dataset(file, path), path);
  if (found != extent)
    throw Damage("{} has the shape [{}], not [{}]", path, fmt::join(found, ", "), fmt::join(extent, ", "));
  return hdf5::read_all<T>(file, path);
}

std::vector<float> read_finite(hid_t file, const std::string& path, const std::vector<hsize_t>& extent) {
  std::vector<float> values = read<float>(file, path, extent);
  if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }))
    throw Damage(path + " holds a value that is not finite");
  return values;
}

CopingNetSettings read_settings(hid_t file, const fs::path& path) {
  const std::string text = hdf5::read_all<std::string>(file, "/model/settings").at(0);
  JobReader reader(path);
  const auto values = reader.read(network_key(), parse_strict_json(text, path), "/model/settings");
  reader.throw_mistakes();
  return network_settings(values);
}

void read_weights(hid_t file, Parameters<float>& parameters) {
  for (std::size_t i = 0; i < parameters.entries().size(); ++i) {
    const auto& entry = parameters.entries()[i];
    const auto rows = static_cast<hsize_t>(entry.rows), cols = static_cast<hsize_t>(entry.cols);
    const std::vector<float> values = read_finite(file, "/model/weights/" + entry.name, {rows, cols});
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    parameters[static_cast<int>(i)] = Eigen::Map<const RowMajor>(values.data(), entry.rows, entry.cols);
  }
}

Eigen::ArrayXf read_array(hid_t file, const std::string& path, int size) {
  const std::vector<float> values = read_finite(file, path, {static_cast<hsize_t>(size)});
  return Eigen::Map<const Eigen::ArrayXf>(values.data(), size);
}

std::shared_ptr<Model> read_network(hid_t file, const fs::path& path) {
  const CopingNetSettings settings = read_settings(file, path);
  auto model = std::make_shared<Model>(Model{CopingNet<float>(settings, 0), {}});
  read_weights(file, model->net.parameters());
  for (const ScalePlace& place : scale_places) {
    const int size = scale_size(place, settings);
    if (size == 0) continue;
    Normalisation& scale = model->scales.*place.member;
    scale.mean = read_array(file, std::string(place.folder) + "mean", size);
    scale.deviation = read_array(file, std::string(place.folder) + "deviation", size);
    if (!(scale.deviation > 0).all()) throw Damage(std::string(place.folder) + "deviation is not above 0 everywhere");
  }
  if (hdf5::read_text_attribute(file, "/model", "hash") != model_hash(*model))
    throw Damage("the hash of the model differs");
  return model;
}

std::vector<Epoch> read_epochs(hid_t file) {
  constexpr std::size_t columns = ValidationRatio::tolerance_count;
  std::vector<Epoch> epochs(hdf5::read_all<double>(file, epoch_places.front().path).size());
  for (const EpochPlace& place : epoch_places) {
    if (place.optional && !hdf5::exists(file, place.path)) continue;
    const auto values = read<double>(file, place.path, {epochs.size()});
    for (std::size_t i = 0; i < epochs.size(); ++i) epochs[i].*place.member = values[i];
  }
  const auto ratios = read<double>(file, epoch_ratio_path, {epochs.size(), columns});
  for (std::size_t i = 0; i < epochs.size(); ++i)
    std::copy_n(ratios.begin() + static_cast<std::ptrdiff_t>(i * columns), columns, epochs[i].cg_ratio.begin());
  return epochs;
}

std::vector<SceneRatios> read_scenes(hid_t file) {
  constexpr std::size_t columns = ValidationRatio::tolerance_count;
  std::vector<SceneRatios> scenes;
  if (!hdf5::exists(file, scene_types_path)) return scenes;
  for (std::string& type : hdf5::read_all<std::string>(file, scene_types_path))
    scenes.push_back({std::move(type), {}, {}});
  for (const ScenePlace& place : scene_places) {
    const auto ratios = read<double>(file, place.path, {scenes.size(), columns});
    for (std::size_t i = 0; i < scenes.size(); ++i)
      std::copy_n(ratios.begin() + static_cast<std::ptrdiff_t>(i * columns), columns,
                  (scenes[i].*place.member).begin());
  }
  return scenes;
}

ModelCard read_card(hid_t file) {
  ModelCard card;
  card.name = hdf5::read_text_attribute(file, "/job", "name");
  card.job_text = hdf5::read_all<std::string>(file, "/job/text").at(0);
  card.data_path = hdf5::read_all<std::string>(file, "/data/path").at(0);
  card.data_hash = hdf5::read_all<std::string>(file, "/data/hash").at(0);
  for (const CountPlace& place : count_places)
    card.*place.member = hdf5::read_int_attribute(file, place.group, place.name);
  card.epochs = read_epochs(file);
  if (card.best_epoch < 0 || card.best_epoch > static_cast<std::int64_t>(card.epochs.size()))
    throw Damage("the best epoch is {} of {}", card.best_epoch, card.epochs.size());
  for (const RatioPlace& place : ratio_places) {
    const auto ratios = read<double>(file, place.path, {ValidationRatio::tolerance_count});
    std::copy(ratios.begin(), ratios.end(), (card.*place.member).begin());
  }
  card.scenes = read_scenes(file);
  const std::string word = hdf5::read_text_attribute(file, "/training", "ending");
  const auto ending = std::find_if(endings.begin(), endings.end(), [&](const auto& e) { return word == e.second; });
  if (ending == endings.end()) throw Damage("\"{}\" is not an ending of a training", word);
  card.ending = ending->first;
  card.message = hdf5::read_text_attribute(file, "/training", "message");
  card.runs = read_training_runs(file);
  return card;
}

std::optional<Checkpoint> read_checkpoint(hid_t file, std::size_t size) {
  if (!hdf5::exists(file, "/checkpoint")) return std::nullopt;
  const auto numbers = [&](const char* path) {
    const std::vector<float> values = read_finite(file, path, {size});
    return AlignedVector<float>(values.begin(), values.end());
  };
  Checkpoint checkpoint;
  checkpoint.weights = numbers("/checkpoint/weights");
  checkpoint.optimiser.mean = numbers("/checkpoint/mean");
  checkpoint.optimiser.square = numbers("/checkpoint/square");
  checkpoint.optimiser.step = read<std::int64_t>(file, "/checkpoint/step", {1}).front();
  checkpoint.epoch_loss = read<double>(file, "/checkpoint/epoch_loss", {1}).front();
  checkpoint.epoch_seconds = read<double>(file, "/checkpoint/epoch_s", {1}).front();
  if (const char* path = "/checkpoint/epoch_processor_s"; hdf5::exists(file, path))
    checkpoint.epoch_processor_seconds = read<double>(file, path, {1}).front();
  return checkpoint;
}

hdf5::File open_model(const fs::path& path) {
  hdf5::File file = open_own(path, "models");
  reading(path, [&] {
    if (const std::string kind = kind_of(file); kind != "model")
      throw FileError("{} holds the results of a {}, not a model: give the file of a job of kind \"train\"",
                      path.native(), kind);
    check_version(file, path, model_schema_version);
  });
  return file;
}

}  // namespace

bool is_model_file(const fs::path& path) {
  const hdf5::File file = open_own(path, "results");
  return reading(path, [&] { return kind_of(file) == "model"; });
}

StoredModel read_training(const fs::path& path) {
  const hdf5::File file = open_model(path);
  return reading(path, [&] {
    StoredModel stored{read_network(file.id(), path), read_card(file.id()), std::nullopt};
    stored.checkpoint = read_checkpoint(file.id(), stored.model->net.parameters().values().size());
    return stored;
  });
}

StoredModel read_model(const fs::path& path) {
  StoredModel stored = read_training(path);
  if (stored.card.best_epoch > 0) return stored;
  throw FileError("{} holds no trained model yet: no epoch of its training has ended", path.native());
}

}  // namespace rodsweep
