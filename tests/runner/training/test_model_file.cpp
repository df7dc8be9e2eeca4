// Model files: what is written is read back; other files are refused.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>

#include "runner/file/hdf5.hpp"
#include "runner/specs/training_job.hpp"
#include "runner/training/model_file.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/runner/file_examples.hpp"

namespace rodsweep {
namespace test_model_file {

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;
namespace fs = std::filesystem;

ModelCard some_card() {
  ModelCard card;
  card.name = "net";
  card.job_text = train_job().dump();
  card.data_path = "/data/bending.h5";
  card.data_hash = "0123456789abcdef";
  card.training_simulations = 256;
  card.validation_simulations = 100;
  card.training_examples = 12800;
  card.validation_examples = 5000;
  card.planned_epochs = 5;
  card.epochs = {{0.5, 0.6, 1e-3, 2.5, ValidationRatio::unmeasured(), 4.75},
                 {0.4, 0.55, 2e-3, 2.25, {0.1, 0.2, 0.3, 0.4}, 4.5}};
  card.best_epoch = 2;
  card.ending = Ending::early;
  card.message = "enough";
  card.cg_ratio = {0.1, 0.2, 0.3, 0.4};
  card.base_cg_ratio = {0.5, 0.6, 0.7, 0.8};
  card.ratio_simulations = 50;
  card.scenes = {{"helix", {0.1, 0.3, 0.5, 0.7}, {0.2, 0.4, 0.6, 0.8}}, {"knot", {0, 0, 0, 1}, {1, 1, 1, 1}}};
  card.runs = {{test_provenance(), "2025-11-21T16:05:09Z", 4}, {test_provenance(), "", -1}};
  for (RunRow& run : card.runs) run.provenance.begin_utc = "2026-01-02T03:04:05Z";  // a fixed time
  card.runs[1].provenance.oversubscribed = true;
  return card;
}

/// A model whose numbers all differ.
std::shared_ptr<Model> some_model(const CopingNetSettings& settings, unsigned seed = 1) {
  const std::shared_ptr<Model> model = test::random_model(settings, seed);
  const auto vary = [&](Normalisation& scale) {
    for (Eigen::Index i = 0; i < scale.mean.size(); ++i) {
      scale.mean[i] = 0.1F * static_cast<float>(i);
      scale.deviation[i] = 1 + 0.01F * static_cast<float>(i);
    }
  };
  for (Normalisation* scale :
       {&model->scales.nodes, &model->scales.edges, &model->scales.multipliers, &model->scales.moves})
    vary(*scale);
  return model;
}

fs::path save(const fs::path& path, const Model& model, const ModelCard& card = some_card(),
              const std::optional<Checkpoint>& checkpoint = std::nullopt) {
  ModelFile(path, false).save(card, model, checkpoint);
  return path;
}

void check_same(const ModelCard& a, const ModelCard& b) {
  const auto training = [](const ModelCard& c) {
    return std::tie(c.name, c.job_text, c.data_path, c.data_hash, c.training_simulations, c.validation_simulations,
                    c.training_examples, c.validation_examples, c.planned_epochs);
  };
  const auto result = [](const ModelCard& c) {
    return std::tie(c.best_epoch, c.ending, c.message, c.cg_ratio, c.base_cg_ratio, c.ratio_simulations);
  };
  CHECK((training(a) == training(b)));
  CHECK((result(a) == result(b)));
  const auto same_scene = [](const SceneRatios& x, const SceneRatios& y) {
    return x.scene == y.scene && x.cg_ratio == y.cg_ratio && x.base_cg_ratio == y.base_cg_ratio;
  };
  CHECK(std::equal(a.scenes.begin(), a.scenes.end(), b.scenes.begin(), b.scenes.end(), same_scene));
  const auto epoch = [](const Epoch& e) {
    return std::tie(e.training_loss, e.validation_loss, e.rate, e.seconds, e.processor_seconds);
  };
  REQUIRE(a.epochs.size() == b.epochs.size());
  for (std::size_t i = 0; i < a.epochs.size(); ++i) {
    CHECK((epoch(a.epochs[i]) == epoch(b.epochs[i])));
    CHECK(std::isnan(a.epochs[i].cg_ratio[3]) == std::isnan(b.epochs[i].cg_ratio[3]));
  }
  CHECK(a.epochs.back().cg_ratio == b.epochs.back().cg_ratio);
  const auto fields = [](const RunRow& s) {
    return std::tie(s.end_utc, s.exit_code, s.provenance.begin_utc, s.provenance.versions, s.provenance.ranks,
                    s.provenance.oversubscribed);
  };
  const auto same_run = [&](const RunRow& x, const RunRow& y) { return fields(x) == fields(y); };
  CHECK(std::equal(a.runs.begin(), a.runs.end(), b.runs.begin(), b.runs.end(), same_run));
}

bool same(const Normalisation& a, const Normalisation& b) {
  return a.mean.size() == b.mean.size() && (a.mean == b.mean).all() && (a.deviation == b.deviation).all();
}

TEST_CASE("a model of every kind is read as it was written") {
  const TemporaryFolder folder;
  std::vector<CopingNetSettings> kinds = test::kinds_of_networks();
  kinds.push_back(test::message_passing(Encoding::paper_residual, true));
  kinds.back().globals = true;
  kinds.push_back(kinds.back());
  kinds.back().encoding = Encoding::state;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    CAPTURE(i);
    const auto model = some_model(kinds[i]);
    const StoredModel read = read_model(save(folder / fmt::format("{}.h5", i), *model));
    CHECK(read.model->net.parameters().values() == model->net.parameters().values());
    CHECK(network_json(read.model->net.settings()) == network_json(kinds[i]));
    CHECK(model_hash(*read.model) == model_hash(*model));
    if (has_scales(kinds[i])) {
      CHECK(same(read.model->scales.nodes, model->scales.nodes));
      CHECK(same(read.model->scales.edges, model->scales.edges));
      if (is_guess(kinds[i])) CHECK(same(read.model->scales.multipliers, model->scales.multipliers));
      if (kinds[i].moves) CHECK(same(read.model->scales.moves, model->scales.moves));
    }
    CHECK_FALSE(read.checkpoint);
    check_same(read.card, some_card());
  }
}

TEST_CASE("models that say something else have another hash") {
  CopingNetSettings settings;
  settings.encoding = Encoding::paper_residual;
  settings.processor = Processor::message_passing;
  const auto model = some_model(settings);
  const std::string hash = model_hash(*model);
  CHECK(hash.size() == 16);
  CHECK(model_hash(*some_model(settings)) == hash);
  model->scales.edges.deviation[3] *= 1.5F;
  CHECK(model_hash(*model) != hash);
  CHECK(model_hash(*some_model(settings, 2)) != hash);
  settings.best_length = false;
  CHECK(model_hash(*some_model(settings)) != hash);
}

TEST_CASE("a model of twenty thousand parameters is small, and a checkpoint is read as it was written") {
  const TemporaryFolder folder;
  CopingNetSettings settings;
  settings.latent = 64;
  const auto model = some_model(settings);
  CHECK(model->net.parameters().values().size() > 19000);
  CHECK(fs::file_size(save(folder / "small.h5", *model)) < 200000);

  ModelCard card = some_card();
  card.ending = Ending::none;
  Checkpoint checkpoint;
  checkpoint.weights = some_model(settings, 2)->net.parameters().values();
  checkpoint.optimiser = {17, some_model(settings, 3)->net.parameters().values(),
                          some_model(settings, 4)->net.parameters().values()};
  checkpoint.epoch_loss = 0.1;
  checkpoint.epoch_seconds = 0.2;
  checkpoint.epoch_processor_seconds = 0.3;
  const StoredModel read = read_training(save(folder / "large.h5", *model, card, checkpoint));
  REQUIRE(read.checkpoint);
  CHECK(read.checkpoint->weights == checkpoint.weights);
  CHECK(read.checkpoint->optimiser.step == 17);
  CHECK(read.checkpoint->optimiser.mean == checkpoint.optimiser.mean);
  CHECK(read.checkpoint->optimiser.square == checkpoint.optimiser.square);
  CHECK(read.checkpoint->epoch_loss == 0.1);
  CHECK(read.checkpoint->epoch_seconds == 0.2);
  CHECK(read.checkpoint->epoch_processor_seconds == 0.3);
  CHECK(read.card.ending == Ending::none);
}

TEST_CASE("an earlier state of the file is replaced, another file never") {
  const TemporaryFolder folder;
  const auto model = some_model({}), other = some_model({}, 2);
  ModelFile file(folder / "model.h5", false);
  file.save(some_card(), *model, std::nullopt);
  file.save(some_card(), *other, std::nullopt);
  CHECK(model_hash(*read_model(folder / "model.h5").model) == model_hash(*other));
  ModelFile(folder / "model.h5", true).save(some_card(), *model, std::nullopt);
  CHECK(model_hash(*read_model(folder / "model.h5").model) == model_hash(*model));
  CHECK_THAT(message_of<FileError>([&] { file.save(some_card(), *other, std::nullopt); }),
             EndsWith("was replaced by another program and is not overwritten"));
  CHECK_THAT(message_of<FileError>([&] { save(folder / "model.h5", *other); }), ContainsSubstring("exists already"));
  CHECK(model_hash(*read_model(folder / "model.h5").model) == model_hash(*model));
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);  // no temporary file remains
}

std::string refusal_of(const fs::path& path) {
  return message_of<FileError>([&] { read_model(path); });
}

/// Replaces a dataset by one of another shape with the same value everywhere.
void replace(hid_t file, const char* path, const std::vector<hsize_t>& shape, float value) {
  hsize_t count = 1;
  for (const hsize_t size : shape) count *= size;
  H5Ldelete(file, path, H5P_DEFAULT);
  hdf5::create_dataset(file, path, H5T_NATIVE_FLOAT, shape);
  hdf5::write_all(file, path, std::vector<float>(count, value));
}

TEST_CASE("files that are no models are refused") {
  const TemporaryFolder folder;
  make_file(folder / "results.h5", plan_of(full_job()), 1);
  CHECK_THAT(refusal_of(folder / "results.h5"),
             EndsWith("holds the results of a sweep, not a model: give the file of a job of kind \"train\""));
  hdf5::create_file(folder / "foreign.h5");
  CHECK_THAT(refusal_of(folder / "foreign.h5"), EndsWith("is an HDF5 file, but does not hold rodsweep models"));
  const fs::path model = save(folder / "model.h5", *some_model({}));
  CHECK(is_model_file(model));
  CHECK_FALSE(is_model_file(folder / "results.h5"));
  for (const double part : {0.1, 0.5, 0.9}) {
    fs::copy_file(model, folder / "cut.h5", fs::copy_options::overwrite_existing);
    fs::resize_file(folder / "cut.h5", static_cast<std::uintmax_t>(part * static_cast<double>(fs::file_size(model))));
    CHECK_THAT(refusal_of(folder / "cut.h5"), ContainsSubstring("cut.h5 is damaged or incomplete"));
  }
}

TEST_CASE("weights, settings and cards that cannot be are refused") {
  constexpr const char* bias = "/model/weights/decode_edges.1.bias";
  const std::pair<std::function<void(hid_t)>, const char*> changes[] = {
      {[](hid_t file) {
         replace(file, bias, {6, 2}, 0.5F);
       },
       "decode_edges.1.bias has the shape [6, 2], not [6, 1]"},
      {[](hid_t file) {
         replace(file, bias, {6, 1}, 0.5F);
       },
       "the hash of the model differs"},
      {[](hid_t file) {
         replace(file, bias, {6, 1}, std::numeric_limits<float>::quiet_NaN());
       },
       "decode_edges.1.bias holds a value that is not finite"},
      {[](hid_t file) { H5Ldelete(file, bias, H5P_DEFAULT); }, "decode_edges.1.bias"},
      {[](hid_t file) { replace(file, "/model/scales/edges/deviation", {17}, 0); },
       "/model/scales/edges/deviation is not above 0 everywhere"},
      {[](hid_t file) { hdf5::write_all(file, "/model/settings", {R"({"latent": 100000})"}); },
       "/model/settings.latent: 100000 is not allowed"},
      {[](hid_t file) { set_attribute(file, "/training", "ending", "tired"); },
       "\"tired\" is not an ending of a training"},
      {[](hid_t file) { set_attribute(file, "/training", "best_epoch", 3); }, "the best epoch is 3 of 2"},
      {[](hid_t file) { set_attribute(file, "/", "schema_version", model_schema_version + 1); },
       "has schema version 3, but this rodsweep reads only version 2"},
      {[](hid_t file) { H5Ldelete(file, "/runs/revision", H5P_DEFAULT); },
       "is damaged or incomplete: /runs/revision is missing"},
  };
  CopingNetSettings settings;
  settings.encoding = Encoding::paper_residual;
  settings.processor = Processor::message_passing;
  settings.latent = 8;
  for (const auto& [change, says] : changes) {
    const TemporaryFolder folder;
    const fs::path path = save(folder / "model.h5", *some_model(settings));
    change(hdf5::open_file(path, H5F_ACC_RDWR).id());
    CHECK_THAT(refusal_of(path), StartsWith(path.native()) && ContainsSubstring(says));
  }
}

TEST_CASE("a training of which no epoch has ended has no model to use, but can be looked at") {
  const TemporaryFolder folder;
  ModelCard card = some_card();
  card.epochs.clear();
  card.best_epoch = 0;
  card.ending = Ending::none;
  const fs::path path = save(folder / "begun.h5", *some_model({}), card);
  CHECK_THAT(refusal_of(path), EndsWith("holds no trained model yet: no epoch of its training has ended"));
  CHECK(read_training(path).card.epochs.empty());
}

}  // namespace test_model_file
}  // namespace rodsweep
