// One data set on several ranks when only one rank can see the file. Runs in an empty folder.

#include "runner/dataset/dataset_reader.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/text/checksum.hpp"
#include "tests/catch.hpp"
#include "tests/mpi/world.hpp"
#include "tests/runner/data_set_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;

namespace test_mpi_dataset {

/// Checksum of all numbers of all systems and of the scene.
std::string fingerprint(const StoredSimulation& simulation) {
  Checksum sum;
  const auto add = [&](const auto& values) { sum.add(values.data(), values.size() * sizeof(*values.data())); };
  for (const StoredSystem& system : simulation.systems) {
    sum.add(&system.constraint_dt_s, sizeof system.constraint_dt_s);
    add(system.position);
    add(system.orientation);
    add(system.velocity);
    add(system.lambda);
    add(system.solution);
  }
  for (const Segment& segment : simulation.scene.rods.at(0).segments)
    sum.add(&segment.length_m, sizeof segment.length_m);
  return std::to_string(sum.value());
}

TEST_CASE("ranks that read a data set together have what a process alone reads, though one of them sees the file") {
  if (own_rank() == 0) make_data_set("data.h5", ragged_job());
  const DatasetReader data(own_rank() == 0 ? "data.h5" : "nowhere.h5", MPI_COMM_WORLD);
  REQUIRE(data.size() == 3);
  CHECK(broadcast(data.hash(), MPI_COMM_WORLD) == data.hash());
  for (std::int64_t i = 0; i < data.size(); ++i) {
    const StoredSimulation simulation = data.read(i);
    CHECK(simulation.systems.size() == 4);
    const std::string alone = own_rank() == 0 ? fingerprint(DatasetReader("data.h5").read(i)) : "";
    CHECK(fingerprint(simulation) == broadcast(alone, MPI_COMM_WORLD));
  }
}

TEST_CASE("what goes wrong with a data set is said by all ranks") {
  CHECK_THAT(message_of<CollectiveError>([] { DatasetReader("none.h5", MPI_COMM_WORLD); }),
             ContainsSubstring("none.h5"));
  if (own_rank() == 0) damage("damaged.h5", make_data_set("damaged.h5", ragged_job()));
  const DatasetReader data("damaged.h5", MPI_COMM_WORLD);
  CHECK(data.read(0).systems.size() == 4);
  CHECK_THAT(message_of<CollectiveError>([&] { data.read(1); }),
             ContainsSubstring("is damaged: wrong checksum of task 1"));
}

}  // namespace test_mpi_dataset
