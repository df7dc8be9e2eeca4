// The lifetime of MPI, and the collective operations that set up a run. Exactly one session per process, in main();
// all users of MPI, PETSc and the results file are destroyed before it.
//
// MPI returns error codes; these are thrown as MpiError with the name of the call. Nothing here aborts.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "runner/text/formatted_error.hpp"

namespace rodsweep {

/// A failed MPI call: its name and MPI's error text.
struct MpiError : FormattedError<> {
  using FormattedError::FormattedError;
};

/// A collective operation failed on at least one rank. what() is the same on every rank.
struct CollectiveError : FormattedError<> {
  using FormattedError::FormattedError;
};

void check_mpi(int code, const char* call);

int rank_in(MPI_Comm comm);
int ranks_in(MPI_Comm comm);

class MpiSession {
 public:
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  MPI_Comm world() const { return MPI_COMM_WORLD; }
  int rank() const { return rank_; }
  int size() const { return size_; }

 private:
  int rank_ = 0, size_ = 1;
};

/// Returns rank 0's text on every rank.
std::string broadcast(std::string text, MPI_Comm comm);
int broadcast(int value, MPI_Comm comm);
void broadcast(void* data, std::size_t bytes, MPI_Comm comm);

/// The minimum over all ranks, on every rank.
double min_over_ranks(double value, MPI_Comm comm);

/// Replaces `values` by rank 0's, and resizes it.
template <class T>
void broadcast(std::vector<T>& values, MPI_Comm comm) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::uint64_t size = values.size();
  broadcast(&size, sizeof size, comm);
  values.resize(size);
  broadcast(values.data(), size * sizeof(T), comm);
}

/// All ranks' texts, indexed by rank, on every rank; each is truncated to 255 bytes.
std::vector<std::string> gather_to_all(const std::string& text, MPI_Comm comm);
/// The same without empty texts, and each text once.
std::vector<std::string> gather_distinct(const std::string& text, MPI_Comm comm);

/// Calls `part` on every rank. If it throws on any rank, all ranks throw a CollectiveError with the message of the
/// lowest failed rank (and its number, if not 0). So an error is reported once, and no rank waits for a failed one.
void collectively(MPI_Comm comm, const std::function<void()>& part);

/// The same, for a `part` that returns a value.
template <class Part, class Made = std::invoke_result_t<Part>, class = std::enable_if_t<!std::is_void_v<Made>>>
Made collectively(MPI_Comm comm, const Part& part) {
  std::optional<Made> made;
  collectively(comm, std::function<void()>([&] { made.emplace(part()); }));
  return std::move(*made);
}

/// Calls `part` on rank 0. If it throws, all ranks throw a CollectiveError with its message. Without `ranks`, this
/// process calls `part`.
void by_rank_0(const std::optional<MPI_Comm>& ranks, const std::function<void()>& part);

/// The numbers of ranks and of the cores that they may use: on each host the union of the affinity masks, or the quota of
/// its control group.
struct Placement {
  int workers = 1;              ///< ranks that compute: all but the master of a sweep; a single rank counts
  int cores = 1;                ///< on all hosts
  int threads = 1;              ///< this rank's share of its host's cores; at least 1
  int host_workers = 1;         ///< on this rank's host
  bool oversubscribed = false;  ///< some host has more workers than cores (the sleeping master is not counted)
};
enum class RankRoles { all_work, one_is_master };
Placement placement(MPI_Comm comm, RankRoles roles = RankRoles::one_is_master);

// Limits of this process's control groups (versions 1 and 2) and their ancestors, as Slurm and containers set them;
// infinity without a limit. Tests replace / and /proc by `root` and `proc`.

double memory_quota(const std::filesystem::path& root = "/", const std::filesystem::path& proc = "/proc");  ///< bytes

/// Processors: the time that the process may compute, over the time that passes.
double cpu_quota(const std::filesystem::path& root = "/", const std::filesystem::path& proc = "/proc");

}  // namespace rodsweep
