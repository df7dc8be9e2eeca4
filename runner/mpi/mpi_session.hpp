// MPI's lifetime and the few collective operations that set a sweep up. Exactly one session per process, in main():
// whatever uses MPI, PETSc or the results file is destroyed before it.
//
// Errors come back as codes and are thrown as MpiError with the name of the call; nothing here aborts.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace rodsweep {

/// A failing MPI call: its name and MPI's own text.
class MpiError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Another rank (or this one) could not do its part of something that all must do. what() is the same on every rank.
class CollectiveError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void check_mpi(int code, const char* call);

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

/// Rank 0's text on every rank.
std::string broadcast(std::string text, MPI_Comm comm);
int broadcast(int value, MPI_Comm comm);
void broadcast(void* data, std::size_t bytes, MPI_Comm comm);

/// The least of all ranks' values, on every rank.
double least(double value, MPI_Comm comm);

/// Rank 0's values, on every rank as many.
template <class T>
void broadcast(std::vector<T>& values, MPI_Comm comm) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::uint64_t size = values.size();
  broadcast(&size, sizeof size, comm);
  values.resize(size);
  broadcast(values.data(), size * sizeof(T), comm);
}

/// The short text of every rank, by rank, on every rank; cut after 255 bytes.
std::vector<std::string> everywhere(const std::string& text, MPI_Comm comm);

/// Does `part` on every rank. If it throws anywhere, every rank throws a CollectiveError with the message of the lowest
/// rank at fault (and that rank's number, if it is not 0), so that an error is reported once and nobody waits for it.
void collectively(MPI_Comm comm, const std::function<void()>& part);

/// The same, returning what `part` makes.
template <class Part, class Made = std::invoke_result_t<Part>, class = std::enable_if_t<!std::is_void_v<Made>>>
Made collectively(MPI_Comm comm, const Part& part) {
  std::optional<Made> made;
  collectively(comm, std::function<void()>([&] { made.emplace(part()); }));
  return std::move(*made);
}

/// Rank 0 does `part` for all; if it throws, every rank throws a CollectiveError with its message. Without ranks, this
/// process does it.
void by_rank_0(const std::optional<MPI_Comm>& ranks, const std::function<void()>& part);

/// The ranks beside the cores that they may run on (their affinity masks put together), host by host.
struct Placement {
  int workers = 1;              ///< ranks that compute: all, or in a sweep all but the master, or the one rank
  int cores = 1;                ///< of all hosts
  int threads = 1;              ///< this rank's share of its host's cores, at least one
  int host_workers = 1;         ///< of this rank's host
  bool oversubscribed = false;  ///< on some host more workers than cores; the master sleeps and is not counted
};
enum class RankRoles { all_work, one_is_master };
Placement placement(MPI_Comm comm, RankRoles roles = RankRoles::one_is_master);

}  // namespace rodsweep
