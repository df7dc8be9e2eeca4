#include <cmath>
#include <fstream>

#include "runner/file/hdf5.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/runs.hpp"
#include "tests/catch.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;

namespace test_file_resume {

namespace fs = std::filesystem;

ResultsFile resume(const fs::path& path, const Plan& plan) {
  return ResultsFile::resume(path, plan, test_provenance(), MPI_COMM_SELF).value();
}

void flip_bit(const fs::path& path, const std::string& dataset, std::size_t byte) {
  const haddr_t offset =
      H5Dget_offset(hdf5::open_dataset(hdf5::open_file(path, H5F_ACC_RDONLY).id(), dataset).id()) + byte;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  const char changed = static_cast<char>(file.get() ^ 4);
  file.seekp(static_cast<std::streamoff>(offset));
  file.put(changed);
}

TEST_CASE("a resumed file knows what is done and is the same in the end as one written at once") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "whole.h5", plan, plan.size());
  make_file(folder / "parts.h5", plan, 2);
  {
    ResultsFile file = resume(folder / "parts.h5", plan);
    CHECK(file.done() == std::vector<std::uint8_t>{1, 1, 0, 0, 0, 0});
    CHECK(file.run_index() == 1);
    CHECK(file.note() == "");
    file.write(plan.task(5), synthetic_record(plan, 5));
  }  // without close()
  {
    ResultsFile file = resume(folder / "parts.h5", plan);
    CHECK(file.done() == std::vector<std::uint8_t>{1, 1, 0, 0, 0, 1});
    for (const std::int64_t i : {4, 3, 2}) file.write(plan.task(i), synthetic_record(plan, i));
  }
  const bool same = reproducible_bytes(folder / "parts.h5", plan) == reproducible_bytes(folder / "whole.h5", plan);
  CHECK(same);
  const FileSummary summary = inspect(folder / "parts.h5");
  REQUIRE(summary.runs.size() == 3);
  CHECK(summary.runs[0].tasks == 2);
  CHECK(summary.runs[1].tasks == 1);
  CHECK(summary.runs[2].tasks == 3);
}

TEST_CASE("a file counts the workers that began a task and said nothing of it since") {
  const FullFile made(1);
  for (int start = 0; start < 2; ++start) {
    ResultsFile file = resume(made.path, made.plan);
    CHECK(file.tries()[3] == start);
    for (const std::int64_t i : {2, 3, 4, 5}) file.begin(made.plan.task(i));
    file.abandon(made.plan.task(2));
    if (start == 1) file.write(made.plan.task(4), synthetic_record(made.plan, 4));
  }
  CHECK(resume(made.path, made.plan).tries() == std::vector<std::uint8_t>{0, 0, 0, 2, 0, 2});
}

TEST_CASE("a file that a run writes is refused to another, until that ends") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  {
    const ResultsFile first = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
    CHECK_THAT(message_of<FileError>([&] { resume(folder / "a.h5", plan); }),
               ContainsSubstring("a.h5 is being written by another run"));
    CHECK(inspect(folder / "a.h5").runs.size() == 1);
  }
  ResultsFile second = resume(folder / "a.h5", plan);
  CHECK_THROWS_AS(resume(folder / "a.h5", plan), FileError);
  second.close();
  CHECK(resume(folder / "a.h5", plan).run_index() == 2);
}

TEST_CASE("a complete task is never written again") {
  const FullFile made(2);
  const auto before = reproducible_bytes(made.path, made.plan);
  ResultsFile file = resume(made.path, made.plan);
  CHECK_THAT(message_of<std::logic_error>([&] { file.write(made.plan.task(1), synthetic_record(made.plan, 0)); }),
             ContainsSubstring("task 1 is complete") && ContainsSubstring("must not be written again"));
  const bool untouched = reproducible_bytes(made.path, made.plan) == before;
  CHECK(untouched);
}

TEST_CASE("a file of a program that did not store the time left is continued") {
  const FullFile made(2);
  H5Ldelete(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), "/runs/left_s", H5P_DEFAULT);
  ResultsFile file = resume(made.path, made.plan);
  file.beat(10.0);
  file.end_run("2025-01-01T00:00:00Z", 4);
  file.close();
  const FileSummary summary = inspect(made.path);
  CHECK(summary.runs.at(1).end_utc == "2025-01-01T00:00:00Z");
  CHECK(std::isnan(summary.runs.at(1).left_s));
}

TEST_CASE("resuming a complete file changes none of its bytes, so jobs that read it still know it") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "a.h5", plan, plan.size());
  const std::string before = bytes_of(folder / "a.h5");
  ResultsFile file = resume(folder / "a.h5", plan);
  file.beat(10.0);
  file.end_run("2025-01-01T00:00:00Z", 0);
  file.close();
  const bool untouched = bytes_of(folder / "a.h5") == before;
  CHECK(untouched);
}

TEST_CASE("a sweep can be resumed more often than /runs has rows, and says so") {
  const FullFile made(0);
  hdf5::write_all(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), "/runs/begin",
                  std::vector<std::string>(run_rows, "2025-01-01T00:00:00Z"));
  ResultsFile file = resume(made.path, made.plan);
  CHECK(file.run_index() == run_rows - 1);
  CHECK_THAT(file.note(), ContainsSubstring("has 64 rows") && ContainsSubstring("/runs"));
  const FileSummary summary = inspect(made.path);
  CHECK(summary.runs.size() == run_rows);
  CHECK(summary.runs.back().provenance.begin_utc != "2025-01-01T00:00:00Z");
}

TEST_CASE("a task whose data are not what was written is pending again when a sweep goes on") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  make_file(folder / "whole.h5", plan, plan.size());
  make_file(folder / "a.h5", plan, 4);
  flip_bit(folder / "a.h5", "/tasks/iterations_sum", 0);
  {
    ResultsFile file = resume(folder / "a.h5", plan);
    CHECK(file.done() == std::vector<std::uint8_t>{0, 1, 1, 1, 0, 0});
    CHECK(file.note() == (folder / "a.h5").native() + ": task 0 is run again, because of a wrong checksum");
    CHECK(inspect(folder / "a.h5").done == 3);
    for (const std::int64_t i : {0, 4, 5}) file.write(plan.task(i), synthetic_record(plan, i));
  }
  const bool same = reproducible_bytes(folder / "a.h5", plan) == reproducible_bytes(folder / "whole.h5", plan);
  CHECK(same);
}

TEST_CASE("failed tasks are run again on request, if they may end otherwise") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  {
    ResultsFile file = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
    const auto write = [&](std::int64_t task, TaskOutcome outcome) {
      TaskRecord record = synthetic_record(plan, task);
      record.outcome = outcome;
      file.write(plan.task(task), record);
    };
    write(0, TaskOutcome::ok);
    write(1, TaskOutcome::error);
    write(2, TaskOutcome::torn);
    write(3, TaskOutcome::timed_out);
  }
  CHECK(resume(folder / "a.h5", plan).done() == std::vector<std::uint8_t>{1, 1, 1, 1, 0, 0});
  const ResultsFile file =
      ResultsFile::resume(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF, Retry::failed).value();
  CHECK(file.done() == std::vector<std::uint8_t>{1, 0, 1, 0, 0, 0});
  CHECK(file.note() ==
        (folder / "a.h5").native() + ": 2 tasks (first: 1) are run again, after an error, a timeout or a crash");
  CHECK(inspect(folder / "a.h5").done == 2);
}

TEST_CASE("verifying shows that it lives, and stops when told to, with the file as it was") {
  const FullFile made(4);
  fs::last_write_time(made.path, fs::file_time_type::clock::now() - std::chrono::hours(1));
  int asked = 0;
  CHECK_FALSE(ResultsFile::resume(made.path, made.plan, test_provenance(), MPI_COMM_SELF, Retry::none,
                                  [&] { return ++asked == 3 ? Verify::stop : Verify::on; }));
  CHECK(asked == 3);
  CHECK(fs::file_time_type::clock::now() - fs::last_write_time(made.path) < std::chrono::minutes(1));
  CHECK(inspect(made.path).runs.size() == 1);
  CHECK(resume(made.path, made.plan).done() == std::vector<std::uint8_t>{1, 1, 1, 1, 0, 0});
}

TEST_CASE("runs with time to verify a part verify all in the end") {
  const FullFile made(6);
  hdf5::RowDataset(hdf5::open_file(made.path, H5F_ACC_RDWR).id(), "/steps/joint_gap")
      .put<double>(4, 12345);  // of task 1
  int runs = 0;
  for (bool found = false; !found; ++runs) {
    REQUIRE(runs < 12);
    int asked = 0;
    const auto two = [&] { return ++asked > 2 ? Verify::enough : Verify::on; };
    const ResultsFile file =
        ResultsFile::resume(made.path, made.plan, test_provenance(), MPI_COMM_SELF, Retry::none, two).value();
    CHECK(asked == 3);
    CHECK_THAT(file.note(),
               ContainsSubstring("time was left to verify 2 of 6 finished tasks; later runs verify others"));
    found = file.done()[1] == 0;
    CHECK((file.note().find("task 1 is run again") != std::string::npos) == found);
  }
  CHECK(runs > 1);
}

TEST_CASE("status can be read while the sweep writes") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  ResultsFile file = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
  FileSummary summary = inspect(folder / "a.h5");
  CHECK(summary.job_name == "small");
  CHECK(summary.job_text == plan.job().text);
  CHECK(summary.tasks == 6);
  CHECK(summary.pending == 6);
  CHECK(summary.guesses == std::vector<std::string>{"zero", "previous"});
  REQUIRE(summary.runs.size() == 1);
  CHECK(summary.runs[0].exit_code == -1);
  CHECK(summary.runs[0].end_utc == "");
  CHECK(std::isnan(summary.runs[0].left_s));
  file.beat(90.5);
  CHECK(inspect(folder / "a.h5").runs.at(0).left_s == 90.5);

  file.write(plan.task(0), synthetic_record(plan, 0));
  TaskRecord failed = synthetic_record(plan, 4);
  failed.outcome = TaskOutcome::diverged;
  failed.message = "joint gap of 3 lengths at step 2";
  failed.timing.elapsed_s.assign(1, std::numeric_limits<double>::quiet_NaN());
  file.write(plan.task(4), failed);
  file.end_run("2025-01-02T03:04:05Z", 4);
  CHECK(inspect(folder / "a.h5").done == 1);  // the first task is written at once, the second waits for others
  file.commit();
  summary = inspect(folder / "a.h5");
  CHECK(summary.done == 2);
  CHECK(summary.failed == 1);
  CHECK(summary.pending == 4);
  CHECK(summary.done_by_outcome == std::map<std::string, std::int64_t>{{"ok", 1}, {"diverged", 1}});
  REQUIRE(summary.failures.size() == 1);
  CHECK(summary.failures[0].index == 4);
  CHECK(summary.failures[0].outcome == "diverged");
  CHECK(summary.failures[0].message == "joint gap of 3 lengths at step 2");

  const RunRow& run = summary.runs.at(0);
  CHECK(run.end_utc == "2025-01-02T03:04:05Z");
  CHECK(run.exit_code == 4);
  CHECK(run.tasks == 2);
  CHECK(run.task_seconds == synthetic_record(plan, 0).timing.elapsed_s.at(0));
  CHECK(run.provenance.user_command == "rodsweep run job.json");
}

TEST_CASE("a long message is cut, not refused") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  ResultsFile file = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
  TaskRecord record = synthetic_record(plan, 0);
  record.outcome = TaskOutcome::error;
  record.message = std::string(1000, 'x');
  file.write(plan.task(0), record);
  CHECK(inspect(folder / "a.h5").failures.at(0).message == std::string(message_bytes, 'x'));
  CHECK(verify(folder / "a.h5").damaged.empty());
}

TEST_CASE("verification finds one flipped bit in the data of a complete task") {
  const FullFile made(4);
  CHECK(verify(made.path).checked == 4);
  CHECK(verify(made.path).damaged.empty());

  const AxisSizes sizes = axis_sizes(made.plan);
  const auto first_byte = [&](const Task& task, std::int64_t width_bytes) {
    return static_cast<std::size_t>(task.rows[Rows::solve].first * width_bytes);
  };
  SECTION("in a row of a solve") {
    flip_bit(made.path, "/solves/iterations", first_byte(made.plan.task(2), sizes.guesses * sizes.tolerances * 2) + 5);
    CHECK(verify(made.path).damaged == std::vector<std::int64_t>{2});
  }
  SECTION("in the message") {
    flip_bit(made.path, "/tasks/message", 3 * message_bytes);
    CHECK(verify(made.path).damaged == std::vector<std::int64_t>{3});
  }
  SECTION("in the checksum itself") {
    flip_bit(made.path, "/tasks/checksum", 0);
    CHECK(verify(made.path).damaged == std::vector<std::int64_t>{0});
  }
  SECTION("not in a pending task, nor in times") {
    flip_bit(made.path, "/solves/iterations", first_byte(made.plan.task(4), sizes.guesses * sizes.tolerances * 2));
    flip_bit(made.path, "/timing/solves/cg_s", 0);
    CHECK(verify(made.path).damaged.empty());
  }
}

TEST_CASE("two records that differ in one value have different checksums, but for times") {
  const Plan plan = plan_of(full_job());
  TaskRecord record = synthetic_record(plan, 0);
  const std::uint64_t first = task_checksum(0, record);
  record.timing.elapsed_s[0] += 1;
  CHECK(task_checksum(0, record) == first);
  record.steps.length_drift[1] += 1e-16 + record.steps.length_drift[1] * 1e-15;
  CHECK(task_checksum(0, record) != first);
}

TEST_CASE("provenance tells when, where and with what") {
  const Provenance here = provenance_of_this_process("rodsweep run a.json");
  CHECK_THAT(here.begin_utc, Catch::Matchers::Matches("20\\d\\d-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\dZ"));
  CHECK_FALSE(here.host.empty());
  CHECK_FALSE(here.revision.empty());
  for (const char* part : {"rodsweep ", "MPI", "PETSc 3.", "HDF5 ", "Eigen ", "++ ", "AVX"}) {
    CHECK_THAT(here.versions, ContainsSubstring(part));
  }
}

}  // namespace test_file_resume
