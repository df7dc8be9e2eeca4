// Data sets in files: reading back, refused files.
#include <catch2/catch.hpp>
#include <fstream>

#include "runner/dataset/dataset_reader.hpp"
#include "tests/runner/data_set_examples.hpp"
#include "tests/runner/stored_examples.hpp"

namespace rodsweep {
namespace test_dataset {

using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
namespace fs = std::filesystem;

/// Three rods of different sizes.
Json ragged_job() {
  Json job = data_job();
  job["samples"] = 3;
  job["seed"] = 4;
  job["scene"]["segments"] = {{"integer", {4, 12}}};
  job["scene"]["damping_per_s"] = 0.5;
  return job;
}

/// Two trees in the wind.
Json forest_job() {
  Json job = data_job();
  job["scene"] = with("/wind", R"({"mean_m_s": [9, 0, 0], "turbulence_m_s": 2})", with("/depth", "2", forest_scene()));
  return job;
}

std::string refusal_of(const fs::path& path) {
  return message_of<FileError>([&] { DatasetReader reader(path); });
}

TEST_CASE("every system of a file gives the A and b of the simulation again, bit for bit") {
  const TemporaryFolder folder;
  Json loaded = ragged_job();
  loaded["scene"]["tip_force_n"] = {0, 0.1, 0};  // evaluated alone, by the steps of the loop below
  Json balanced = loaded;
  balanced["time"]["balance"] = true;
  Json second_order = loaded;
  second_order["time"]["integrator"] = "bdf2";
  int number = 0;
  for (const auto& [systems, scenes] :
       {std::pair("first", loaded), std::pair("all", loaded), std::pair("all", forest_job()),
        std::pair("first", balanced), std::pair("all", second_order)}) {
    Json job = scenes;
    job["record"] = {{"systems", systems}, {"solves", "summary"}};
    const bool balance = job["time"].value("balance", false);
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
    }
  }
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
  CHECK_THAT(refusal_of(folder / "none.h5"), Contains("holds no usable simulation: all 3 failed"));
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
  CHECK_THAT(refusal_of(folder / "none.h5"), EndsWith("none.h5: file not found"));
  std::ofstream(folder / "notes.txt") << "hello";
  CHECK_THAT(refusal_of(folder / "notes.txt"), EndsWith("is not an HDF5 file"));

  Json sweep = small_job();
  sweep["time"]["steps"] = 1;
  make_data_set(folder / "sweep.h5", sweep);
  CHECK_THAT(refusal_of(folder / "sweep.h5"),
             EndsWith("holds the results of a sweep, not a data set: give the file of a job of kind \"dataset\""));

  ResultsFile::create(folder / "task.h5", plan_of(ragged_job()).alone(1, 1), test_provenance(), MPI_COMM_SELF).close();
  CHECK_THAT(refusal_of(folder / "task.h5"),
             EndsWith("holds only one task of a data set, from `rodsweep rerun`: give the file of the data set"));

  make_data_set(folder / "part.h5", ragged_job(), 1, true);
  CHECK_THAT(refusal_of(folder / "part.h5"),
             Contains("is not complete: 2 of 3 simulations are missing; finish it with: rodsweep run ") &&
                 EndsWith("-o " + (folder / "part.h5").native() + " --resume"));
}

TEST_CASE("a damaged simulation is refused, the others are read") {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.h5";
  const Plan plan = make_data_set(path, ragged_job());
  {
    const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDWR);
    const auto row = static_cast<hsize_t>(plan.task(1).rows[Rows::system_joint].first);
    const std::vector<double> wrong(6, 0.5);
    hdf5::RowDataset(file.id(), "/systems/joints/solution").write(hdf5::type_of<double>(), row, 1, wrong.data());
  }
  const DatasetReader data(path);
  CHECK(data.read(0).systems.size() == 4);
  CHECK_THAT(message_of<FileError>([&] { data.read(1); }), Contains("is damaged: wrong checksum of task 1"));
}

}  // namespace test_dataset
}  // namespace rodsweep
