// Data sets: the systems of a record and of a file, of which A and b are assembled again; refused files.
#include <cmath>
#include <fstream>

#include "runner/dataset/dataset_reader.hpp"
#include "runner/dataset/stored_systems.hpp"
#include "solver/step/time_step.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_dataset {

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
namespace fs = std::filesystem;

/// Two rods that the wind blows and a floor catches.
Json uneven_job(const fs::path& curves) {
  Json job = data_job();
  job["scene"] = two_rods(curves);
  job["scene"].update(Json::parse(R"({"damping_per_s": 2, "wind": {"mean_m_s": [9, 0, 0], "turbulence_m_s": 2},
      "contact": {}, "obstacles": [{"half_space": {"point_m": [0, -0.0201, 0]}}]})"));
  return job;
}

/// The direct solve; keeps every system and its solution.
class SolveProbe : public LinearSolve {
 public:
  struct Solved {
    SolvePosition at;
    bool balanced;
    BlockMatrix a;
    VectorX b, solution;
    std::vector<Vector3> velocity, angular_velocity;
  };

  explicit SolveProbe(const Scene& scene) : scene_(scene), direct_(scene) {}

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override {
    const SolveOutcome outcome = direct_.solve(system, at, assemble_s, delta_lambda);
    const Rod& rod = scene_.rods[static_cast<std::size_t>(at.rod)];
    solved_.push_back(
        {at, system.keeps_balance(), system.matrix(), system.rhs(), delta_lambda, rod.velocity, rod.angular_velocity});
    return outcome;
  }

  /// Of every step, the solves of the first `count` Newton iterations.
  std::vector<Solved> first_iterations(int count) const {
    std::vector<Solved> chosen;
    for (const Solved& s : solved_)
      if (s.at.newton < count) chosen.push_back(s);
    return chosen;
  }

 private:
  const Scene& scene_;
  DirectSolve direct_;
  std::vector<Solved> solved_;
};

bool same_bits(const BlockMatrix& a, const BlockMatrix& b) {
  if (a.block_count() != b.block_count()) return false;
  for (int block = 0; block < a.block_count(); ++block)
    for (int column = 0; column < 6; ++column)
      for (int row = 0; row < 6; ++row) {
        const auto i = static_cast<std::size_t>(block);
        if (a.blocks[i].column[column][row] != b.blocks[i].column[column][row]) return false;
      }
  return true;
}

/// Assembles each stored system again in a rod of `scene` and compares it with the solved one, bit for bit.
void check_same(const std::vector<StoredSystem>& systems, Scene scene, const std::vector<SolveProbe::Solved>& solved) {
  REQUIRE(systems.size() == solved.size());
  for (std::size_t i = 0; i < systems.size(); ++i) {
    const StoredSystem& system = systems[i];
    CAPTURE(i, system.at.step, system.at.newton, system.at.rod);
    CHECK(system.at.step == solved[i].at.step);
    CHECK(system.at.newton == solved[i].at.newton);
    CHECK(system.at.rod == solved[i].at.rod);
    Rod& rod = scene.rods[static_cast<std::size_t>(system.at.rod)];
    LinearSystem again(rod);
    assemble_again(system, rod, again);
    CHECK(again.keeps_balance() == solved[i].balanced);
    CHECK(same_bits(again.matrix(), solved[i].a));
    CHECK(again.rhs() == solved[i].b);
    CHECK(system.solution == solved[i].solution);
    CHECK(rod.velocity == solved[i].velocity);
    CHECK(rod.angular_velocity == solved[i].angular_velocity);
    VectorX product = VectorX::Zero(again.rhs().size());
    again.matrix().multiply(system.solution.data(), product.data());
    CHECK((product - again.rhs()).norm() <= 1e-10 * again.rhs().norm());
  }
}

std::string refusal_of(const fs::path& path) {
  return message_of<FileError>([&] { DatasetReader reader(path); });
}

TEST_CASE("every system of a file gives the A and b of the simulation again, bit for bit") {
  const TemporaryFolder folder;
  Json loaded = ragged_job();
  loaded["scene"]["tip_force_n"] = {0, 0.1, 0};  // evaluated alone, by the steps of the loop below
  const Json uneven = uneven_job(folder / "rods.csv");
  int number = 0;
  double contact = 0;  // of the balanced steps
  for (const auto& [systems, scenes] :
       {std::pair("first", loaded), std::pair("all", with("/time/balance", "false", loaded)),
        std::pair("all", with("/time/balance", "false", uneven)), std::pair("first", uneven),
        std::pair("all", with("/time/integrator", "\"euler\"", loaded))}) {
    Json job = scenes;
    job["record"] = {{"systems", systems}, {"solves", "summary"}};
    const bool balance = job["time"].value("balance", true);
    const fs::path path = folder / (std::to_string(number++) + ".h5");
    const Plan plan = make_data_set(path, job);
    const DatasetReader data(path);
    REQUIRE(data.size() == plan.size());
    CHECK(data.note().empty());
    for (std::int64_t i = 0; i < data.size(); ++i) {
      const StoredSimulation simulation = data.read(i);
      CHECK(data.task(i).sample == i);
      CHECK(simulation.step_s == 0.02);
      CHECK(simulation.newton_iterations == 3);
      Scene scene = build_scene(plan.spec(i).scene);
      SolveProbe probe(scene);
      LinearProjection projection(scene, probe, balance ? std::optional(1e-4) : std::nullopt);
      TimeStepper stepper(scene, step_settings(plan.spec(i).time));
      for (int step = 0; step < 4; ++step) stepper.step(projection);
      check_same(simulation.systems, simulation.scene, probe.first_iterations(systems == std::string("first") ? 1 : 3));
      for (const StoredSystem& system : simulation.systems) {
        CHECK(system.balance.has_value() == balance);
        if (balance)
          for (const Vector6& impulse : system.balance->contact_impulse) contact += impulse.norm();
      }
    }
  }
  CHECK(contact > 0);
}

TEST_CASE("simulations are of different sizes, and a range of them is read") {
  const TemporaryFolder folder;
  const Plan plan = make_data_set(folder / "a.h5", ragged_job());
  const DatasetReader data(folder / "a.h5");
  const std::vector<StoredSimulation> last = data.read(1, 2);
  REQUIRE(last.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Task task = plan.task(static_cast<std::int64_t>(i) + 1);
    CHECK(last[i].scene.rods.front().segment_count() == task.segments);
    CHECK(last[i].systems.size() == 4);
  }
  CHECK(plan.task(1).segments != plan.task(2).segments);
  CHECK(data.plan().task(1).segments == plan.task(1).segments);
}

TEST_CASE("the first and the last simulations have something of every grid point") {
  const TemporaryFolder folder;
  Json job = ragged_job();
  job["scene"]["length_m"] = {{"grid", {1, 2}}};
  make_data_set(folder / "a.h5", job);
  const DatasetReader data(folder / "a.h5");
  REQUIRE(data.size() == 6);
  std::vector<std::int64_t> tasks;
  for (std::int64_t i = 0; i < 6; ++i) tasks.push_back(data.task(i).index);
  CHECK(tasks == std::vector<std::int64_t>{0, 3, 1, 4, 2, 5});
}

TEST_CASE("failed simulations are left out with a note") {
  const TemporaryFolder folder;
  make_data_set(folder / "a.h5", ragged_job(), 2);
  const DatasetReader data(folder / "a.h5");
  CHECK(data.size() == 2);
  CHECK(data.note() == "1 of 3 simulations of " + (folder / "a.h5").native() +
                           " failed and are left out (the first: task 2, diverged: step 2: too bad)");
  make_data_set(folder / "none.h5", ragged_job(), 0);
  CHECK_THAT(refusal_of(folder / "none.h5"), ContainsSubstring("holds no usable simulation: all 3 failed"));
}

TEST_CASE("the hash is that of the data: the same for the same job and in a compressed copy, another for another") {
  const TemporaryFolder folder;
  make_data_set(folder / "a.h5", ragged_job());
  make_data_set(folder / "again.h5", ragged_job());
  Json other = ragged_job();
  other["seed"] = 5;
  make_data_set(folder / "other.h5", other);
  compress(folder / "a.h5", folder / "compressed.h5");
  const std::string hash = DatasetReader(folder / "a.h5").hash();
  CHECK(hash.size() == 16);
  CHECK(DatasetReader(folder / "again.h5").hash() == hash);
  CHECK(DatasetReader(folder / "compressed.h5").hash() == hash);
  CHECK(DatasetReader(folder / "compressed.h5").read(1).systems.size() ==
        4);  // verified by the checksums of the original
  CHECK(DatasetReader(folder / "other.h5").hash() != hash);
}

TEST_CASE("what is no finished data set is refused with what to do") {
  const TemporaryFolder folder;
  Json sweep = small_job();
  sweep["time"]["steps"] = 1;
  make_data_set(folder / "sweep.h5", sweep);
  CHECK_THAT(refusal_of(folder / "sweep.h5"),
             EndsWith("holds the results of a sweep, not a data set: give the file of a job of kind \"dataset\""));

  ResultsFile::create(folder / "task.h5", plan_of(ragged_job()).single_task(1, 1), test_provenance(), MPI_COMM_SELF)
      .close();
  CHECK_THAT(refusal_of(folder / "task.h5"),
             EndsWith("holds only one task of a data set, from `rodsweep rerun`: give the file of the data set"));

  make_data_set(folder / "part.h5", ragged_job(), 1, true);
  CHECK_THAT(refusal_of(folder / "part.h5"),
             ContainsSubstring("is not complete: 2 of 3 simulations are missing; finish it with: rodsweep run ") &&
                 EndsWith("-o " + (folder / "part.h5").native() + " --resume"));
}

TEST_CASE("a damaged simulation is refused, the others are read") {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.h5";
  damage(path, make_data_set(path, ragged_job()));
  const DatasetReader data(path);
  CHECK(data.read(0).systems.size() == 4);
  CHECK_THAT(message_of<FileError>([&] { data.read(1); }), ContainsSubstring("is damaged: wrong checksum of task 1"));
}

TaskRecord evaluated(const Plan& plan) {
  TaskRecord record = record_of(plan);
  REQUIRE(record.outcome == TaskOutcome::ok);
  return record;
}

TEST_CASE("a data set's record has the first system of every step, or all") {
  Json job = data_job();
  job["time"]["newton_tolerance"] = 0;  // so that all iterations are needed
  const TaskRecord first = evaluated(plan_of(job));
  CHECK(first.systems.step == std::vector<std::int32_t>{0, 1, 2, 3});
  CHECK(first.systems.newton == std::vector<std::int16_t>{0, 0, 0, 0});
  CHECK(first.systems.rod == std::vector<std::int16_t>{0, 0, 0, 0});
  CHECK(first.systems.velocity_m_s.front() == 0);  // at the start of the first step
  job["record"] = {{"systems", "all"}};
  const TaskRecord all = evaluated(plan_of(job));
  REQUIRE(all.systems.step.size() == 4 * 3);
  CHECK(all.systems.step[5] == 1);
  CHECK(all.systems.newton[5] == 2);
  const std::size_t segments = 10;
  for (std::size_t step = 0; step < 4; ++step)
    for (std::size_t i = 0; i < 3 * segments; ++i)
      CHECK(first.systems.position_m[3 * segments * step + i] == all.systems.position_m[9 * segments * step + i]);
}

TEST_CASE("Newton iterations that were not needed stay marked and are not read") {
  Json job = data_job();
  job["scene"]["gravity_m_s2"] = {0, 0, 0};  // the first residual is zero
  job["record"] = {{"systems", "all"}};
  const Plan plan = plan_of(job);
  const TaskRecord record = evaluated(plan);
  CHECK(record.systems.step == std::vector<std::int32_t>(4 * 3, -1));
  CHECK(std::isnan(record.systems.position_m.back()));
  CHECK(std::isnan(record.systems.solution.front()));
  CHECK(stored_systems(record, build_scene(plan.spec(0).scene), 3).empty());
}

}  // namespace test_dataset
}  // namespace rodsweep
