// Packed copies: the same data in fewer bytes, verified, never half a file; and what must not be continued.
#include <catch2/catch.hpp>
#include <fstream>

#include "runner/file/inspect.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/pack.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::Contains;

namespace test_pack {

namespace fs = std::filesystem;

/// Long enough that every group has datasets worth compressing.
Json roomy_job() {
  Json job = full_job();
  job["time"]["steps"] = 60;
  return job;
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// The values of every dataset of the plan's layout, and its unit.
std::map<std::string, std::string> contents(const fs::path& path, const Plan& plan) {
  std::map<std::string, std::string> all;
  const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDONLY);
  for (const Field& field : layout(plan, plan.parameters())) {
    const hdf5::Dataset dataset = hdf5::open_dataset(file.id(), field.path);
    std::string& bytes = all[field.path];
    bytes.resize(static_cast<std::size_t>(data_bytes(field)));
    H5Dread(dataset.id(), type_of(field).id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
    bytes += hdf5::read_text_attribute(file.id(), field.path, "unit");
  }
  return all;
}

TEST_CASE("a packed copy is smaller and holds the same values, types and attributes") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(roomy_job());
  make_file(folder / "a.h5", plan, plan.size());
  const Packing packing = pack_results(folder / "a.h5", folder / "b.h5");
  CHECK(packing.tasks == plan.size());
  CHECK(packing.verified == plan.size());
  CHECK(packing.bytes_before == fs::file_size(folder / "a.h5"));
  CHECK(packing.bytes_after == fs::file_size(folder / "b.h5"));
  CHECK(packing.bytes_after < packing.bytes_before / 2);
  CHECK(contents(folder / "a.h5", plan) == contents(folder / "b.h5", plan));
  CHECK(verify(folder / "b.h5").damaged.empty());
  CHECK(inspect(folder / "b.h5").plan_hash == inspect(folder / "a.h5").plan_hash);
  CHECK(inspect(folder / "b.h5").job_text == plan.job().text);
}

TEST_CASE("a packed copy of a packed copy is still the same") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(roomy_job());
  make_file(folder / "a.h5", plan, plan.size());
  pack_results(folder / "a.h5", folder / "b.h5");
  pack_results(folder / "b.h5", folder / "c.h5");
  CHECK(contents(folder / "a.h5", plan) == contents(folder / "c.h5", plan));
}

TEST_CASE("an unfinished sweep is packed with what it has") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "a.h5", plan, 2);
  const Packing packing = pack_results(folder / "a.h5", folder / "b.h5");
  CHECK(packing.verified == 2);
  CHECK(packing.tasks == 6);
  CHECK(inspect(folder / "b.h5").pending == 4);
}

TEST_CASE("a damaged file is not packed, and nothing is left behind") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "a.h5", plan, plan.size());
  {
    const hdf5::File file = hdf5::open_file(folder / "a.h5", H5F_ACC_RDWR);
    hdf5::write_row<double>(file.id(), "/steps/joint_gap", 4, 12345);
  }
  CHECK_THAT(message_of<FileError>([&] { pack_results(folder / "a.h5", folder / "b.h5"); }),
             Contains("the data of task 1 are not what was written; nothing was packed"));
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("packing overwrites nothing and leaves nothing half done") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "a.h5", plan, plan.size());
  std::ofstream(folder / "b.h5") << "precious";
  CHECK(message_of<FileError>([&] { pack_results(folder / "a.h5", folder / "b.h5"); }) ==
        (folder / "b.h5").native() + " exists already and is never overwritten: name another file with -o FILE");
  CHECK(bytes_of(folder / "b.h5") == "precious");
  CHECK_THAT(message_of<FileError>([&] { pack_results(folder / "a.h5", folder / "a.h5"); }),
             Contains("exists already"));
  CHECK_THAT(message_of<FileError>([&] { pack_results(folder / "a.h5", folder / "a.h5" / "c.h5"); }),
             Contains("cannot be created"));
  CHECK(entries(folder.path()) == 2);
}

TEST_CASE("a packed copy is not continued, and what to do is said") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "a.h5", plan, 2);
  pack_results(folder / "a.h5", folder / "b.h5");
  const std::string before = bytes_of(folder / "b.h5");
  CHECK(message_of<FileError>([&] { ResultsFile::resume(folder / "b.h5", plan, test_provenance(), MPI_COMM_SELF); }) ==
        (folder / "b.h5").native() +
            " is a packed copy, which cannot be written: resume the file that it was made from, or run into "
            "another file with -o FILE");
  CHECK(bytes_of(folder / "b.h5") == before);
}

TEST_CASE("the file of one task run again is not continued either") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "one.h5", plan.alone(3, 1), 1);
  CHECK(inspect(folder / "one.h5").rerun_of_task == 3);
  CHECK_THAT(
      message_of<FileError>([&] { ResultsFile::resume(folder / "one.h5", plan, test_provenance(), MPI_COMM_SELF); }),
      Contains("holds one task of a sweep, made by `rodsweep rerun`"));
}

}  // namespace test_pack
