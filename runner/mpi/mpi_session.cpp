#include "runner/mpi/mpi_session.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <thread>

#include "runner/mpi/control_groups.hpp"

namespace rodsweep {

void check_mpi(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw MpiError(fmt::format("{} failed: {}", call, text.data()));
}

MpiSession::MpiSession() {
  int provided = 0;  // during a call of a user's code another thread calls MPI: one at a time
  check_mpi(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), "MPI_Init_thread");
  if (provided < MPI_THREAD_SERIALIZED)
    throw MpiError("this MPI library does not support calls by several threads, one at a time (MPI_THREAD_SERIALIZED)");
  // Communicators derived from these, also those of HDF5 and PETSc, inherit the handler and return their errors.
  check_mpi(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
  check_mpi(MPI_Comm_set_errhandler(MPI_COMM_SELF, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
  check_mpi(MPI_Comm_rank(MPI_COMM_WORLD, &rank_), "MPI_Comm_rank");
  check_mpi(MPI_Comm_size(MPI_COMM_WORLD, &size_), "MPI_Comm_size");
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
  int size = 1;
  check_mpi(MPI_Comm_size(comm, &size), "MPI_Comm_size");
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
  int rank = 0, size = 1;
  check_mpi(MPI_Comm_rank(comm, &rank), "MPI_Comm_rank");
  check_mpi(MPI_Comm_size(comm, &size), "MPI_Comm_size");

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
  int rank = 0;
  check_mpi(MPI_Comm_rank(*ranks, &rank), "MPI_Comm_rank");
  collectively(*ranks, [&] {
    if (rank == 0) part();
  });
}

Placement placement(MPI_Comm comm, RankRoles roles) {
  int rank = 0, size = 1;
  check_mpi(MPI_Comm_rank(comm, &rank), "MPI_Comm_rank");
  check_mpi(MPI_Comm_size(comm, &size), "MPI_Comm_size");

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
  check_mpi(MPI_Comm_rank(host, &host_rank), "MPI_Comm_rank");
  check_mpi(MPI_Allreduce(&works, &host_workers, 1, MPI_INT, MPI_SUM, host), "MPI_Allreduce");
  check_mpi(MPI_Comm_free(&host), "MPI_Comm_free");

  const int host_cores = std::max(1, static_cast<int>(std::min<double>(CPU_COUNT(&ours), cpu_quota())));
  std::array<int, 3> part{works, host_rank == 0 ? host_cores : 0, host_workers > host_cores}, sum{};
  check_mpi(MPI_Allreduce(part.data(), sum.data(), 3, MPI_INT, MPI_SUM, comm), "MPI_Allreduce");
  const int threads = std::min(CPU_COUNT(&mine), host_cores / std::max(host_workers, 1));
  return {sum[0], sum[1], std::max(threads, 1), std::max(host_workers, 1), sum[2] > 0};
}

}  // namespace rodsweep
