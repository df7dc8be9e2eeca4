// A job of kind "train": data sets, network and training settings.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <vector>

#include "network/encoding/coping_net_settings.hpp"
#include "network/training/example_builder.hpp"
#include "network/training/trainer.hpp"
#include "runner/keys/key.hpp"

namespace rodsweep {

struct TrainingJob {
  std::vector<std::filesystem::path> data;  ///< paths of the data sets
  std::int64_t training_simulations = 0;    ///< per set; 0: all but those for validation
  std::int64_t validation_simulations = 100;
  CopingNetSettings network;
  TrainingSettings training;
  bool first_iterations_only = false;
  int turned_copies = 0;        ///< per training example
  int noisy_copies = 0;         ///< encoding "state": per training example
  double noise = 0.1;           ///< of the noisy copies
  int patience_epochs = 0;      ///< 0: no early stopping
  int ratio_every_epochs = 10;  ///< 0: only at the end
  std::int64_t ratio_simulations = 50;

  Copies copies() const { return {turned_copies + noisy_copies, noise, training.seed}; }
};

/// From the values of a validated job. Throws JobError if they conflict.
TrainingJob training_job(const nlohmann::ordered_json& values, const std::filesystem::path& file);

/// Converts the object `network` of a job, with all keys of its processor, and back.
CopingNetSettings network_settings(const nlohmann::ordered_json& values);
nlohmann::ordered_json network_json(const CopingNetSettings& settings);

/// The keys that jobs of kind "train" have beside those of all jobs: `data`, `validation_simulations`, `network`,
/// `training`. None may be swept.
std::vector<Key> training_keys();

/// `network` alone: what a model file holds of it too.
Key network_key();

}  // namespace rodsweep
