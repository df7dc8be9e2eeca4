// Training in one process: its results, its end, and bits that an interruption does not change. For several ranks see
// tests/mpi/test_training.py.
#include <cmath>
#include <limits>

#include "tests/catch.hpp"
#include "tests/runner/training_examples.hpp"

namespace rodsweep {
namespace test_training {

using Catch::Matchers::ContainsSubstring;

bool same(const std::vector<Epoch>& a, const std::vector<Epoch>& b) {
  const auto equal = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const Epoch& x, const Epoch& y) {
    return x.training_loss == y.training_loss && x.validation_loss == y.validation_loss && x.rate == y.rate &&
           std::equal(x.cg_ratio.begin(), x.cg_ratio.end(), y.cg_ratio.begin(), equal);
  });
}

TEST_CASE("simulations are divided between training and validation, scales are those of the training's") {
  Json job = toy_train_job();
  job["network"]["encoding"] = "paper_residual";
  job["network"]["processor"] = "message_passing";
  const Toy toy(job);
  CHECK(toy.data.training_simulations == 4);
  CHECK(toy.data.validation_simulations == 4);
  CHECK(toy.data.training.size() == 24);
  CHECK(toy.data.validation.size() == 24);
  CHECK(toy.simulations.size() == 3);
  Eigen::ArrayXf sum = Eigen::ArrayXf::Zero(toy.data.training.front().nodes.rows());
  Eigen::Index count = 0;
  for (const Example& example : toy.data.training) {
    sum += example.nodes.rowwise().sum().array();
    count += example.nodes.cols();
  }
  CHECK((sum / static_cast<float>(count)).abs().maxCoeff() < 1e-4F);
}

TEST_CASE(
    "networks learn from trees in the wind, whose joints have several children, and their guess saves iterations") {
  for (const char* processor : {"factors", "message_passing"}) {
    INFO(processor);
    Json job = toy_train_job();
    job["network"]["processor"] = processor;
    job["training"]["epochs"] = 30;
    job["training"]["ratio_every_epochs"] = 30;
    const Toy toy(job, toy_tree_data_job());
    const Training training = toy.run();
    const std::vector<Epoch>& epochs = training.card().epochs;
    REQUIRE(epochs.size() == 30);
    CHECK(epochs.back().validation_loss < 0.9 * epochs.front().validation_loss);
    CHECK(epochs.back().cg_ratio[0] < 1);
  }
}

TEST_CASE("a model of several kinds of scene is judged on each, one of a single kind as a whole") {
  Json rods = toy_data_job();
  rods["samples"] = 4;
  rods["scene"] = {{"zip", {toy_data_job()["scene"], toy_tree_data_job()["scene"]}}};
  Json job = toy_train_job();
  job["network"]["base"] = "subspace";
  job["training"]["ratio_simulations"] = 4;
  const Toy toy(job, rods);
  Training training = toy.run();
  training.end();
  const ModelCard& card = training.card();
  REQUIRE(card.scenes.size() == 2);
  CHECK(card.scenes[0].scene == "bending_rod");
  CHECK(card.scenes[1].scene == "tree");
  for (std::size_t t = 0; t < card.cg_ratio.size(); ++t) {  // two simulations of each scene
    CHECK(card.cg_ratio[t] == Approx((card.scenes[0].cg_ratio[t] + card.scenes[1].cg_ratio[t]) / 2));
    CHECK(card.base_cg_ratio[t] == Approx((card.scenes[0].base_cg_ratio[t] + card.scenes[1].base_cg_ratio[t]) / 2));
  }
  CHECK(card.scenes[0].base_cg_ratio != card.scenes[1].base_cg_ratio);

  const Toy alone(toy_train_job());
  Training single = alone.run();
  single.end();
  CHECK(single.card().scenes.empty());
}

TEST_CASE("several data sets are learned from one after the other, and judged by in turns") {
  Toy toy;
  Json trees = toy_tree_data_job();
  trees["samples"] = 7;
  make_data_set(toy.folder / "trees.h5", trees);
  const std::string alone = toy.data.hash;
  toy.training.data.push_back(toy.folder / "trees.h5");
  const LearningSets sets(toy.training, toy.job);
  CHECK(sets.training().size() == 4 + 3);
  REQUIRE(sets.validation().size() == 4 + 4);
  const TrainingData both = training_data(toy.training, sets, 2);
  CHECK(both.hash != alone);
  CHECK(both.training_simulations == 7);
  for (std::size_t i = 0; i < 8; ++i) CHECK(both.validation_scenes[i] == (i % 2 == 0 ? "bending_rod" : "tree"));
  const auto judged = ratio_simulations(toy.training, sets, 0, 1);
  REQUIRE(judged.size() == 3);
  CHECK(judged[0].systems[3].solution == toy.simulations[0].systems[3].solution);
  CHECK(judged[2].systems[3].solution == toy.simulations[1].systems[3].solution);
  REQUIRE(both.training.size() > toy.data.training.size());
  for (std::size_t i = 0; i < toy.data.training.size(); i += 5)  // two threads make them, in the same order
    CHECK(both.training[i].system.residual == toy.data.training[i].system.residual);
}

TEST_CASE("ranks take turns with the simulations whose CG ratio is measured") {
  const Toy toy;
  const LearningSets dataset(toy.training, toy.job);
  const auto second = ratio_simulations(toy.training, dataset, 1, 2);
  REQUIRE(second.size() == 1);
  CHECK(second[0].systems[3].solution == toy.simulations[1].systems[3].solution);
  CHECK(ratio_simulations(toy.training, dataset, 3, 4).empty());
}

TEST_CASE("data that are missing or too few are refused with what to do") {
  Toy toy;
  toy.training.validation_simulations = 8;
  CHECK_THAT(
      message_of<JobError>([&] { LearningSets(toy.training, toy.job); }),
      ContainsSubstring("validation_simulations: 8 is not allowed: ") && ContainsSubstring("holds 8 simulations"));
  toy.training.validation_simulations = 7;
  toy.training.training.batch = 8;
  CHECK_THAT(message_of<FileError>([&] { training_data(toy.training, LearningSets(toy.training, toy.job), 1); }),
             ContainsSubstring("gives 6 examples for training and 42 for validation: too few for batches of 8"));
  toy.training.data = {toy.folder / "nowhere.h5"};
  CHECK_THAT(message_of<JobError>([&] { LearningSets(toy.training, toy.job); }),
             ContainsSubstring("data: ") && ContainsSubstring("make the data set first"));
}

TEST_CASE("a network of states, which takes steps of Euler, is not trained with data of bdf2") {
  Toy toy;
  Json data = toy_data_job();
  data["time"]["integrator"] = "bdf2";
  make_data_set(toy.folder / "second.h5", data);
  toy.training.data = {toy.folder / "second.h5"};
  CHECK(LearningSets(toy.training, toy.job).training().size() == 4);
  toy.training.network.encoding = Encoding::state;
  CHECK_THAT(message_of<JobError>([&] { LearningSets(toy.training, toy.job); }),
             ContainsSubstring("network.encoding: \"state\" is not allowed") && ContainsSubstring("second.h5") &&
                 ContainsSubstring("\"euler\""));
}

TEST_CASE("losses fall, the model kept is that of the least validation loss") {
  Json job = toy_train_job();
  job["training"]["epochs"] = 30;
  job["training"]["rate"] = 0.05;  // large, so that the last epoch need not be the best
  const Toy toy(job);
  Training training = toy.run();
  CHECK(training.card().ending == Ending::complete);
  const std::vector<Epoch>& epochs = training.card().epochs;
  REQUIRE(epochs.size() == 30);
  CHECK(epochs.back().training_loss < 0.7 * epochs.front().training_loss);
  const auto best = std::min_element(epochs.begin(), epochs.end(), [](const Epoch& a, const Epoch& b) {
    return a.validation_loss < b.validation_loss;
  });
  CHECK(training.card().best_epoch == best - epochs.begin() + 1);
  Model kept = training.kept();
  Trainer judge(kept.net, toy.data.training, toy.training.training);
  double sum = 0;
  for (const double part : judge.losses(toy.data.validation, [](int) { return true; })) sum += part;
  CHECK(sum / 24 == best->validation_loss);
}

TEST_CASE("CG ratios are measured in the epochs that the job asks for, and of the model kept at the end") {
  const Toy toy;
  Training training = toy.run();
  for (std::size_t i = 0; i < 4; ++i) CHECK(std::isnan(training.card().epochs[i].cg_ratio.front()) == (i % 2 == 0));
  CHECK(std::isnan(training.card().cg_ratio.front()));
  training.end();
  REQUIRE(training.card().best_epoch == 4);
  CHECK(training.card().cg_ratio == training.card().epochs.back().cg_ratio);
  for (const double ratio : training.card().base_cg_ratio) CHECK(ratio == 1);  // the base guess is zero
}

TEST_CASE("a training that was interrupted anywhere ends with the same bits") {
  const Toy toy;
  const Training whole = toy.run();
  for (const int steps : {1, 3, 4, 11}) {
    CAPTURE(steps);
    Training before = toy.begin();
    for (int i = 0; i < steps; ++i) CHECK_FALSE(before.step(false));
    Training after = toy.begin();
    after.restore(before.card(), before.kept(), before.checkpoint());
    CHECK(after.trainer().step() == steps);
    Toy::finish(after);
    CHECK(after.kept().net.parameters().values() == whole.kept().net.parameters().values());
    CHECK(after.checkpoint().weights == whole.checkpoint().weights);
    CHECK(same(after.card().epochs, whole.card().epochs));
    CHECK(after.card().best_epoch == whole.card().best_epoch);
  }
}

TEST_CASE("a rank that wants to stop is heard, and its step counts") {
  const Toy toy;
  Training training = toy.begin();
  CHECK_FALSE(training.step(false));
  CHECK(training.step(true));
  CHECK(training.trainer().step() == 2);
  CHECK(training.card().ending == Ending::none);
}

TEST_CASE("without a better validation loss the training ends when its patience does") {
  Json job = toy_train_job();
  job["training"]["rate"] = 1e-30;  // weights stay constant
  job["training"]["epochs"] = 50;
  job["training"]["patience_epochs"] = 3;
  const Toy toy(job);
  const Training training = toy.run();
  CHECK(training.card().ending == Ending::early);
  CHECK(training.card().epochs.size() == 4);
  CHECK(training.card().best_epoch == 1);
}

TEST_CASE("a loss that is not finite ends the training; the best model so far is kept") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Toy toy;
  toy.data.validation[5].system.residual(0, 0) = nan;
  Training at_once = toy.run();
  CHECK(at_once.card().ending == Ending::diverged);
  CHECK(at_once.card().message == "the validation loss is not finite in epoch 1: try a lower training.rate");
  CHECK(at_once.card().best_epoch == 0);

  Toy later;
  Training training = later.begin();
  for (int i = 0; i < 4; ++i) training.step(false);
  const auto kept = training.kept().net.parameters().values();
  for (Example& example : later.data.training) example.system.residual(0, 0) = nan;
  Toy::finish(training);
  CHECK(training.card().ending == Ending::diverged);
  CHECK(training.card().message == "the training loss is not finite in epoch 2: try a lower training.rate");
  CHECK(training.card().epochs.size() == 1);
  CHECK(training.card().best_epoch == 1);
  CHECK(training.kept().net.parameters().values() == kept);
}

}  // namespace test_training
}  // namespace rodsweep
