#include "runner/mpi/control_groups.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

namespace rodsweep {
namespace {

namespace fs = std::filesystem;
constexpr double unlimited = std::numeric_limits<double>::infinity();

/// A number; unlimited if it is missing, "max" (version 2) or negative (version 1).
double next_number(std::istream& in) {
  double value = 0;
  return in >> value && value >= 0 ? value : unlimited;
}

double number_in(const fs::path& path) {
  std::ifstream file(path);
  return next_number(file);
}

double memory_of_version_2(const fs::path& group) { return number_in(group / "memory.max"); }
double memory_of_version_1(const fs::path& group) { return number_in(group / "memory.limit_in_bytes"); }

double cpus_of_version_2(const fs::path& group) {
  std::ifstream file(group / "cpu.max");  // QUOTA PERIOD in microseconds
  const double quota = next_number(file);
  return quota == unlimited ? unlimited : quota / next_number(file);
}
double cpus_of_version_1(const fs::path& group) {
  const double quota = number_in(group / "cpu.cfs_quota_us");
  return quota == unlimited ? unlimited : quota / number_in(group / "cpu.cfs_period_us");
}

using LimitOf = std::function<double(const fs::path& group)>;

/// The least limit of a group and its ancestors.
double least_above(const fs::path& mount, std::string group, const LimitOf& limit) {
  double least = unlimited;
  for (;;) {
    least = std::min(least, limit(mount / fs::path(group).relative_path()));
    if (group.empty() || group == "/") return least;
    group = fs::path(group).parent_path().native();
  }
}

double quota(const fs::path& root, const fs::path& proc, const std::string& controller, const LimitOf& version_1,
             const LimitOf& version_2) {
  double least = unlimited;
  std::ifstream groups(proc / "self/cgroup");
  const fs::path mount = root / "sys/fs/cgroup";
  for (std::string line; std::getline(groups, line);) {  // NUMBER:CONTROLLERS:GROUP; version 2 has no controllers
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (controllers.empty())
      least = std::min(least, least_above(mount, group, version_2));
    else if ((',' + controllers + ',').find(',' + controller + ',') != std::string::npos)
      least = std::min(least, least_above(mount / controllers, group, version_1));
  }
  return least;
}

}  // namespace

double memory_quota(const fs::path& root, const fs::path& proc) {
  return quota(root, proc, "memory", memory_of_version_1, memory_of_version_2);
}

double cpu_quota(const fs::path& root, const fs::path& proc) {
  return quota(root, proc, "cpu", cpus_of_version_1, cpus_of_version_2);
}

}  // namespace rodsweep
