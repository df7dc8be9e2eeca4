// Jobs of kind "train": their keys, what they mean, and what is refused.
#include <catch2/catch.hpp>

#include "runner/job/training_job.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_job_training {

using Paths = std::vector<std::filesystem::path>;

TrainingJob training_of(const Json& job) { return training_job(job_of(job)); }

/// Refusal of the training job with that value.
std::string refused(const std::string& pointer, const std::string& value) {
  Json job = train_job();
  job["network"] = Json::object();
  job["training"] = Json::object();
  return refusal(with(pointer, value, job));
}

TEST_CASE("the least that a training says is where its data are") {
  const TrainingJob job = training_of(train_job());
  CHECK(job.data == Paths{"data.h5"});
  CHECK(job.validation_simulations == 100);
  CHECK(job.network.encoding == Encoding::linear_system);
  CHECK(job.network.processor == Processor::factors);
  CHECK(job.network.couplings == Couplings::tree);
  CHECK(job.network.base == BaseGuess::regression);
  CHECK(job.network.base_size == 6);
  CHECK(job.network.latent == 16);
  CHECK(job.network.best_length);
  CHECK(job.training.loss == LossKind::energy);
  CHECK(job.patience_epochs == 0);
  CHECK(refusal(without("/data", train_job())) ==
        "job.json: data: missing: data set to learn from: the file of a job of kind \"dataset\", a text of 1 to 4000 "
        "characters on one line, or a list of at least one such");
}

TEST_CASE("data are looked for beside the job") {
  const Job job = parse_job(with("/data", R"("../results/data.h5")", train_job()).dump(), "jobs/train.json");
  CHECK(training_job(job).data == Paths{"results/data.h5"});
  const Job absolute = parse_job(with("/data", R"("/data.h5")", train_job()).dump(), "jobs/train.json");
  CHECK(training_job(absolute).data == Paths{"/data.h5"});
  const Job several = parse_job(with("/data", R"(["../a.h5", "b.h5"])", train_job()).dump(), "jobs/train.json");
  CHECK(training_job(several).data == Paths{"a.h5", "jobs/b.h5"});
  CHECK_THAT(refused("/data", "[]"), Catch::Contains("data: ") && Catch::Contains("or a list of at least one such"));
  CHECK_THAT(refused("/data", R"(["a.h5", 5])"), Catch::Contains("data[1]: 5 is not allowed"));
}

TEST_CASE("every key of a training arrives where it belongs") {
  Json values = train_job();
  values["seed"] = 7;
  values["validation_simulations"] = 3;
  values["training_simulations"] = 9;
  values["network"] =
      Json::parse(R"({"encoding": "paper_residual", "processor": "message_passing", "base": "extrapolation",
      "base_size": 4, "latent": 16, "steps": 2, "hidden_layers": 3, "globals": true, "best_length": false, "moves": true})");
  values["training"] = Json::parse(R"({"loss": "mse", "epochs": 5, "batch": 12, "shards": 3, "rate": 0.01,
      "warm_up": 0.1, "weight_decay": 0.2, "clip": 0.5, "patience_epochs": 4, "ratio_every_epochs": 2,
      "ratio_simulations": 6, "turned_copies": 2, "systems": "first"})");
  const TrainingJob job = training_of(values);
  CHECK(job.validation_simulations == 3);
  CHECK(job.training_simulations == 9);
  CHECK(job.turned_copies == 2);
  CHECK(job.first_iterations_only);
  CHECK(job.network.hidden_layers == 3);
  CHECK(job.network.encoding == Encoding::paper_residual);
  CHECK(job.network.processor == Processor::message_passing);
  CHECK(job.network.base == BaseGuess::extrapolation);
  CHECK(job.network.base_size == 4);
  CHECK(job.network.latent == 16);
  CHECK(job.network.steps == 2);
  CHECK(job.network.globals);
  CHECK_FALSE(job.network.best_length);
  CHECK(job.network.moves);
  CHECK(job.training.loss == LossKind::mse);
  CHECK(job.training.epochs == 5);
  CHECK(job.training.batch == 12);
  CHECK(job.training.shards == 3);
  CHECK(job.training.rate == 0.01);
  CHECK(job.training.warm_up == 0.1);
  CHECK(job.training.weight_decay == 0.2);
  CHECK(job.training.clip == 0.5);
  CHECK(job.training.seed == 7);
  CHECK(job.patience_epochs == 4);
  CHECK(job.ratio_every_epochs == 2);
  CHECK(job.ratio_simulations == 6);
}

TEST_CASE("nothing of a training is swept") {
  const char* text = ": this key cannot be swept; a job trains one model; write another job for another";
  CHECK(refused("/training/rate", R"({"grid": [0.1, 0.2]})") == std::string("job.json: training.rate") + text);
  CHECK(refused("/network", R"({"grid": [{}, {"latent": 16}]})") == std::string("job.json: network") + text);
  CHECK(refused("/data", R"({"grid": ["a.h5", "b.h5"]})") == std::string("job.json: data") + text);
}

TEST_CASE("keys of simulations are refused with where a training has its own from, and the reverse") {
  CHECK(refusal(with("/scene", bending_scene().dump(), train_job())) ==
        "job.json: scene: this key belongs to kind \"sweep\" or \"dataset\", not to \"train\"; a training learns from "
        "the simulations in \"data\": remove this key");
  CHECK(refusal(with("/guesses", R"(["zero"])", train_job())) ==
        "job.json: guesses: this key belongs to kind \"sweep\", not to \"train\"; only a sweep tries guesses: remove "
        "this key");
  CHECK(refusal(with("/network", "{}")) == "job.json: network: this key belongs to kind \"train\", not to \"sweep\"");
}

TEST_CASE("misspelt and impossible values of a training are refused") {
  CHECK(refused("/training/epoch", "3") == "job.json: training.epoch: unknown key; did you mean \"epochs\"?");
  CHECK(refused("/training/lr", "3") == "job.json: training.lr: unknown key; did you mean \"rate\"?");
  CHECK(refused("/training/rate", "0") ==
        "job.json: training.rate: 0 is not allowed; must be a number above 0 and at most 1");
  CHECK(refused("/training/epochs", "0") ==
        "job.json: training.epochs: 0 is not allowed; must be an integer from 1 to 1000000");
  CHECK(refused("/network/best_length", "1") ==
        "job.json: network.best_length: 1 is not allowed; must be true or false");
  CHECK(refused("/network/encoding", "\"papers\"") ==
        "job.json: network.encoding: \"papers\" is not allowed; must be one of \"paper\", \"paper_residual\", "
        "\"linear_system\", \"state\"; did you mean \"paper\"?");
}

TEST_CASE("keys that the network or the loss has no use for are refused, also where its kind is the default") {
  CHECK(refused("/network/moves", "true") ==
        "job.json: network.moves: this key belongs to network.processor \"message_passing\", not to \"factors\"; "
        "factors work on joints alone");
  CHECK(refused("/network", R"({"processor": "factors", "steps": 3})") ==
        "job.json: network.steps: this key belongs to network.processor \"message_passing\", not to \"factors\"");
  CHECK(refused("/training/cg_steps", "3") ==
        "job.json: training.cg_steps: this key belongs to training.loss \"in_the_loop\", not to \"energy\"");
}

TEST_CASE("values that do not go together are refused") {
  CHECK(refused("/training/shards", "5") ==
        "job.json: training.shards: 5 is not allowed; must be a divisor of training.batch, 16");
  CHECK_THAT(
      refused("/network/encoding", "\"paper\""),
      Catch::StartsWith("job.json: network.encoding: \"paper\" is not allowed with network.processor \"factors\""));
  CHECK_THAT(refused("/network/latent", "24"), Catch::StartsWith("job.json: network.latent: 24 is not allowed"));
  CHECK(refused("/network", R"({"processor": "message_passing", "moves": true})") ==
        "job.json: network.moves: true is not allowed with training.loss \"energy\", which does not train moves; "
        "use \"mse\" or remove this key");
}

TEST_CASE("a simulator of states is a network of message passing that learns moves from squares, with noise") {
  Json values = train_job();
  values["network"] =
      Json::parse(R"({"encoding": "state", "processor": "message_passing", "base": "none", "moves": true})");
  values["training"] = Json::parse(R"({"loss": "mse", "noisy_copies": 3, "noise": 0.2})");
  const TrainingJob job = training_of(values);
  CHECK(job.network.encoding == Encoding::state);
  CHECK(job.copies().count == 3);
  CHECK(job.copies().noise == 0.2);
  const auto refused_with = [&](const char* path, const char* value) { return refusal(with(path, value, values)); };
  CHECK(refused_with("/network/base", "\"subspace\"") ==
        "job.json: network.base: \"subspace\" is not allowed with network.encoding \"state\"; must be \"none\"");
  CHECK_THAT(refused_with("/network/moves", "false"), Catch::StartsWith("job.json: network.moves: false"));
  CHECK_THAT(refused_with("/training/loss", "\"energy\""), Catch::StartsWith("job.json: training.loss: \"energy\""));
  CHECK_THAT(refused_with("/training/turned_copies", "1"), Catch::StartsWith("job.json: training.turned_copies: 1"));
  CHECK_THAT(refused_with("/network", R"({"encoding": "state", "base": "none"})"),
             Catch::StartsWith("job.json: network.processor: \"factors\""));
  CHECK(refused("/training/noisy_copies", "2") ==
        "job.json: training.noisy_copies: 2 is not allowed with network.encoding \"linear_system\"; must be with "
        "\"state\"");
}

TEST_CASE("the settings of every kind of network are the same after a round trip") {
  for (const char* text : {"{}", R"({"couplings": "all", "base": "none", "latent": 32, "best_length": false})",
                           R"({"encoding": "paper", "processor": "message_passing", "latent": 8})",
                           R"({"processor": "message_passing", "steps": 1, "globals": true})",
                           R"({"processor": "message_passing", "hidden_layers": 2})",
                           R"({"encoding": "state", "processor": "message_passing", "base": "none", "moves": true})"}) {
    Json values =
        job_of(with("/training", R"({"loss": "mse"})", with("/network", text, train_job()))).values["network"];
    if (values.value("couplings", "") == "tree") values.erase("couplings");    // written only where they are all
    if (values.value("hidden_layers", 0) == 1) values.erase("hidden_layers");  // likewise
    const Json written = network_json(network_settings(values));
    CHECK(network_json(network_settings(written)) == written);
    CHECK(written.size() == values.size());
    for (const auto& [key, value] : written.items()) CHECK(values[key] == value);
  }
}

}  // namespace test_job_training
