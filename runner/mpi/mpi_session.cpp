#include "runner/mpi/mpi_session.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <thread>

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

void check_mpi(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw MpiError("{} failed: {}", call, text.data());
}

int rank_in(MPI_Comm comm) {
  int rank = 0;
  check_mpi(MPI_Comm_rank(comm, &rank), "MPI_Comm_rank");
  return rank;
}

int ranks_in(MPI_Comm comm) {
  int size = 1;
  check_mpi(MPI_Comm_size(comm, &size), "MPI_Comm_size");
  return size;
}

MpiSession::MpiSession() {
  int provided = 0;  // during a call of a user's code another thread calls MPI: one at a time
  check_mpi(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), "MPI_Init_thread");
  if (provided < MPI_THREAD_SERIALIZED)
    throw MpiError("this MPI library does not support calls by several threads, one at a time (MPI_THREAD_SERIALIZED)");
  // Communicators derived from these, also those of HDF5 and PETSc, inherit the handler and return their errors.
  check_mpi(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
  check_mpi(MPI_Comm_set_errhandler(MPI_COMM_SELF, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
  rank_ = rank_in(MPI_COMM_WORLD);
  size_ = ranks_in(MPI_COMM_WORLD);
}

MpiSession::~MpiSession() { MPI_Finalize(); }

namespace {

std::string broadcast_from(int root, std::string text, MPI_Comm comm) {
  auto size = static_cast<unsigned long long>(text.size());
  check_mpi(MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG_LONG, root, comm), "MPI_Bcast");
  text.resize(size);
  check_mpi(MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, root, comm), "MPI_Bcast");
  return text;
}

}  // namespace

std::string broadcast(std::string text, MPI_Comm comm) { return broadcast_from(0, std::move(text), comm); }

int broadcast(int value, MPI_Comm comm) {
  check_mpi(MPI_Bcast(&value, 1, MPI_INT, 0, comm), "MPI_Bcast");
  return value;
}

double min_over_ranks(double value, MPI_Comm comm) {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MIN, comm), "MPI_Allreduce");
  return value;
}

void broadcast(void* data, std::size_t bytes, MPI_Comm comm) {
  constexpr std::size_t at_once = std::size_t{1} << 30;  // MPI counts in int
  for (std::size_t done = 0; done < bytes; done += at_once)
    check_mpi(MPI_Bcast(static_cast<char*>(data) + done, static_cast<int>(std::min(at_once, bytes - done)), MPI_BYTE, 0,
                        comm),
              "MPI_Bcast");
}

std::vector<std::string> gather_to_all(const std::string& text, MPI_Comm comm) {
  constexpr std::size_t bytes = 256;
  const int size = ranks_in(comm);
  std::string mine = text.substr(0, bytes - 1), all(static_cast<std::size_t>(size) * bytes, '\0');
  mine.resize(bytes);
  check_mpi(MPI_Allgather(mine.data(), bytes, MPI_CHAR, all.data(), bytes, MPI_CHAR, comm), "MPI_Allgather");
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < all.size(); at += bytes) texts.emplace_back(all.c_str() + at);
  return texts;
}

std::vector<std::string> gather_distinct(const std::string& text, MPI_Comm comm) {
  std::vector<std::string> texts;
  for (std::string& each : gather_to_all(text, comm))
    if (!each.empty() && std::find(texts.begin(), texts.end(), each) == texts.end()) texts.push_back(std::move(each));
  return texts;
}

void collectively(MPI_Comm comm, const std::function<void()>& part) {
  const int rank = rank_in(comm), size = ranks_in(comm);

  std::string text;
  int failed = size;
  try {
    part();
  } catch (const std::exception& error) {
    text = rank == 0 ? error.what() : fmt::format("rank {}: {}", rank, error.what());
    failed = rank;
  }
  int lowest = size;
  check_mpi(MPI_Allreduce(&failed, &lowest, 1, MPI_INT, MPI_MIN, comm), "MPI_Allreduce");
  if (lowest < size) throw CollectiveError(broadcast_from(lowest, std::move(text), comm));
}

void by_rank_0(const std::optional<MPI_Comm>& ranks, const std::function<void()>& part) {
  if (!ranks) return part();
  const int rank = rank_in(*ranks);
  collectively(*ranks, [&] {
    if (rank == 0) part();
  });
}

Placement placement(MPI_Comm comm, RankRoles roles) {
  const int rank = rank_in(comm), size = ranks_in(comm);

  MPI_Comm host = MPI_COMM_NULL;
  check_mpi(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &host), "MPI_Comm_split_type");
  cpu_set_t mine, ours;
  CPU_ZERO(&mine);
  if (sched_getaffinity(0, sizeof mine, &mine) != 0)  // mpirun may bind each rank to one core
    for (unsigned core = 0; core < std::thread::hardware_concurrency() && core < CPU_SETSIZE; ++core)
      CPU_SET(core, &mine);
  check_mpi(MPI_Allreduce(&mine, &ours, sizeof mine, MPI_BYTE, MPI_BOR, host), "MPI_Allreduce");

  const int works = size == 1 || rank > 0 || roles == RankRoles::all_work;
  int host_rank = 0, host_workers = 0;
  host_rank = rank_in(host);
  check_mpi(MPI_Allreduce(&works, &host_workers, 1, MPI_INT, MPI_SUM, host), "MPI_Allreduce");
  check_mpi(MPI_Comm_free(&host), "MPI_Comm_free");

  const int host_cores = std::max(1, static_cast<int>(std::min<double>(CPU_COUNT(&ours), cpu_quota())));
  std::array<int, 3> part{works, host_rank == 0 ? host_cores : 0, host_workers > host_cores}, sum{};
  check_mpi(MPI_Allreduce(part.data(), sum.data(), 3, MPI_INT, MPI_SUM, comm), "MPI_Allreduce");
  const int threads = std::min(CPU_COUNT(&mine), host_cores / std::max(host_workers, 1));
  return {sum[0], sum[1], std::max(threads, 1), std::max(host_workers, 1), sum[2] > 0};
}

double memory_quota(const fs::path& root, const fs::path& proc) {
  return quota(root, proc, "memory", memory_of_version_1, memory_of_version_2);
}

double cpu_quota(const fs::path& root, const fs::path& proc) {
  return quota(root, proc, "cpu", cpus_of_version_1, cpus_of_version_2);
}

}  // namespace rodsweep
