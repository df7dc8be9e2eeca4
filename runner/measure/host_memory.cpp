#include "runner/measure/host_memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/formats.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;
constexpr double unlimited = std::numeric_limits<double>::infinity();

double bytes_allowed = unlimited;  // bytes, of this process

/// A value of /proc/self/status in bytes; 0 if missing.
double of_status(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(key, 0) == 0) {
      double kibibytes = 0;
      std::istringstream(line.substr(key.size())) >> kibibytes;
      return 1024 * kibibytes;
    }
  return 0;
}

}  // namespace

double host_memory(const fs::path& root, const fs::path& proc) {
  const double machine = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::min(machine, memory_quota(root, proc));
}

void limit_memory(double bytes) {
#ifdef __SANITIZE_ADDRESS__
  static_cast<void>(bytes);  // the sanitizer's shadow memory would exceed any limit
#else
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
  // RLIMIT_DATA counts address space; much of that of thread stacks and library buffers is never touched.
  const double untouched = std::max(0.0, of_status("VmData:") - of_status("RssAnon:"));
  const double most = std::min(static_cast<double>(limit.rlim_cur), 1e18);
  bytes_allowed = bytes;
  limit.rlim_cur = static_cast<rlim_t>(std::min(bytes + untouched, most));
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

double memory_left() { return bytes_allowed - of_status("RssAnon:"); }

const char* const more_memory_text = "use fewer ranks per host, or raise --memory-limit-gb";

std::string out_of_memory_text() {
  if (bytes_allowed == unlimited) return "out of memory";
  return fmt::format("out of memory: the task needs more than the limit of this process, {}; {}",
                     bytes_text(static_cast<std::int64_t>(bytes_allowed)), more_memory_text);
}

double peak_memory() { return of_status("VmHWM:"); }

}  // namespace rodsweep
