// The cost of the results file: expanding a plan of 100,000 tasks and creating its file (targets: 5 s, 500 MB of
// memory), finding all tasks in an earlier file to extend, writing a task, and writing while tasks run (target: at most
// 2 % of a sweep's time). bench_file [folder]; removes its files.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <numeric>

#include "runner/file/extension.hpp"
#include "runner/file/hdf5.hpp"
#include "runner/file/results_file.hpp"
#include "runner/measure/run_task.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/formats.hpp"
#include "solver/cg/petsc_session.hpp"

namespace {

using namespace rodsweep;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

Plan plan_of(int segments, int steps, int newton_iterations, int samples, bool trajectory, bool rows = true) {
  return Plan(
      parse_job(fmt::format(R"({{"name": "bench", "kind": "sweep", "samples": {},
      "scene": {{"type": "bending_rod", "segments": {}, "length_m": {{"uniform": [1, 5]}}, "radius_m": 0.05,
        "density_kg_m3": 1000, "youngs_modulus_pa": {{"log_uniform": [1e4, 1e6]}}, "torsion_modulus_pa": 1e6}},
      "time": {{"step_s": 0.02, "steps": {}, "newton_iterations": {}}},
      "guesses": ["zero", "previous", "linear", "quadratic"], "record": {{"trajectory_every": {}, "solves": "{}"}} }})",
                            samples, segments, steps, newton_iterations, trajectory ? 1 : 0, rows ? "all" : "summary"),
                "bench.json"));
}

ResultsFile create(const fs::path& path, const Plan& plan) {
  fs::remove(path);
  return ResultsFile::create(path, plan, provenance_of_this_process("bench_file"), MPI_COMM_SELF);
}

/// Runs first, since peak memory never decreases.
void bench_creation(const fs::path& path, bool rows) {
  const auto begin = Clock::now();
  const Plan plan = plan_of(10, 10, 1, 100000, false, rows);
  const double expanded_s = seconds_since(begin);
  ResultsFile file = create(path, plan);
  fmt::print(
      "file: {} tasks, {}: expanded in {:.2f} s, with the file of {} created and opened in {:.2f} s (target 5), "
      "peak memory {:.0f} MB (target 500)\n",
      plan.size(), rows ? "all rows" : "summary", expanded_s,
      bytes_text(static_cast<std::int64_t>(fs::file_size(path))), seconds_since(begin), peak_megabytes());
}

void bench_extension(const fs::path& path) {
  const Plan plan = plan_of(10, 10, 1, 100000, false, false);
  {
    ResultsFile file = create(path, plan);
    file.close();
    const hdf5::File all = hdf5::open_file(path, H5F_ACC_RDWR);
    const auto tasks = static_cast<std::size_t>(plan.size());
    hdf5::write_all(all.id(), "/tasks/state", std::vector<std::uint8_t>(tasks, 1));
    hdf5::write_all(all.id(), "/tasks/outcome", std::vector<std::string>(tasks, "ok"));
  }
  const auto begin = Clock::now();
  const Extension extension(path, plan);
  fmt::print("file: {} of {} tasks found in an earlier file in {:.2f} s, peak memory {:.0f} MB\n", extension.copied(),
             plan.size(), seconds_since(begin), peak_megabytes());
}

/// Writes records of sentinels only, since only the bytes matter.
void bench_writing(const fs::path& path, const char* name, const Plan& plan) {
  ResultsFile file = create(path, plan);
  const auto size = static_cast<double>(fs::file_size(path)) / static_cast<double>(plan.size());
  TaskRecord record;
  double seconds = 0;
  for (const Task& task : plan.tasks()) {
    record.prepare(task, axis_sizes(plan));
    const auto begin = Clock::now();
    file.write(task, record);
    seconds += seconds_since(begin);
  }
  fmt::print("file: writing {}, {} each: {:.0f} us\n", name, bytes_text(static_cast<std::int64_t>(size)),
             seconds / static_cast<double>(plan.size()) * 1e6);
}

void bench_share(const fs::path& path, const char* name, const Plan& plan) {
  {
    ResultsFile file = create(path, plan);
    TaskRecord record;
    for (const Task& task : plan.tasks()) {
      record.prepare(task, axis_sizes(plan));
      run_task(task, plan.spec(task.index), record);
      file.write(task, record);
    }
  }
  const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDONLY);
  const auto mean = [&](const char* dataset) {
    const auto values = hdf5::read_all<double>(file.id(), dataset);
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  const double work = mean("/timing/tasks/elapsed_s"), write = mean("/timing/tasks/write_s");
  fmt::print("file: {}: {:.1f} ms of work and {:.3f} ms of writing a task: {:.2f} % (target 2 %)\n", name, work * 1e3,
             write * 1e3, 100 * write / work);
}

}  // namespace

int main(int argc, char** argv) {
  const MpiSession mpi;
  const PetscSession petsc;
  const fs::path path = fs::path(argc > 1 ? argv[1] : ".") / "bench_file.h5";
  bench_creation(path, false);
  bench_creation(path, true);
  bench_extension(path);
  bench_writing(path, "a small task (N 10, 10 steps of 1 Newton iteration)", plan_of(10, 10, 1, 1000, false));
  bench_writing(path, "a task (N 30, 100 steps of 6)", plan_of(30, 100, 6, 200, false));
  bench_writing(path, "a task with trajectory (N 100, 500 steps of 6)", plan_of(100, 500, 6, 20, true));
  bench_share(path, "N 10, 10 steps of 6 Newton iterations (hardly work at all)", plan_of(10, 10, 6, 200, false));
  bench_share(path, "N 30, 100 steps of 6 Newton iterations", plan_of(30, 100, 6, 10, false));
  fs::remove(path);
  return 0;
}
