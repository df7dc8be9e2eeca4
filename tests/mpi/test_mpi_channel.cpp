// Dispatch over MPI, with the same master and workers as in memory. Runs on several numbers of ranks.
#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "runner/dispatch/channel.hpp"
#include "runner/dispatch/master.hpp"
#include "runner/dispatch/worker.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "tests/catch.hpp"
#include "tests/mpi/world.hpp"

using namespace rodsweep;

namespace {

int frees = 0;  ///< calls of MPI_Comm_free on this rank

}  // namespace

/// Replaces MPI's function, which remains available as PMPI_Comm_free.
extern "C" int MPI_Comm_free(MPI_Comm* comm) {
  ++frees;
  return PMPI_Comm_free(comm);
}

namespace {

/// Runs `tasks` tasks; `before` is called before each. Returns on rank 0 their outcomes, on all ranks how often each
/// task ran on any rank.
std::pair<Dispatch, std::vector<int>> run(
    int tasks, const std::function<int()>& signal,
    const std::function<void(const StopRequested&)>& before = [](auto&) {}) {
  MpiChannel channel(MPI_COMM_WORLD);
  std::vector<int> here(tasks, 0), everywhere(tasks, 0);
  Dispatch dispatch;
  if (own_rank() > 0) {
    const TaskBody body = [&](std::int64_t task, const StopRequested& stop) -> TaskResult {
      before(stop);
      if (stop()) return {};
      ++here[task];
      if (task % 7 == 3) return {TaskOutcome::diverged, "as told"};
      return {TaskOutcome::ok, ""};
    };
    Worker(channel, body, signal).run();
  } else {
    std::vector<PendingTask> pending;
    for (int i = 0; i < tasks; ++i) pending.push_back({i, 1.0 + i % 5});
    Console console(false);
    Progress progress(console, {tasks, 0, 0, 3.0 * tasks, std::max(1, rank_count() - 1)}, Progress::Clock::now());
    Master master(channel, std::move(pending), progress, [] { return 0; });
    master.run();
    dispatch = master.dispatch();
  }
  MPI_Allreduce(here.data(), everywhere.data(), tasks, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  return {dispatch, everywhere};
}

}  // namespace

TEST_CASE("over MPI every task is run exactly once and every outcome arrives") {
  if (rank_count() == 1) return;
  const auto [dispatch, runs] = run(2000, [] { return 0; });
  CHECK(std::all_of(runs.begin(), runs.end(), [](int n) { return n == 1; }));
  if (own_rank() == 0) {
    CHECK(dispatch.left == 0);
    CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::ok)] == 1714);
    CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::diverged)] == 286);
  }
}

TEST_CASE("over MPI a signal to one worker stops all, and no task is lost or counted twice") {
  if (rank_count() == 1) return;
  // The others wait in their 10th task, so that some tasks are left when rank 1 hears of the signal, however slow it is.
  int asked = 0, begun = 0;
  const auto [dispatch, runs] = run(
      2000, [&] { return own_rank() == 1 && ++asked > 100 ? 15 : 0; },
      [&](const StopRequested& stop) {
        if (own_rank() > 1 && ++begun >= 10)
          while (!stop()) std::this_thread::yield();
      });
  const int finished = std::accumulate(runs.begin(), runs.end(), 0);
  CHECK(std::all_of(runs.begin(), runs.end(), [](int n) { return n <= 1; }));
  if (own_rank() == 0) {
    CHECK(dispatch.signal == 15);
    CHECK(dispatch.left == 2000 - finished);
    CHECK(dispatch.left > 0);
  }
}

TEST_CASE("a channel's communicator is freed by all ranks together, so not by one that an exception unwinds") {
  const int before = frees;
  { const MpiChannel channel(MPI_COMM_WORLD); }
  CHECK(frees == before + 1);
  const auto unwound = [] {
    const MpiChannel channel(MPI_COMM_WORLD);
    throw std::runtime_error("the disk is full");
  };
  CHECK_THROWS(unwound());
  CHECK(frees == before + 1);

  // The channel is created during unwinding: the exception is not its own.
  struct Late {
    ~Late() { const MpiChannel channel(MPI_COMM_WORLD); }
  };
  const auto unwound_later = [] {
    const Late late;
    throw std::runtime_error("the disk is full");
  };
  CHECK_THROWS(unwound_later());
  CHECK(frees == before + 2);
}
