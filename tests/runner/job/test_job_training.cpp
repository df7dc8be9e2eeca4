// Jobs of kind "train": keys, their meaning, refusals.

#include "runner/specs/training_job.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_job_training {

using Paths = std::vector<std::filesystem::path>;

TrainingJob training_of(const Job& job) { return training_job(job.values, job.path); }
TrainingJob training_of(const Json& job) { return training_of(job_of(job)); }

TEST_CASE("data are looked for beside the job") {
  const auto paths = [](const char* data) {
    return training_of(parse_job(with("/data", data, train_job()).dump(), "jobs/train.json")).data;
  };
  CHECK(paths(R"("../results/data.h5")") == Paths{"results/data.h5"});
  CHECK(paths(R"("/data.h5")") == Paths{"/data.h5"});
  CHECK(paths(R"(["../a.h5", "b.h5"])") == Paths{"a.h5", "jobs/b.h5"});
}

TEST_CASE("every key of a training arrives where it belongs; for those of its network see the round trip") {
  Json values = train_job();
  values["seed"] = 7;
  values["validation_simulations"] = 3;
  values["training_simulations"] = 9;
  values["network"] = {{"encoding", "paper_residual"}, {"processor", "message_passing"}};
  values["training"] = Json::parse(R"({"loss": "mse", "epochs": 5, "batch": 12, "shards": 3, "rate": 0.01,
      "warm_up": 0.1, "weight_decay": 0.2, "clip": 0.5, "patience_epochs": 4, "ratio_every_epochs": 2,
      "ratio_simulations": 6, "turned_copies": 2, "systems": "first"})");
  const TrainingJob job = training_of(values);
  CHECK(job.validation_simulations == 3);
  CHECK(job.training_simulations == 9);
  CHECK(job.turned_copies == 2);
  CHECK(job.first_iterations_only);
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

TEST_CASE("a simulator of states is a network of message passing that learns moves from squares, with noise") {
  Json values = train_job();
  values["network"] =
      Json::parse(R"({"encoding": "state", "processor": "message_passing", "base": "none", "moves": true})");
  values["training"] = Json::parse(R"({"loss": "mse", "noisy_copies": 3, "noise": 0.2})");
  const TrainingJob job = training_of(values);
  CHECK(job.network.encoding == Encoding::state);
  CHECK(job.copies().count == 3);
  CHECK(job.copies().noise == 0.2);
}

TEST_CASE("the settings of every kind of network are the same after a round trip") {
  for (const char* text : {"{}", R"({"couplings": "all", "base": "none", "latent": 32, "best_length": false})",
                           R"({"encoding": "paper", "processor": "message_passing", "latent": 8})",
                           R"({"processor": "message_passing", "steps": 1, "globals": true})",
                           R"({"encoding": "paper_residual", "processor": "message_passing", "base": "extrapolation",
                               "base_size": 4, "steps": 2, "hidden_layers": 3, "best_length": false, "moves": true})",
                           R"({"encoding": "state", "processor": "message_passing", "base": "none", "moves": true})"}) {
    Json values =
        job_of(with("/training", R"({"loss": "mse"})", with("/network", text, train_job()))).values["network"];
    if (values.value("couplings", "") == "tree") values.erase("couplings");    // the default is not written
    if (values.value("hidden_layers", 0) == 1) values.erase("hidden_layers");  // nor this one
    const Json written = network_json(network_settings(values));
    CHECK(network_json(network_settings(written)) == written);
    CHECK(written.size() == values.size());
    for (const auto& [key, value] : written.items()) CHECK(values[key] == value);
  }
}

}  // namespace test_job_training
