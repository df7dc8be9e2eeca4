#include "runner/training/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "runner/file/hdf5.hpp"
#include "runner/file/runs.hpp"
#include "runner/specs/training_job.hpp"
#include "runner/text/checksum.hpp"
#include "runner/training/model_layout.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

hdf5::Object open_group(hid_t file, const char* path) {
  return hdf5::Object(hdf5::check(H5Oopen(file, path, H5P_DEFAULT), "H5Oopen", path));
}

void write_epochs(hid_t file, const ModelCard& card) {
  const hsize_t rows = card.epochs.size();
  for (const EpochPlace& place : epoch_places) {
    std::vector<double> values;
    for (const Epoch& epoch : card.epochs) values.push_back(epoch.*place.member);
    hdf5::store(file, place.path, {rows}, values, place.unit, place.meaning);
  }
  std::vector<double> ratios;
  for (const Epoch& epoch : card.epochs) ratios.insert(ratios.end(), epoch.cg_ratio.begin(), epoch.cg_ratio.end());
  hdf5::store(
      file, epoch_ratio_path, {rows, ValidationRatio::tolerance_count}, ratios, "1",
      "CG iterations over those from zero, mean over validation simulations; NaN: not measured after this epoch");
}

void write_scenes(hid_t file, const std::vector<SceneRatios>& scenes) {
  if (scenes.empty()) return;
  std::vector<std::string> types;
  for (const SceneRatios& of : scenes) types.push_back(of.scene);
  hdf5::store_texts(file, scene_types_path, types);
  for (const ScenePlace& place : scene_places) {
    std::vector<double> ratios;
    for (const SceneRatios& of : scenes)
      ratios.insert(ratios.end(), (of.*place.member).begin(), (of.*place.member).end());
    hdf5::store(file, place.path, {scenes.size(), ValidationRatio::tolerance_count}, ratios, "1", place.meaning);
  }
}

void write_card(hid_t file, const ModelCard& card) {
  hdf5::write_attribute(file, "program", "rodsweep");
  hdf5::write_attribute(file, "schema_version", model_schema_version);
  hdf5::write_attribute(file, "kind", "model");
  hdf5::write_attribute(file, "title", "rodsweep model: " + card.name);
  hdf5::store_texts(file, "/job/text", {card.job_text});
  hdf5::store_texts(file, "/data/path", {card.data_path});
  hdf5::store_texts(file, "/data/hash", {card.data_hash});
  create_training_runs(file, card.runs);
  hdf5::store(file, "/axes/tolerance", {ValidationRatio::tolerance_count}, ValidationRatio::tolerances(), "1",
              "tolerances of CG, relative to ||b||");
  write_epochs(file, card);
  for (const RatioPlace& place : ratio_places)
    hdf5::store(file, place.path, {ValidationRatio::tolerance_count}, card.*place.member, "1", place.meaning);
  write_scenes(file, card.scenes);
  for (const CountPlace& place : count_places)
    hdf5::write_attribute(open_group(file, place.group).id(), place.name,
                          static_cast<std::int32_t>(card.*place.member));
  hdf5::write_attribute(open_group(file, "/job").id(), "name", card.name);
  const hdf5::Object training = open_group(file, "/training");
  const auto ending =
      std::find_if(endings.begin(), endings.end(), [&](const auto& e) { return e.first == card.ending; });
  hdf5::write_attribute(training.id(), "ending", ending->second);
  hdf5::write_attribute(training.id(), "message", card.message);
}

void write_scale(hid_t file, const std::string& folder, const Normalisation& scale) {
  const std::vector<hsize_t> extent{static_cast<hsize_t>(scale.mean.size())};
  const std::vector<float> mean(scale.mean.begin(), scale.mean.end());
  const std::vector<float> deviation(scale.deviation.begin(), scale.deviation.end());
  hdf5::store(file, folder + "mean", extent, mean, "",
              "in the unit of each feature (network/encoding/graph_encoding.hpp)");
  hdf5::store(file, folder + "deviation", extent, deviation, "", "input of the network: (feature - mean) / deviation");
}

void write_model(hid_t file, const Model& model) {
  const CopingNetSettings& settings = model.net.settings();
  hdf5::store_texts(file, "/model/settings", {network_json(settings).dump()});
  const Parameters<float>& parameters = model.net.parameters();
  for (std::size_t i = 0; i < parameters.entries().size(); ++i) {
    const auto& entry = parameters.entries()[i];
    const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> weights =
        parameters[static_cast<int>(i)];
    const std::string path = "/model/weights/" + entry.name;
    const hdf5::Dataset dataset = hdf5::create_dataset(
        file, path, H5T_NATIVE_FLOAT, {static_cast<hsize_t>(entry.rows), static_cast<hsize_t>(entry.cols)});
    hdf5::check(H5Dwrite(dataset.id(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, weights.data()), "H5Dwrite",
                path);
  }
  for (const ScalePlace& place : scale_places)
    if (scale_size(place, settings) > 0) write_scale(file, place.folder, model.scales.*place.member);
  hdf5::write_attribute(open_group(file, "/model").id(), "hash", model_hash(model));
}

void write_checkpoint(hid_t file, const Checkpoint& checkpoint) {
  const std::vector<hsize_t> extent{checkpoint.weights.size()};
  hdf5::store(file, "/checkpoint/weights", extent, checkpoint.weights, "1", "current weights, padding included");
  hdf5::store(file, "/checkpoint/mean", extent, checkpoint.optimiser.mean, "1", "Adam's mean of gradients");
  hdf5::store(file, "/checkpoint/square", extent, checkpoint.optimiser.square, "1", "Adam's mean of their squares");
  hdf5::store(file, "/checkpoint/step", {1}, std::vector<std::int64_t>{checkpoint.optimiser.step}, "1", "steps taken");
  hdf5::store(file, "/checkpoint/epoch_loss", {1}, std::vector<double>{checkpoint.epoch_loss}, "1",
              "sum of the step losses in the current epoch");
  hdf5::store(file, "/checkpoint/epoch_s", {1}, std::vector<double>{checkpoint.epoch_seconds}, "s",
              "time spent on the current epoch");
  hdf5::store(file, "/checkpoint/epoch_processor_s", {1}, std::vector<double>{checkpoint.epoch_processor_seconds}, "s",
              "processor time of all ranks spent on it");
}

}  // namespace

std::string model_hash(const Model& model) {
  const std::string settings = network_json(model.net.settings()).dump();
  const AlignedVector<float>& weights = model.net.parameters().values();
  Checksum sum;
  sum.add(settings.data(), settings.size());
  sum.add(weights.data(), weights.size() * sizeof(float));
  for (const ScalePlace& place : scale_places) {
    const auto size = static_cast<std::size_t>(scale_size(place, model.net.settings()));
    if (size == 0) continue;
    const Normalisation& scale = model.scales.*place.member;
    sum.add(scale.mean.data(), size * sizeof(float));
    sum.add(scale.deviation.data(), size * sizeof(float));
  }
  return fmt::format("{:016x}", sum.value());
}

ModelFile::ModelFile(fs::path path, bool continues) : path_(std::move(path)) {
  if (continues) earlier_ = identity_of(path_);
}

void ModelFile::save(const ModelCard& card, const Model& model, const std::optional<Checkpoint>& checkpoint) {
  if (!earlier_) make_folder_of(path_);
  const UnfinishedFile unfinished(path_);
  unfinished.check_creatable();
  hdf5::File file = hdf5::create_file(unfinished.path());
  write_card(file.id(), card);
  write_model(file.id(), model);
  if (checkpoint) write_checkpoint(file.id(), *checkpoint);
  hdf5::close(file, "H5Fclose", unfinished.path().native());
  if (earlier_)
    unfinished.replace(*earlier_);
  else
    unfinished.publish();
  earlier_ = identity_of(path_);
}

}  // namespace rodsweep
