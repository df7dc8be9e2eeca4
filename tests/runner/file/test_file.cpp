#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>

#include "runner/file/columns.hpp"
#include "runner/file/hdf5.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/record.hpp"
#include "runner/text/checksum.hpp"
#include "solver/linear/interruption.hpp"
#include "tests/catch.hpp"
#include "tests/hand_clock.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::StartsWith;

namespace test_file {

template <class T>
std::vector<T> stored(const std::filesystem::path& path, const std::string& dataset) {
  return hdf5::read_all<T>(hdf5::open_file(path, H5F_ACC_RDONLY).id(), dataset);
}

std::vector<std::string> stored_texts(const std::filesystem::path& path, const std::string& dataset) {
  return hdf5::read_all<std::string>(hdf5::open_file(path, H5F_ACC_RDONLY).id(), dataset);
}

bool holds(const std::filesystem::path& path, const std::string& dataset) {
  return hdf5::exists(hdf5::open_file(path, H5F_ACC_RDONLY).id(), dataset);
}

/// The rows of one task in a dataset; empty if the file does not have the dataset.
template <class T>
std::vector<T> task_rows(const hdf5::File& file, const Column& column, const Task& task, const AxisSizes& sizes) {
  if (!hdf5::exists(file.id(), column.path)) return {};
  const auto all = hdf5::read_all<T>(file.id(), column.path);
  const RowRange rows = task.rows[column.rows];
  const std::int64_t width = row_width(column, sizes);
  return {all.begin() + rows.first * width, all.begin() + (rows.first + rows.count) * width};
}

TEST_CASE("the writing of a long record can be stopped, and then its task is pending") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(with(
      "/samples", "1",
      with("/record", R"({"trajectory_every": 1})",
           with("/time/steps", "2000",
                with("/scene/segments", "1000", without("/guesses", with("/solve", R"({"method": "direct"})")))))));
  const Task task = plan.task(0);
  TaskRecord record;
  record.prepare(task, axis_sizes(plan));
  bool asked = false;
  const auto stop = [&] { return asked = true; };
  test::HandClock::set_tick(std::chrono::seconds(1));
  {
    ResultsFile file = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
    {
      const Interruptible interruptible(stop, test::HandClock::ticking);
      CHECK_THROWS_AS(file.write(task, record), InterruptedComputation);
    }
    {
      const Interruptible interruptible(stop, test::HandClock::ticking);
      CHECK_THROWS_AS(TaskRecord().prepare(task, axis_sizes(plan)), InterruptedComputation);
    }
    CHECK(asked);
  }
  CHECK(inspect(folder / "a.h5").pending == 1);
}

TEST_CASE("a record comes back from the file value by value, whatever the order of writing") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(GENERATE(full_job(), full_data_job(), with("/scene/contact", "{}", full_job())));
  ResultsFile file = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
  for (const std::int64_t i : {3, 0, 5, 1}) file.write(plan.task(i), synthetic_record(plan, i));
  file.close();

  const hdf5::File read = hdf5::open_file(folder / "a.h5", H5F_ACC_RDONLY);
  for (const std::int64_t i : {0, 1, 3, 5}) {
    TaskRecord record = synthetic_record(plan, i);
    for (const Column& column : columns()) {
      INFO(column.path << " of task " << i);
      REQUIRE(bytes_of(column, record).empty() != hdf5::exists(read.id(), column.path));
      std::visit(
          [&](const auto* values) {
            using T = typename std::decay_t<decltype(*values)>::value_type;
            CHECK(task_rows<T>(read, column, plan.task(i), axis_sizes(plan)) == *values);
          },
          column.values(record));
    }
  }
  CHECK(hdf5::read_all<std::uint8_t>(read.id(), "/tasks/state") == std::vector<std::uint8_t>{1, 1, 0, 1, 0, 1});
  CHECK(hdf5::read_all<std::string>(read.id(), "/tasks/outcome") ==
        std::vector<std::string>{"ok", "ok", "pending", "ok", "pending", "ok"});
}

TEST_CASE("rows that a task did not reach hold sentinels, not zeros") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(GENERATE(full_job(), full_data_job()));
  {
    ResultsFile file = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
    TaskRecord record;
    record.prepare(plan.task(1), axis_sizes(plan));
    record.outcome = TaskOutcome::error;
    record.message = "the scene cannot be built";
    file.write(plan.task(1), record);
  }
  const hdf5::File read = hdf5::open_file(folder / "a.h5", H5F_ACC_RDONLY);
  TaskRecord types;
  for (const Column& column : columns()) {
    INFO(column.path);
    std::visit(
        [&](const auto* values) {
          using T = typename std::decay_t<decltype(*values)>::value_type;
          for (const T value : task_rows<T>(read, column, plan.task(1), axis_sizes(plan))) {
            if constexpr (std::is_floating_point_v<T>) {
              CHECK(std::isnan(value));
            } else {
              CHECK(value == (column.path == std::string("/solves/outcome") ? 0 : -1));
            }
          }
        },
        column.values(types));
  }
  CHECK(hdf5::RowDataset(read.id(), "/tasks/outcome").text(1) == "error");
  CHECK(hdf5::RowDataset(read.id(), "/tasks/message").text(1) == "the scene cannot be built");
}

TEST_CASE("a task whose record cannot be written whole stays pending") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(full_job());
  ResultsFile file = ResultsFile::create(folder / "a.h5", plan, test_provenance(), MPI_COMM_SELF);
  TaskRecord record = synthetic_record(plan, 2);
  record.timing.elapsed_s.push_back(1);  // one of the last columns
  CHECK(message_of<std::logic_error>([&] { file.write(plan.task(2), record); }) ==
        "the record of task 2 holds 2 values for /timing/tasks/elapsed_s, not 1");
  CHECK(stored<std::uint8_t>(folder / "a.h5", "/tasks/state") == std::vector<std::uint8_t>(6, 0));
}

TEST_CASE("what the plan knows is in the file from the start") {
  const FullFile made(0);
  CHECK(stored_texts(made.path, "/job/text").at(0) == made.plan.job().text);
  CHECK(stored_texts(made.path, "/axes/guess") == std::vector<std::string>{"zero", "previous"});
  CHECK(stored<double>(made.path, "/axes/tolerance") == tolerance_ladder());
  CHECK(stored<std::int32_t>(made.path, "/tasks/segments") == std::vector<std::int32_t>{4, 4, 5, 5, 7, 7});
  CHECK(stored<std::int64_t>(made.path, "/tasks/parameters/scene.segments") ==
        std::vector<std::int64_t>{4, 4, 5, 5, 7, 7});
  CHECK(stored<double>(made.path, "/tasks/parameters/scene.gravity_m_s2").size() == 18);
  CHECK(stored_texts(made.path, "/tasks/parameters/scene.type") == std::vector<std::string>(6, "bending_rod"));
  CHECK(stored<std::int64_t>(made.path, "/tasks/first_frame_row") == std::vector<std::int64_t>{0, 8, 16, 26, 36, 50});
  CHECK(stored<std::int64_t>(made.path, "/tasks/first_segment_row") == std::vector<std::int64_t>{0, 4, 8, 13, 18, 25});
  CHECK(stored_texts(made.path, "/tasks/outcome") == std::vector<std::string>(6, "pending"));

  const hdf5::File read = hdf5::open_file(made.path, H5F_ACC_RDONLY);
  CHECK(hdf5::read_text_attribute(read.id(), "/", "program") == "rodsweep");
  CHECK(hdf5::read_int_attribute(read.id(), "/", "schema_version") == schema_version);
  CHECK(hdf5::read_text_attribute(read.id(), "/job", "name") == "small");
  CHECK(hdf5::read_int_attribute(read.id(), "/tasks/parameters/scene.segments", "swept") == 1);
  CHECK(hdf5::read_int_attribute(read.id(), "/tasks/parameters/scene.radius_m", "swept") == 0);
}

TEST_CASE("every dataset says its unit and meaning") {
  const FullFile made(0, GENERATE(full_job(), full_data_job()));
  const hdf5::File read = hdf5::open_file(made.path, H5F_ACC_RDONLY);
  std::vector<std::string> datasets;
  H5Ovisit2(
      read.id(), H5_INDEX_NAME, H5_ITER_NATIVE,
      [](hid_t, const char* name, const auto* info, void* names) -> herr_t {
        if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(names)->push_back(name);
        return 0;
      },
      &datasets, H5O_INFO_BASIC);
  CHECK(datasets.size() == layout(made.plan, made.plan.parameters()).size());
  for (const std::string& path : datasets) {
    INFO(path);
    CHECK_FALSE(hdf5::read_text_attribute(read.id(), path, "unit").empty());
    CHECK_FALSE(hdf5::read_text_attribute(read.id(), path, "meaning").empty());
  }
}

TEST_CASE("datasets that would be empty are left out, and the rest of a record is written") {
  const TemporaryFolder folder;
  const auto write_first = [&](const Json& job, const std::string& name) {
    const Plan plan = plan_of(job);
    make_file(folder / name, plan, 1);
    return folder / name;
  };
  const auto summary = write_first(with("/record", R"({"solves": "summary"})", full_job()), "summary.h5");
  CHECK_FALSE(holds(summary, "/solves/iterations"));
  CHECK_FALSE(holds(summary, "/trajectories/position_m"));
  CHECK_FALSE(holds(summary, "/trajectories/segments/radius_m"));
  CHECK_FALSE(holds(summary, "/tasks/first_segment_row"));
  CHECK(holds(summary, "/tasks/iterations_sum"));

  const auto direct =
      write_first(without("/guesses", with("/solve", R"({"method": "direct"})", full_job())), "direct.h5");
  CHECK_FALSE(holds(direct, "/axes/guess"));
  CHECK_FALSE(holds(direct, "/tasks/iterations_sum"));
  CHECK_FALSE(holds(direct, "/solves/iterations"));
  CHECK(holds(direct, "/solves/newton"));
  CHECK(stored<std::uint8_t>(direct, "/tasks/state").at(0) == 1);
}

TEST_CASE("contacts have columns where rods touch in any task, also in the file of one task alone") {
  const TemporaryFolder folder;
  const Plan plan = plan_of(with("/scene/contact", R"({"grid": ["none", {}]})")), none = plan_of(small_job());
  make_file(folder / "some.h5", plan, 2);
  make_file(folder / "alone.h5", plan.single_task(0, 0), 1);
  make_file(folder / "none.h5", none, 1);
  for (const char* path : {"/tasks/penetration", "/steps/contacts", "/steps/penetration", "/steps/contact_residual"}) {
    CHECK(holds(folder / "some.h5", path));
    CHECK(holds(folder / "alone.h5", path));
    CHECK_FALSE(holds(folder / "none.h5", path));
  }
  CHECK(stored<std::int32_t>(folder / "some.h5", "/steps/contacts").size() == 20);
  for (const char* name : {"some.h5", "alone.h5", "none.h5"}) CHECK(verify(folder / name).damaged.empty());
}

TEST_CASE("forces have columns where a job records them, also in the file of one task alone") {
  const TemporaryFolder folder;
  Json job = full_job();
  job["record"]["forces"] = true;
  const Plan plan = plan_of(job), none = plan_of(full_job());
  make_file(folder / "some.h5", plan, 6);
  make_file(folder / "alone.h5", plan.single_task(3, 1), 1);
  make_file(folder / "none.h5", none, 6);
  for (const char* path :
       {"/tasks/first_frame_joint", "/tasks/first_joint_row", "/steps/clamp_force_n", "/steps/clamp_moment_nm",
        "/steps/obstacle_force_n", "/trajectories/joint_position_m", "/trajectories/joint_force_n",
        "/trajectories/joint_moment_nm", "/trajectories/joints/first", "/trajectories/joints/second"}) {
    INFO(path);
    CHECK(holds(folder / "some.h5", path));
    CHECK(holds(folder / "alone.h5", path));
    CHECK_FALSE(holds(folder / "none.h5", path));
  }
  // Two frames of 3, 4 and 6 joints.
  CHECK(stored<std::int64_t>(folder / "some.h5", "/tasks/first_frame_joint") ==
        std::vector<std::int64_t>{0, 6, 12, 20, 28, 40});
  CHECK(stored<std::int64_t>(folder / "some.h5", "/tasks/first_joint_row") ==
        std::vector<std::int64_t>{0, 3, 6, 10, 14, 20});
  CHECK(stored<double>(folder / "some.h5", "/trajectories/joint_force_n").size() == 3 * 52);
  for (const char* name : {"some.h5", "alone.h5", "none.h5"}) CHECK(verify(folder / name).damaged.empty());
}

TEST_CASE("a file older than the columns of contact has the checksums that it had") {
  const Plan plan = plan_of(full_job());
  TaskRecord record = synthetic_record(plan, 2);
  record.message = "a message";
  Checksum sum;
  const std::int64_t index = 2;
  sum.add(&index, sizeof index);
  const auto add = [&](std::string_view bytes) { sum.add(bytes.data(), bytes.size()); };
  add(hdf5::fixed_text("ok", outcome_bytes));
  add(hdf5::fixed_text("a message", message_bytes));
  for (const Column& column : columns())
    if (!is_optional(column.rows) && std::string(column.path).rfind("/timing/", 0) != 0) add(bytes_of(column, record));
  CHECK(task_checksum(2, record) == sum.value());
  record.steps.contacts.assign(1, 3);
  CHECK(task_checksum(2, record) != sum.value());
}

TEST_CASE("the predicted size of the file is within 5 % of its real size, 6 % with HDF5 2") {
  const TemporaryFolder folder;
  const Json jobs[] = {small_job(), full_job(), with("/samples", "1000", full_job()),
                       with("/record", R"({"solves": "summary"})", with("/samples", "500", full_job()))};
  for (const Json& job : jobs) {
    const Plan plan = plan_of(job);
    const auto path = folder / (std::to_string(&job - jobs) + ".h5");
    make_file(path, plan, 0);
    const auto real = static_cast<double>(std::filesystem::file_size(path));
    CHECK(static_cast<double>(file_bytes(plan)) == Approx(real).epsilon(H5_VERS_MAJOR < 2 ? 0.05 : 0.06));
    CHECK(static_cast<double>(file_bytes(plan)) >= real);  // the free-space check must not underestimate
  }
}

TEST_CASE("a file of more bytes than any disk has is refused with the dataset and its sizes") {
  Json job = small_job();  // 10^15 solves; per guess 8 counts of 2 bytes and 19 more bytes
  job["scene"] = Json::parse(
      R"({"type": "falling_rods", "rods": 1000, "segments": 500, "length_m": 1, "height_m": 0.3, "turn_deg": 70,
          "radius_m": {"uniform": [0.004, 0.005]}, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6,
          "torsion_modulus_pa": 1e6})");
  job["time"] = {{"step_s", 0.02}, {"steps", 10000000}, {"newton_iterations", 1000}};
  job["samples"] = 100;
  job["guesses"] = {"zero"};
  for (int i = 0; i < 599; ++i) job["guesses"].push_back({{"oracle", {{"error", 0.1}, {"label", std::to_string(i)}}}});
  const Plan plan = plan_of(job);
  CHECK_THAT(message_of<FileError>([&] { file_bytes(plan); }),
             StartsWith("job.json: the results file would be too large: /solves/initial_residual has "
                        "1000000000000000 x 600 values of 8 bytes, and the file exceeds 1e+18 bytes; record less"));
}

TEST_CASE("the bytes of a file are reserved when it is created, where the file system can") {
  const TemporaryFolder folder;
  const int probe = open((folder / "probe").c_str(), O_RDWR | O_CREAT, 0600);
  const bool can = fallocate(probe, 0, 0, 4096) == 0;
  close(probe);
  if (!can) return;
  const Plan plan = plan_of(with("/samples", "1000", full_job()));
  make_file(folder / "a.h5", plan, 0);
  struct stat status {};
  REQUIRE(stat((folder / "a.h5").c_str(), &status) == 0);
  CHECK(status.st_blocks * 512 >= status.st_size);
}

}  // namespace test_file
