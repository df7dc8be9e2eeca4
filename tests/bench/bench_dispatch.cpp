// Null tasks dispatched per second, an upper bound for sweeps of very short tasks: mpirun -n 3 bench_dispatch [tasks].
#include <fmt/format.h>

#include <cstdlib>

#include "runner/dispatch/channel.hpp"
#include "runner/dispatch/master.hpp"
#include "runner/dispatch/worker.hpp"
#include "runner/mpi/mpi_session.hpp"

int main(int argc, char** argv) {
  using namespace rodsweep;
  const MpiSession mpi;
  const std::int64_t tasks = argc > 1 ? std::atoll(argv[1]) : 100000;
  const auto no_signal = [] { return 0; };
  if (mpi.size() < 2) {
    fmt::print(stderr, "bench_dispatch needs at least two ranks: mpirun -n 3 bench_dispatch\n");
    return 2;
  }
  MpiChannel channel(mpi.world());
  if (mpi.rank() > 0) {
    Worker(
        channel,
        [](std::int64_t, const StopRequested&) {
          return TaskResult{TaskOutcome::ok, ""};
        },
        no_signal)
        .run();
    return 0;
  }
  std::vector<PendingTask> pending;
  for (std::int64_t i = 0; i < tasks; ++i) pending.push_back({i, 1.0});
  Console console(false);
  Progress progress(console, {tasks, 0, 0, static_cast<double>(tasks), mpi.size() - 1}, Progress::Clock::now());
  Master master(channel, std::move(pending), progress, no_signal);
  master.run();
  const double seconds = master.dispatch().wall_s;
  fmt::print("dispatch: {} null tasks over {} ranks in {:.3f} s: {:.0f} tasks/s\n", tasks, mpi.size(), seconds,
             static_cast<double>(tasks) / seconds);
  return 0;
}
