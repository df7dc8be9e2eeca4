// Models, as status, --resume and the learned guesses read them.
#include "runner/training/model_file.hpp"
#include "tests/fuzz/file_edits.hpp"
#include "tests/network/models.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;

namespace {

void make_model(const std::filesystem::path& path) {
  CopingNetSettings settings;
  settings.latent = 4;
  const std::shared_ptr<Model> model = test::random_model(settings, 1);
  ModelCard card;
  card.name = "net";
  card.job_text = train_job().dump();
  card.data_path = "data.h5";
  card.data_hash = "0123456789abcdef";
  card.planned_epochs = 2;
  card.epochs = {{0.5, 0.6, 1e-3, 2.5, ValidationRatio::unmeasured()}};
  card.best_epoch = 1;
  card.scenes = {{"helix", {0.1, 0.3, 0.5, 0.7}, {0.2, 0.4, 0.6, 0.8}}};
  card.starts = {{test_provenance(), "", -1}};
  Checkpoint checkpoint;
  checkpoint.weights = model->net.parameters().values();
  checkpoint.optimiser.mean = checkpoint.optimiser.square = checkpoint.weights;
  ModelFile(path, false).save(card, *model, checkpoint);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path folder = fuzz::scratch_folder(), path = folder / "edited.h5";
  static const fuzz::Original original = [] {
    make_model(folder / "original.h5");
    return fuzz::Original(folder / "original.h5");
  }();
  original.edited(path, data, size);
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  fuzz::expect_plain(path, input, [] { is_model_file(path); });
  fuzz::expect_plain(path, input, [] { read_training(path); });
  fuzz::expect_plain(path, input, [] { read_model(path); });
  return 0;
}
