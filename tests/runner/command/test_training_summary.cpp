// The printed summary of a training.
#include <fstream>

#include "runner/command/training_summary.hpp"
#include "tests/catch.hpp"
#include "tests/runner/file_examples.hpp"

namespace rodsweep {
namespace test_training_summary {

using Catch::Matchers::ContainsSubstring;

ModelCard card_of_two_epochs() {
  ModelCard card;
  card.name = "net";
  card.planned_epochs = 120;
  card.epochs = {{0.5, 0.4, 2e-3, 60, {0.05, 0.15, 0.5, 0.75}}, {0.4, 0.45, 1.7e-3, 65, ValidationRatio::unmeasured()}};
  card.best_epoch = 1;
  return card;
}

TEST_CASE("progress names the epoch that has begun, the last losses and the ratio measured last") {
  CHECK(progress_text(card_of_two_epochs(), 80) ==
        "epoch 3 of 120, loss 0.4, validation 0.45 (best 0.4), CG ratio 0.050 0.150 0.500 0.750, rate 1.7e-03, 1 min "
        "20 s left");
  ModelCard begun;
  begun.planned_epochs = 120;
  CHECK(progress_text(begun, 2) == "epoch 1 of 120, 2.0 s left");
}

TEST_CASE("the summary tells how a training ended, and the model's CG ratio beside its base guess's") {
  const TemporaryFolder folder;
  const auto path = folder / "net.h5";
  std::ofstream(path) << std::string(1500, ' ');
  const std::string file = "\n2 min 05 s for 2 epochs; model: " + path.native() + ", 1.5 kB";
  const std::string kept = "; the model is from epoch 1, validation loss 0.4";

  ModelCard card = card_of_two_epochs();
  CHECK(training_summary(card, path) == "net: 2 of 120 epochs" + kept + file);
  card.ending = Ending::diverged;
  card.message = "too bad";
  CHECK(training_summary(card, path) == "net: ended after 2 of 120 epochs: too bad" + kept + file);

  card.ending = Ending::early;
  card.cg_ratio = {0.05, 0.15, 0.5, 0.75};
  card.base_cg_ratio = {0.1, 0.2, 0.6, 1};
  card.ratio_simulations = 50;
  CHECK(training_summary(card, path) == "net: 2 of 120 epochs, the last 1 without a better validation loss" + kept +
                                            "\nCG ratio on 50 validation simulations      1e-01  1e-02  1e-03  1e-04"
                                            "\n  the model                                0.050  0.150  0.500  0.750"
                                            "\n  its base guess alone                     0.100  0.200  0.600  1.000" +
                                            file);
}

TEST_CASE("a loss that fell to the end is told, with what twice the epochs would take") {
  const TemporaryFolder folder;
  const auto path = folder / "net.h5";
  std::ofstream(path) << "model";
  ModelCard card = card_of_two_epochs();
  const auto trained = [&](const std::vector<double>& losses) {
    card.epochs.clear();
    for (const double loss : losses) card.epochs.push_back({loss, loss, 1e-3, 2, ValidationRatio::unmeasured()});
    card.best_epoch = static_cast<int>(losses.size());
    return training_summary(card, path);
  };
  card.ending = Ending::complete;
  CHECK_THAT(trained({8, 4, 2, 1}), ContainsSubstring("fell by 75 % in the second half of the epochs") &&
                                        ContainsSubstring("8 epochs take about 16.0 s (training.epochs"));
  CHECK_THAT(trained({8, 4, 3.9, 3.8}), !ContainsSubstring("second half"));
  CHECK_THAT(trained({8, 1}), !ContainsSubstring("second half"));
  card.ending = Ending::none;
  CHECK_THAT(trained({8, 4, 2, 1}), !ContainsSubstring("second half"));
}

}  // namespace test_training_summary
}  // namespace rodsweep
