// Workers that time out: their tasks are reassigned, and the master never waits for them.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <utility>

#include "tests/catch.hpp"
#include "tests/runner/dispatch_examples.hpp"

using namespace rodsweep;
using namespace rodsweep::examples;

namespace test_dispatch_lost {

using Seconds = std::chrono::duration<double>;
constexpr Seconds timeout{4};

void alive(Inbox& worker) { worker.channel->send(0, Alive{}); }

/// Advances time until silent workers are lost; the others send heartbeats.
template <class... Workers>
void time_out(Sweep& sweep, Workers&... others) {
  for (int quarter = 0; quarter < 6; ++quarter) {
    test::HandClock::pass(timeout / 4);
    (alive(others), ...);
    sweep.master.step();
  }
}

/// Lets this worker run the remaining tasks; returns their order.
std::vector<std::int64_t> run_rest(Sweep& sweep, Inbox& worker) {
  std::vector<std::int64_t> order;
  for (bool finished = false; !finished;) {
    for (const std::int64_t task : worker.assigned()) order.push_back(task), worker.report(task);
    finished = sweep.master.step() == Master::Step::finished;
  }
  return order;
}

TEST_CASE("a silent worker's task goes to another, the one in its hand as if nothing had been") {
  std::vector<int> lost;
  Callbacks callbacks;
  callbacks.lost = [&](int rank) { lost.push_back(rank); };
  Sweep sweep(2, tasks_of_cost(std::vector<double>(12, 1.0)), {timeout, timeout}, callbacks);
  Inbox silent(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  const auto held = silent.assigned();
  REQUIRE(held.size() == 2);
  time_out(sweep, other);
  CHECK(lost == std::vector<int>{1});

  const std::vector<std::int64_t> order = run_rest(sweep, other);
  REQUIRE(order.size() == 12);
  CHECK(order.back() == held[0]);  // it may be the cause, so it comes last
  CHECK(order[1] != held[1]);
  CHECK(std::count(order.begin(), order.end(), held[1]) == 1);
  CHECK(silent.assigned().empty());
  CHECK(silent.finishes == 0);  // the rank may be dead
  CHECK(other.assigned().empty());
  CHECK((other.finishes == 1 && other.ranks_lost));
  CHECK(sweep.master.dispatch().ranks_lost);
  CHECK(sweep.master.dispatch().left == 0);
}

TEST_CASE("a lost worker that is heard again is ignored, and dismissed with the others") {
  Sweep sweep(2, tasks_of_cost({5, 4, 3}), {timeout, timeout});
  Inbox slow(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  CHECK(slow.assigned() == std::vector<std::int64_t>{0});
  CHECK(other.assigned() == std::vector<std::int64_t>{1});
  time_out(sweep, other);
  slow.report(0);  // bit for bit what another worker will write
  other.report(1);
  sweep.master.step();
  CHECK(slow.assigned().empty());
  CHECK(run_rest(sweep, other) == std::vector<std::int64_t>{2, 0});
  CHECK(slow.assigned().empty());
  CHECK((slow.finishes == 1 && slow.ranks_lost));
  CHECK(sweep.master.dispatch().finished[static_cast<std::size_t>(TaskOutcome::ok)] == 3);
  CHECK(sweep.master.dispatch().left == 0);
}

TEST_CASE("a worker that is dismissed while it works abandons its tasks") {
  MemoryNetwork network(2);
  int runs = 0;
  Worker worker(
      network[1],
      [&](std::int64_t, const StopRequested& stop) -> TaskResult {
        ++runs;
        network[0].send(1, Finish{true});
        test::HandClock::pass(Seconds(1));  // so that the worker reads its messages
        return stop() ? TaskResult{} : TaskResult{TaskOutcome::ok, ""};
      },
      [] { return 0; }, {}, {}, test::HandClock::now);
  for (int i = 0; i < 2; ++i) network[0].send(1, Assign{0});
  CHECK(worker.run());
  CHECK(runs == 1);
}

TEST_CASE("what a lost worker finished and had not brought to disk is done again") {
  Sweep sweep(2, tasks_of_cost({5, 4, 3, 2}), {timeout, timeout});
  Inbox lost(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  lost.report(lost.assigned().at(0));
  sweep.master.step();
  CHECK(lost.assigned() == std::vector<std::int64_t>{2});
  lost.report(2, TaskOutcome::torn);
  sweep.master.step();
  CHECK(lost.assigned() == std::vector<std::int64_t>{3});
  lost.channel->send(0, Alive{1});  // task 0 is on disk, task 2 is not
  CHECK(other.assigned() == std::vector<std::int64_t>{1});
  other.report(1);
  time_out(sweep, other);
  CHECK(run_rest(sweep, other) == std::vector<std::int64_t>{2, 3});
  CHECK(sweep.master.dispatch().finished[static_cast<std::size_t>(TaskOutcome::ok)] == 4);
  CHECK(sweep.master.dispatch().finished[static_cast<std::size_t>(TaskOutcome::torn)] == 0);
  CHECK(sweep.master.dispatch().failures.empty());
  CHECK(sweep.master.dispatch().left == 0);
}

TEST_CASE("a task that loses as many workers as are allowed is marked as crashed, and its last try runs alone") {
  const int most = GENERATE(1, 3);
  std::vector<std::int64_t> crashed;
  Callbacks callbacks;
  callbacks.crashed = [&](std::int64_t task, int crashes) {
    crashed.push_back(task);
    return "begun " + std::to_string(crashes) + " times";
  };
  Timeouts timeouts{timeout, timeout};
  timeouts.max_crashes = most;
  Sweep sweep(4, tasks_of_cost({9, 2, 2, 2, 2, 2, 2}), timeouts, callbacks);
  std::vector<Inbox> inboxes;
  for (int rank = 1; rank <= 4; ++rank) inboxes.emplace_back(sweep.network[rank]);
  std::vector<bool> dead(4, false);
  int in_flight_beside_last = -1;
  for (bool finished = false; !finished;) {
    std::vector<std::pair<std::size_t, std::int64_t>> running;
    for (std::size_t i = 0; i < 4; ++i)
      for (const std::int64_t task : inboxes[i].assigned()) running.emplace_back(i, task);
    for (const auto& [i, task] : running)
      if (task == 0) dead[i] = true, in_flight_beside_last = static_cast<int>(running.size()) - 1;
    for (const auto& [i, task] : running)
      if (!dead[i]) inboxes[i].report(task);
    for (std::size_t i = 0; i < 4; ++i)
      if (!dead[i]) alive(inboxes[i]);
    test::HandClock::pass(timeout / 8);
    finished = sweep.master.step() == Master::Step::finished;
  }
  CHECK(crashed == std::vector<std::int64_t>{0});
  CHECK(std::count(dead.begin(), dead.end(), true) == most);
  if (most > 1) CHECK(in_flight_beside_last == 0);
  const Dispatch& dispatch = sweep.master.dispatch();
  CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::ok)] == 6);
  CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::crashed)] == 1);
  REQUIRE(dispatch.failures.size() == 1);
  CHECK(dispatch.failures[0].message == "begun " + std::to_string(most) + " times");
}

TEST_CASE("when no worker is left, the sweep ends with what is done") {
  Sweep sweep(2, tasks_of_cost({3, 2, 1, 1}), {timeout, timeout});
  sweep.master.step();
  Inbox(sweep.network[1]).report(0);
  sweep.network[1].send(0, Alive{1});
  int steps = 0;
  for (; sweep.master.step() != Master::Step::finished; ++steps) test::HandClock::pass(timeout / 4);
  CHECK(steps == 5);
  CHECK(sweep.master.dispatch().left == 3);
  CHECK(sweep.master.dispatch().signal == 0);
  CHECK(sweep.master.dispatch().ranks_lost);
}

TEST_CASE("a worker that does not give its task up in good time does not hold up a stop") {
  Sweep sweep(2, tasks_of_cost({3, 2}), {Seconds(1e9), timeout});
  Inbox deaf(sweep.network[1]), good(sweep.network[2]);
  sweep.master.step();
  deaf.assigned();
  for (const std::int64_t task : good.assigned()) good.report(task, TaskOutcome::pending);
  sweep.signal = SIGTERM;
  CHECK(sweep.master.step() != Master::Step::finished);
  test::HandClock::pass(1.5 * timeout);
  CHECK(sweep.master.step() == Master::Step::finished);
  good.assigned();
  CHECK((good.stops == 1 && good.ranks_lost));
  CHECK(sweep.master.dispatch().signal == SIGTERM);
  CHECK(sweep.master.dispatch().left == 2);
}

TEST_CASE("a master that was away itself loses nobody") {
  Sweep sweep(1, tasks_of_cost({1}), {timeout, timeout});
  sweep.master.step();
  test::HandClock::pass(3 * timeout);
  CHECK(sweep.master.step() == Master::Step::waited);
  Inbox worker(sweep.network[1]);
  for (const std::int64_t task : worker.assigned()) worker.report(task);
  CHECK(sweep.master.step() == Master::Step::finished);
  CHECK_FALSE(sweep.master.dispatch().ranks_lost);
}

}  // namespace test_dispatch_lost
