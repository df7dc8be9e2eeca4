// Signals and the time limit: running tasks are cancelled, held tasks come back, none is assigned, all workers leave.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <optional>

#include "runner/dispatch/stop_signal.hpp"
#include "solver/plugin/user_call.hpp"
#include "tests/catch.hpp"
#include "tests/runner/dispatch_examples.hpp"

using namespace rodsweep;
using namespace rodsweep::examples;

TEST_CASE("a signal to the master stops the sweep, and every task is accounted for") {
  std::vector<int> told;
  Callbacks callbacks;
  callbacks.stopping = [&](int signal) { told.push_back(signal); };
  Sweep sweep(2, tasks_of_cost(std::vector<double>(100, 1.0)), {}, callbacks);
  Inbox one(sweep.network[1]), two(sweep.network[2]);
  sweep.master.step();
  const auto ones = one.assigned(), twos = two.assigned();
  REQUIRE(ones.size() == 2);
  REQUIRE(twos.size() == 2);

  sweep.signal = SIGTERM;
  one.report(ones[0]);  // finished just before the stop
  CHECK(sweep.master.step() == Master::Step::worked);
  CHECK(one.assigned().empty());
  CHECK(two.assigned().empty());
  CHECK(one.stops == 1);
  CHECK(two.stops == 1);
  CHECK(told == std::vector<int>{SIGTERM});  // at once: the process may be killed before the workers reply

  one.report(ones[1], TaskOutcome::pending);
  two.report(twos[0], TaskOutcome::pending);
  CHECK(sweep.master.step() == Master::Step::worked);
  two.report(twos[1], TaskOutcome::pending);
  CHECK(sweep.master.step() == Master::Step::finished);
  one.assigned();
  CHECK(one.finishes == 1);
  CHECK(one.stops == 1);
  CHECK(told.size() == 1);
  CHECK(sweep.master.dispatch().signal == SIGTERM);
  CHECK(sweep.master.dispatch().left == 99);
}

TEST_CASE("a running task is told between two time steps that the sweep stops") {
  Sweep sweep(1, tasks_of_cost({1, 1, 1}));
  int steps = 0;
  Worker worker(
      sweep.network[1],
      [&](std::int64_t, const StopRequested& stop) -> TaskResult {
        for (; !stop(); ++steps)
          if (steps == 3) sweep.network[0].send(1, Stop{});
        return {};
      },
      [] { return 0; });
  sweep.master.step();
  worker.step();
  CHECK(steps >= 3);
  sweep.signal = SIGINT;
  CHECK(sweep.master.step() == Master::Step::finished);
  CHECK(sweep.master.dispatch().left == 3);
}

TEST_CASE("a lone rank keeps its master alive while a task runs") {
  Sweep sweep(1, tasks_of_cost({1, 1}));
  int steps = 0;
  Worker worker(
      sweep.network[1],
      [&](std::int64_t, const StopRequested& stop) -> TaskResult {
        sweep.signal = SIGTERM;
        while (!stop()) ++steps;
        return {};
      },
      [] { return 0; }, [&] { sweep.master.step(); });
  while (sweep.master.step() != Master::Step::finished) worker.step();
  CHECK(sweep.master.dispatch().left == 2);
}

TEST_CASE("at the time limit no task begins any more, and running ones are abandoned") {
  Timeouts limited;
  limited.time_limit = limited.time_left = Timeouts::Seconds(10);
  Sweep sweep(1, tasks_of_cost({3, 2, 1}), limited);
  Inbox worker(sweep.network[1]);
  sweep.master.step();
  REQUIRE(worker.assigned() == std::vector<std::int64_t>{0});
  test::HandClock::pass(Timeouts::Seconds(9));
  worker.report(0);
  sweep.master.step();
  REQUIRE(worker.assigned() == std::vector<std::int64_t>{1});
  test::HandClock::pass(Timeouts::Seconds(2));
  sweep.master.step();
  CHECK(worker.assigned().empty());
  CHECK(worker.stops == 1);
  worker.report(1, TaskOutcome::pending);
  CHECK(sweep.master.step() == Master::Step::finished);
  CHECK(sweep.master.dispatch().late);
  CHECK(sweep.master.dispatch().left == 2);
}

TEST_CASE("a run whose start took the time limit tries the cheapest task, for at most the limit") {
  Timeouts limited;
  limited.time_limit = Timeouts::Seconds(10);
  limited.time_left = Timeouts::Seconds(-2);
  std::vector<PendingTask> tasks = tasks_of_cost({40, 2, 3, 1});
  tasks[3].crashes = 1;
  const bool ends = GENERATE(true, false);
  Sweep sweep(2, tasks, limited);
  Inbox one(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  REQUIRE(one.assigned() == std::vector<std::int64_t>{1});
  test::HandClock::pass(Timeouts::Seconds(9));
  sweep.master.step();
  one.assigned();
  CHECK(one.stops == 0);
  if (!ends) {
    test::HandClock::pass(Timeouts::Seconds(2));
    sweep.master.step();
    one.assigned();
    CHECK(one.stops == 1);
  }
  one.report(1, ends ? TaskOutcome::ok : TaskOutcome::pending);
  CHECK(sweep.master.step() == Master::Step::finished);
  CHECK(one.assigned().empty());
  CHECK(other.assigned().empty());
  CHECK(sweep.master.dispatch().late);
  CHECK(sweep.master.dispatch().left == (ends ? 3 : 4));
}

TEST_CASE("signals of all schedulers are noted, a second one changes nothing, and the old handler returns") {
  for (const int number : {SIGTERM, SIGINT, SIGUSR1, SIGUSR2, SIGXCPU, SIGHUP}) {
    const auto before = std::signal(number, SIG_DFL);
    {
      const StopSignal signal;
      CHECK(signal.received() == 0);
      raise(number);
      CHECK(signal.received() == number);
      raise(number == SIGTERM ? SIGINT : SIGTERM);
      CHECK(signal.received() == number);
    }
    CHECK(std::signal(number, before) == SIG_DFL);
  }
  const auto before = std::signal(SIGHUP, SIG_IGN);
  {
    const StopSignal signal;
    raise(SIGHUP);
    CHECK(signal.received() == 0);  // a hang-up that nohup ignores stays ignored
  }
  CHECK(std::signal(SIGHUP, before) == SIG_IGN);
}

/// Calls `run` in a child process.
template <class Run>
pid_t forked(const Run& run) {
  const pid_t child = fork();
  if (child == 0) {
    run();
    _exit(0);
  }
  return child;
}

/// The signal that ends it; 0 if it ends otherwise.
int ended_by(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

TEST_CASE("a second signal ends a process that stays in a user's code for a second") {
  const auto twice = [](bool in_user_code, unsigned seconds) {
    return forked([&] {
      const StopSignal signal;
      std::optional<UserCall> call;
      if (in_user_code) call.emplace("mine.py");
      raise(SIGTERM);
      sleep(seconds);
      raise(SIGINT);
    });
  };
  const pid_t stuck = twice(true, 2), at_once = twice(true, 0), elsewhere = twice(false, 2);
  CHECK(ended_by(stuck) == SIGINT);
  CHECK(ended_by(at_once) == 0);  // a launcher may send one signal twice
  CHECK(ended_by(elsewhere) == 0);
}

TEST_CASE("a process that was forked ends by the signal that its parent only notes") {
  const StopSignal signal;
  CHECK(ended_by(forked([] { raise(SIGTERM); })) == SIGTERM);
  CHECK(signal.received() == 0);
}

TEST_CASE("of a signal that mpirun sent it is said that Ctrl-C may have been the reason") {
  CHECK(signal_cause(SIGUSR1) == "SIGUSR1");
  CHECK(signal_cause(SIGINT) == "Ctrl-C (SIGINT)");
  const auto is_cause_of_sigterm = [](bool from_parent, bool under_mpirun, const char* cause) {
    int ready[2];
    REQUIRE(pipe(ready) == 0);
    const pid_t child = forked([&] {
      if (under_mpirun) setenv("OMPI_COMM_WORLD_RANK", "0", 1);
      const StopSignal signal;
      if (write(ready[1], "", 1) != 1) _exit(1);
      if (!from_parent) raise(SIGTERM);
      while (signal.received() == 0) usleep(1000);
      _exit(signal_cause(signal.received()) != cause);
    });
    char byte = 0;
    REQUIRE(read(ready[0], &byte, 1) == 1);
    if (from_parent) kill(child, SIGTERM);
    int status = 1;
    waitpid(child, &status, 0);
    for (const int end : ready) close(end);
    return status == 0;
  };
  CHECK(is_cause_of_sigterm(true, true, "mpirun (SIGTERM), after Ctrl-C, a signal or the loss of a rank"));
  CHECK(is_cause_of_sigterm(false, true, "SIGTERM"));
  CHECK(is_cause_of_sigterm(true, false, "SIGTERM"));
}
