// Limits of control groups, and memory.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "runner/measure/host_memory.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
namespace fs = std::filesystem;

namespace test_host_memory {

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

TEST_CASE("a host's memory is the machine's or the least that a control group allows") {
  const TemporaryFolder folder;
  const auto found = [&] { return host_memory(folder.path(), folder / "proc"); };
  const double machine = found();
  CHECK(machine > 1e8);

  const fs::path groups = folder / "sys/fs/cgroup";
  SECTION("version 2") {
    write(folder / "proc/self/cgroup", "0::/job_7/step_0\n");
    write(groups / "job_7/step_0/memory.max", "max\n");
    CHECK(found() == machine);
    write(groups / "job_7/memory.max", "50000000\n");
    CHECK(found() == 50000000);
    write(groups / "job_7/step_0/memory.max", "20000000\n");
    CHECK(found() == 20000000);
  }
  SECTION("version 1") {
    write(folder / "proc/self/cgroup", "9:name=systemd:/\n4:memory:/job_7\n0::/\n");
    CHECK(found() == machine);
    write(groups / "memory/job_7/memory.limit_in_bytes", "9223372036854771712\n");
    CHECK(found() == machine);
    write(groups / "memory/memory.limit_in_bytes", "30000000\n");
    CHECK(found() == 30000000);
  }
}

TEST_CASE("the quota of processors is the least that a control group allows") {
  const TemporaryFolder folder;
  const auto found = [&] { return cpu_quota(folder.path(), folder / "proc"); };
  CHECK(std::isinf(found()));
  const fs::path groups = folder / "sys/fs/cgroup";
  SECTION("version 2") {
    write(folder / "proc/self/cgroup", "0::/job_7/step_0\n");
    write(groups / "job_7/step_0/cpu.max", "max 100000\n");
    CHECK(std::isinf(found()));
    write(groups / "job_7/cpu.max", "400000 100000\n");
    CHECK(found() == 4);
    write(groups / "job_7/step_0/cpu.max", "75000 50000\n");
    CHECK(found() == 1.5);
  }
  SECTION("version 1") {
    write(folder / "proc/self/cgroup", "4:memory:/other\n3:cpu,cpuacct:/job_7\n");
    write(groups / "cpu,cpuacct/job_7/cpu.cfs_quota_us", "-1\n");
    write(groups / "cpu,cpuacct/job_7/cpu.cfs_period_us", "100000\n");
    CHECK(std::isinf(found()));
    write(groups / "cpu,cpuacct/job_7/cpu.cfs_quota_us", "100000\n");
    CHECK(found() == 1);
  }
}

TEST_CASE("the peak of memory stays when it is given back") {
  const double before = peak_memory();
  REQUIRE(before > 0);
  { const std::vector<char> held(100'000'000, 1); }
  CHECK(peak_memory() > before + 9e7);
}

}  // namespace test_host_memory
