// Whole tasks with baselines from files: nearest neighbours, and a network instead of the solve.
#include <cmath>
#include <fstream>

#include "runner/measure/plan_check.hpp"
#include "runner/measure/shared_inputs.hpp"
#include "runner/training/model_file.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_baselines {

namespace fs = std::filesystem;

/// A network with random weights times `factor`. Scales of a state network are one.
void write_model(const fs::path& path, float factor, bool of_states = false) {
  CopingNetSettings settings;
  settings.base = BaseGuess::none;
  settings.latent = 16;
  settings.best_length = false;
  if (of_states) {
    settings.encoding = Encoding::state;
    settings.processor = Processor::message_passing;
    settings.moves = true;
  }
  Model model{CopingNet<float>(settings, 1), {}};
  const auto ones = [](int size) { return Normalisation{Eigen::ArrayXf::Zero(size), Eigen::ArrayXf::Ones(size)}; };
  if (of_states) model.scales = {ones(node_features(settings)), ones(edge_features(settings)), {}, ones(6)};
  for (float& weight : model.net.parameters().values()) weight *= factor;
  ModelCard card;
  card.name = "planted";
  card.runs.push_back({test_provenance(), "", 0});
  card.planned_epochs = card.best_epoch = 1;
  card.epochs.push_back({1, 1, 1e-3, 0});
  card.ending = Ending::complete;
  ModelFile(path, false).save(card, model, std::nullopt);
}

/// Evaluates all tasks of a job in `folder`; returns their records.
std::vector<TaskRecord> evaluated(const TemporaryFolder& folder, const Json& job) {
  const Plan plan(parse_job(job.dump(), folder / "job.json"));
  std::vector<TaskRecord> records;
  for (const Task& task : plan.tasks()) records.push_back(record_of(plan, task.index));
  return records;
}

Json instead_of_the_solve(const std::string& model) {
  Json job = without("/guesses", with("/solve", R"({"method": "end_to_end", "model": ")" + model + "\"}"));
  job["evaluation"] = "closed_loop";
  return job;
}

TEST_CASE("nearest neighbours know the simulations of their own data set, the first of which are enough") {
  const TemporaryFolder folder;
  const Json data = data_job();
  make_data_set(folder / "data.h5", data);
  Json job = without("/record", data);
  job["kind"] = "sweep";
  job["guesses"] = Json::parse(R"(["zero", {"knn": {"data": "data.h5", "k": 1}},
                                   {"knn": {"data": "data.h5", "simulations": 1}}])");
  const TaskRecord record = evaluated(folder, job).front();
  REQUIRE(record.outcome == TaskOutcome::ok);
  for (const std::size_t t : {0, 1, 2, 3}) {
    CHECK(record.tasks.counted.iterations[t] > 0);
    CHECK(record.tasks.counted.cg_ratio[8 + t] == 0);
    CHECK(record.tasks.counted.cg_ratio[16 + t] < 0.5);
  }
  CHECK(shared_knn_set(folder / "data.h5", 0) == shared_knn_set(folder / "data.h5", 0));
  CHECK(shared_knn_set(folder / "data.h5", 1)->size(0) == data["time"]["steps"]);
}

TEST_CASE("a network that says nothing lets the rod fall apart, which is data: rows without iterations") {
  const TemporaryFolder folder;
  write_model(folder / "silent.h5", 0);
  Json job = instead_of_the_solve("silent.h5");
  job["time"]["steps"] = 5;
  const TaskRecord record = evaluated(folder, job).front();
  CHECK(record.outcome == TaskOutcome::ok);
  CHECK(record.steps.joint_gap.back() > record.steps.joint_gap.front());
  CHECK(record.steps.joint_gap.front() > 0.001);
  CHECK(record.solves.step.front() == 0);
  CHECK(record.solves.newton.front() == 0);
  CHECK(record.solves.newton_residual.front() > 0);
  CHECK(record.solves.rhs_norm.front() > 0);
  CHECK(record.solves.iterations.empty());
  CHECK(std::isnan(record.timing.assemble_s.front()));
  CHECK(record.timing.rest_s.front() > 0);
  job["time"]["steps"] = 20;
  const TaskRecord torn = evaluated(folder, job).front();
  CHECK(torn.outcome == TaskOutcome::torn);
  CHECK(torn.steps.joint_gap[static_cast<std::size_t>(torn.tasks.steps_done[0] - 1)] > 1);
}

TEST_CASE("a simulator of states moves rods without any solve; its steps are data, its rows of solves empty") {
  const TemporaryFolder folder;
  write_model(folder / "still.h5", 0, true);
  Json job = instead_of_the_solve("still.h5");
  job["solve"]["method"] = "state_network";
  job["time"]["steps"] = 5;
  const TaskRecord record = evaluated(folder, job).front();
  CHECK(record.outcome == TaskOutcome::ok);
  CHECK(record.steps.kinetic_energy_j.back() < 1e-20);  // an untrained network has no gravity
  CHECK(record.steps.joint_gap.back() < 1e-12);
  CHECK(std::isnan(record.solves.newton_residual.front()));
  CHECK(record.timing.rest_s.front() > 0);
  job["scene"] = forest_scene();
  CHECK(evaluated(folder, job).front().outcome == TaskOutcome::ok);
}

TEST_CASE("models are refused where they are for something else") {
  const TemporaryFolder folder;
  write_model(folder / "states.h5", 1, true);
  write_model(folder / "systems.h5", 1);
  const auto refusal_of = [&](const Json& job) {
    return message_of<JobError>([&] { check_guesses(Plan(parse_job(job.dump(), folder / "job.json"))); });
  };
  CHECK_THAT(refusal_of(instead_of_the_solve("states.h5")),
             Catch::Matchers::ContainsSubstring("solve.model: states.h5 is not allowed: its encoding is \"state\""));
  CHECK(refusal_of(instead_of_the_solve("systems.h5")).empty());
  Json simulator = instead_of_the_solve("systems.h5");
  simulator["solve"]["method"] = "state_network";
  CHECK_THAT(refusal_of(simulator), Catch::Matchers::ContainsSubstring(
                                        "solve.model: systems.h5 is not allowed: its encoding is not \"state\""));
  CHECK_THAT(refusal_of(with("/guesses", R"(["zero", {"copingnet": {"model": "states.h5"}}])")),
             Catch::Matchers::ContainsSubstring("guesses[1]: states.h5 is not allowed"));
}

TEST_CASE("a network whose answer is no number ends its task, and only that") {
  const TemporaryFolder folder;
  write_model(folder / "broken.h5", 1e30F);
  Json job = instead_of_the_solve("broken.h5");
  job["solve"] = {{"grid", {job["solve"], {{"method", "direct"}}}}};
  const std::vector<TaskRecord> records = evaluated(folder, job);
  CHECK(records[0].outcome == TaskOutcome::not_a_number);
  CHECK_THAT(records[0].message, Catch::Matchers::ContainsSubstring("step 0: the network's answer is"));
  CHECK(records[0].tasks.steps_done.front() == 0);
  CHECK(records[1].outcome == TaskOutcome::ok);
}

}  // namespace test_baselines
}  // namespace rodsweep
