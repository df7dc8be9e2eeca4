// Limits of control groups, and memory.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "runner/measure/host_memory.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "tests/catch.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
namespace fs = std::filesystem;

namespace test_host_memory {

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

TEST_CASE("a host has the least memory and quota of processors that a control group of version 2 allows") {
  const TemporaryFolder folder;
  const auto memory = [&] { return host_memory(folder.path(), folder / "proc"); };
  const auto cores = [&] { return cpu_quota(folder.path(), folder / "proc"); };
  const double machine = memory();
  CHECK(machine > 1e8);
  CHECK(std::isinf(cores()));

  const fs::path job = folder / "sys/fs/cgroup/job_7", step = job / "step_0";
  write(folder / "proc/self/cgroup", "0::/job_7/step_0\n");
  write(step / "memory.max", "max\n");
  write(step / "cpu.max", "max 100000\n");
  CHECK(memory() == machine);
  CHECK(std::isinf(cores()));
  write(job / "memory.max", "50000000\n");
  write(job / "cpu.max", "400000 100000\n");
  CHECK(memory() == 50000000);
  CHECK(cores() == 4);
  write(step / "memory.max", "20000000\n");
  write(step / "cpu.max", "75000 50000\n");
  CHECK(memory() == 20000000);
  CHECK(cores() == 1.5);
}

TEST_CASE("a host has what control groups of version 1 allow") {
  const TemporaryFolder folder;
  const auto memory = [&] { return host_memory(folder.path(), folder / "proc"); };
  const auto cores = [&] { return cpu_quota(folder.path(), folder / "proc"); };
  const double machine = memory();
  const fs::path groups = folder / "sys/fs/cgroup";
  write(folder / "proc/self/cgroup", "9:name=systemd:/\n4:memory:/job_7\n3:cpu,cpuacct:/job_7\n0::/\n");
  CHECK(memory() == machine);
  write(groups / "memory/job_7/memory.limit_in_bytes", "9223372036854771712\n");
  write(groups / "cpu,cpuacct/job_7/cpu.cfs_quota_us", "-1\n");
  write(groups / "cpu,cpuacct/job_7/cpu.cfs_period_us", "100000\n");
  CHECK(memory() == machine);
  CHECK(std::isinf(cores()));
  write(groups / "memory/memory.limit_in_bytes", "30000000\n");
  write(groups / "cpu,cpuacct/job_7/cpu.cfs_quota_us", "100000\n");
  CHECK(memory() == 30000000);
  CHECK(cores() == 1);
}

TEST_CASE("the peak of memory stays when it is given back") {
  const double before = peak_memory();
  REQUIRE(before > 0);
  { const std::vector<char> held(100'000'000, 1); }
  CHECK(peak_memory() > before + 9e7);
}

}  // namespace test_host_memory
