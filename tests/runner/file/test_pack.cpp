// Packed copies: the same data in fewer bytes, verified, never partial; files that cannot be continued.
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

/// A job whose groups all have datasets worth compressing.
Json roomy_job() {
  Json job = full_job();
  job["time"]["steps"] = 60;
  return job;
}

/// Values and unit of every dataset in the plan's layout.
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

TEST_CASE("a packed copy is smaller and holds the same values, types and attributes, and so does a copy of it") {
  const FullFile made(6, roomy_job());
  const fs::path packed = made.folder / "b.h5";
  const Packing packing = pack_results(made.path, packed);
  CHECK(packing.tasks == 6);
  CHECK(packing.verified == 6);
  CHECK(packing.bytes_before == fs::file_size(made.path));
  CHECK(packing.bytes_after == fs::file_size(packed));
  CHECK(packing.bytes_after < packing.bytes_before / 2);
  CHECK(contents(made.path, made.plan) == contents(packed, made.plan));
  CHECK(verify(packed).damaged.empty());
  CHECK(inspect(packed).plan_hash == inspect(made.path).plan_hash);
  CHECK(inspect(packed).job_text == made.plan.job().text);
  pack_results(packed, made.folder / "c.h5");
  CHECK(contents(made.path, made.plan) == contents(made.folder / "c.h5", made.plan));
}

TEST_CASE("a damaged file is not packed, and nothing is left behind") {
  const FullFile made(6);
  hdf5::write_row<double>(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), "/steps/joint_gap", 4, 12345);
  CHECK_THAT(message_of<FileError>([&] { pack_results(made.path, made.folder / "b.h5"); }),
             Contains("wrong checksum of task 1; nothing was packed"));
  CHECK(entries(made.folder.path()) == 1);
}

TEST_CASE("packing overwrites nothing and leaves nothing half done") {
  const FullFile made(6);
  std::ofstream(made.folder / "b.h5") << "precious";
  CHECK(message_of<FileError>([&] { pack_results(made.path, made.folder / "b.h5"); }) ==
        (made.folder / "b.h5").native() + " exists already and is never overwritten: name another file with -o FILE");
  CHECK(bytes_of(made.folder / "b.h5") == "precious");
  CHECK_THAT(message_of<FileError>([&] { pack_results(made.path, made.path); }), Contains("exists already"));
  CHECK_THAT(message_of<FileError>([&] { pack_results(made.path, made.path / "c.h5"); }),
             Contains("cannot be created"));
  CHECK(entries(made.folder.path()) == 2);
}

TEST_CASE("packing that is stopped anywhere leaves nothing") {
  struct Stopped {};
  const FullFile made(6);
  int calls = 0;
  const auto stop_at = [&](int last) {
    calls = 0;
    return [&calls, last] {
      if (++calls == last) throw Stopped();
    };
  };
  pack_results(made.path, made.folder / "b.h5", stop_at(-1));
  const int all = calls;
  CHECK(all > 12 + 6);  // verified before and after, and copied
  fs::remove(made.folder / "b.h5");
  for (int last = 1; last <= all; ++last) {
    CHECK_THROWS_AS(pack_results(made.path, made.folder / "b.h5", stop_at(last)), Stopped);
    CHECK(entries(made.folder.path()) == 1);
  }
}

TEST_CASE("a packed copy is not continued, and what to do is said") {
  const FullFile made(2);
  pack_results(made.path, made.folder / "b.h5");
  const std::string before = bytes_of(made.folder / "b.h5");
  CHECK(message_of<FileError>([&] {
          ResultsFile::resume(made.folder / "b.h5", made.plan, test_provenance(), MPI_COMM_SELF);
        }) == (made.folder / "b.h5").native() +
                  " is a packed copy, which cannot be resumed: resume the original, or run into another file with "
                  "-o FILE");
  CHECK(bytes_of(made.folder / "b.h5") == before);
}

TEST_CASE("the file of one task run again is not continued either") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "one.h5", plan.alone(3, 1), 1);
  CHECK(inspect(folder / "one.h5").rerun_of_task == 3);
  CHECK_THAT(
      message_of<FileError>([&] { ResultsFile::resume(folder / "one.h5", plan, test_provenance(), MPI_COMM_SELF); }),
      Contains("holds only one task of a sweep, from `rodsweep rerun`"));
}

}  // namespace test_pack
