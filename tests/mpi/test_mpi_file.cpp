// One results file and several ranks. Runs in an empty folder that all ranks share.
#include <fstream>

#include "runner/file/hdf5.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/opening.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "tests/catch.hpp"
#include "tests/mpi/world.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("ranks that write their tasks in any order leave the file that one rank leaves") {
  const Plan plan = plan_of(full_job());
  ResultsFile file = ResultsFile::create("shared.h5", plan, test_provenance(), MPI_COMM_WORLD);
  for (std::int64_t i = plan.size() - 1; i >= 0; --i) {
    if (i % rank_count() == own_rank()) file.write(plan.task(i), synthetic_record(plan, i));
  }
  file.close();

  if (own_rank() == 0) {
    const FileSummary summary = inspect("shared.h5");
    CHECK(summary.done == plan.size());
    CHECK(summary.runs.at(0).provenance.host == host_name());
    CHECK(verify("shared.h5").checked == plan.size());
    CHECK(verify("shared.h5").damaged.empty());
    make_file("alone.h5", plan, plan.size());
    const bool same = reproducible_bytes("shared.h5", plan) == reproducible_bytes("alone.h5", plan);
    CHECK(same);
    const auto ranks =
        hdf5::read_all<std::int32_t>(hdf5::open_file("shared.h5", H5F_ACC_RDONLY).id(), "/timing/tasks/rank");
    for (std::size_t i = 0; i < ranks.size(); ++i) CHECK(ranks[i] == static_cast<int>(i) % rank_count());
  }
}

TEST_CASE("ranks resume a file together and agree on what is done") {
  const Plan plan = plan_of(full_job());
  if (own_rank() == 0) make_file("parts.h5", plan, 2);
  MPI_Barrier(MPI_COMM_WORLD);
  ResultsFile file = ResultsFile::resume("parts.h5", plan, test_provenance(), MPI_COMM_WORLD).value();
  CHECK(file.done() == std::vector<std::uint8_t>{1, 1, 0, 0, 0, 0});
  CHECK(file.run_index() == 1);
  if (own_rank() == rank_count() - 1) {
    for (std::int64_t i = 2; i < plan.size(); ++i) file.write(plan.task(i), synthetic_record(plan, i));
    file.end_run(utc_now(), 0);
  }
  file.close();
  if (own_rank() == 0) {
    CHECK(inspect("parts.h5").done == plan.size());
    CHECK(inspect("parts.h5").runs.at(1).exit_code == 0);
    CHECK(verify("parts.h5").damaged.empty());
  }
}

TEST_CASE("every rank is refused with the same words") {
  const Plan plan = plan_of(full_job());
  const auto everywhere_the_same = [](const std::string& text) { return broadcast(text, MPI_COMM_WORLD) == text; };
  if (own_rank() == 0) std::ofstream("taken.h5") << "precious";
  MPI_Barrier(MPI_COMM_WORLD);

  std::string text =
      message_of<FileError>([&] { ResultsFile::create("taken.h5", plan, test_provenance(), MPI_COMM_WORLD); });
  CHECK_THAT(text, ContainsSubstring("taken.h5 exists already"));
  CHECK(everywhere_the_same(text));
  text = message_of<FileError>([&] { ResultsFile::resume("taken.h5", plan, test_provenance(), MPI_COMM_WORLD); });
  CHECK_THAT(text, ContainsSubstring("taken.h5 is not an HDF5 file"));
  CHECK(everywhere_the_same(text));
  text = message_of<FileError>([&] {
    ResultsFile::create("new.h5", plan, test_provenance(), MPI_COMM_WORLD,
                        [](const auto&) { return std::uintmax_t{1}; });
  });
  CHECK_THAT(text, ContainsSubstring("only 1 B are free"));
  CHECK(everywhere_the_same(text));
  CHECK_FALSE(std::filesystem::exists("new.h5"));
}

TEST_CASE("a folder that is another one on some host is refused by all ranks, and nothing is left there") {
  namespace fs = std::filesystem;
  const fs::path common = "common", own = fs::path("own-" + std::to_string(own_rank()));
  const bool apart = own_rank() == rank_count() - 1;
  CHECK_NOTHROW(check_common_place(common / "a.h5", MPI_COMM_WORLD));
  const std::string text =
      message_of<FileError>([&] { check_common_place((apart ? own : common) / "a.h5", MPI_COMM_WORLD); });
  CHECK_THAT(text, ContainsSubstring("a.h5: ranks on " + host_name() + " do not find there"));
  MPI_Barrier(MPI_COMM_WORLD);
  CHECK(entries(common) == 0);
}

TEST_CASE("where no file can be created, ranks look for the file to resume") {
  namespace fs = std::filesystem;
  const std::string name(230, 'x');  // with the ending of an unfinished file, it is too long for a file system
  if (own_rank() == 0) std::ofstream(name) << "results";
  MPI_Barrier(MPI_COMM_WORLD);
  CHECK_NOTHROW(check_common_place(name, MPI_COMM_WORLD));
  const fs::path path = own_rank() == 0 ? fs::path(name) : "elsewhere" / fs::path(name);
  CHECK_THAT(message_of<FileError>([&] { check_common_place(path, MPI_COMM_WORLD); }),
             ContainsSubstring("do not find there"));
  MPI_Barrier(MPI_COMM_WORLD);
  CHECK_THAT(message_of<FileError>([&] { check_common_place(std::string(230, 'y'), MPI_COMM_WORLD); }),
             ContainsSubstring("cannot be created"));
}
