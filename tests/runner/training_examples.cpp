#include "tests/runner/training_examples.hpp"

namespace rodsweep {

Json toy_data_job() {
  Json job = data_job();
  job["samples"] = 8;
  job["scene"]["segments"] = {{"integer", {4, 7}}};
  job["scene"]["initial_angle_deg"] = uniform(0, 45);
  job["scene"]["youngs_modulus_pa"] = {{"log_uniform", {1e4, 1e6}}};
  job["time"]["steps"] = 6;
  return job;
}

Json toy_tree_data_job() {
  Json job = toy_data_job();
  job["scene"] =
      Json::parse(R"({"type": "tree", "depth": {"integer": [1, 2]}, "branches": 2, "segments": 2, "length_m": 1,
      "tree_seed": {"integer": [0, 1000]}, "radius_m": 0.05, "density_kg_m3": 800, "youngs_modulus_pa": 1e7,
      "torsion_modulus_pa": 1e7, "wind": {"mean_m_s": [9, 0, 0], "turbulence_m_s": 2}})");
  return job;
}

Json toy_train_job() {
  Json job = train_job();
  job["validation_simulations"] = 4;
  job["network"] = {{"base", "none"}, {"latent", 16}};
  job["training"] = {{"epochs", 4}, {"batch", 8}, {"shards", 4}, {"ratio_every_epochs", 2}, {"ratio_simulations", 3}};
  return job;
}

Toy::Toy(const Json& values, const Json& rods) {
  make_data_set(folder / "data.h5", rods);
  job = parse_job(values.dump(), folder / "job.json");
  training = training_job(job.values, job.path);
  const LearningSets sets(training, job);
  data = training_data(training, sets, 2);
  simulations = ratio_simulations(training, sets, 0, 1);
}

Training Toy::begin() const { return Training(job, training, data, simulations, 1, MPI_COMM_SELF); }

Training Toy::run() const {
  Training result = begin();
  finish(result);
  return result;
}

void Toy::finish(Training& training) {
  while (!training.ended()) training.step(false);
}

}  // namespace rodsweep
