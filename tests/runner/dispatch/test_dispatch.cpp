// The master and its workers over a network in memory.
#include <algorithm>
#include <csignal>
#include <map>
#include <memory>
#include <random>

#include "tests/catch.hpp"
#include "tests/runner/dispatch_examples.hpp"

using namespace rodsweep;
using namespace rodsweep::examples;

namespace test_dispatch {

int no_signal() { return 0; }

TaskResult succeed(std::int64_t, const StopRequested&) { return {TaskOutcome::ok, ""}; }

/// Runs the sweep with one worker; returns the tasks in the order of their runs.
std::vector<std::int64_t> order_of(Sweep& sweep) {
  std::vector<std::int64_t> order;
  Worker worker(
      sweep.network[1],
      [&](std::int64_t task, const StopRequested& stop) {
        order.push_back(task);
        return succeed(task, stop);
      },
      no_signal);
  while (sweep.master.step() != Master::Step::finished) worker.step();
  return order;
}

std::vector<std::unique_ptr<Worker>> workers_of(Sweep& sweep, int count, const TaskBody& body) {
  std::vector<std::unique_ptr<Worker>> workers;
  for (int rank = 1; rank <= count; ++rank)
    workers.push_back(std::make_unique<Worker>(sweep.network[rank], body, no_signal));
  return workers;
}

/// Steps master and workers in a random order until the master has finished; then each worker finishes.
void play(Sweep& sweep, std::vector<std::unique_ptr<Worker>>& workers, unsigned seed) {
  std::mt19937 random(seed);
  for (bool finished = false; !finished;) {
    const auto turn = random() % (workers.size() + 1);
    if (turn == 0)
      finished = sweep.master.step() == Master::Step::finished;
    else
      workers[turn - 1]->step();
  }
  for (auto& worker : workers) REQUIRE(worker->step() == Worker::Step::finished);
}

TEST_CASE("tasks are handed out longest first, ties by number") {
  Sweep sweep(1, tasks_of_cost({1, 5, 3, 5, 2}));
  CHECK(order_of(sweep) == std::vector<std::int64_t>{1, 3, 2, 4, 0});
}

TEST_CASE("tasks that lost their workers come last, and again lost ones with nothing beside them") {
  std::vector<PendingTask> tasks = tasks_of_cost({9, 1, 8, 1, 1, 7});
  tasks[0].crashes = 2;
  tasks[2].crashes = 1;
  tasks[5].crashes = 3;
  Sweep sweep(2, tasks);
  std::vector<Inbox> inboxes{Inbox(sweep.network[1]), Inbox(sweep.network[2])};
  std::vector<std::int64_t> order;
  std::map<std::int64_t, Inbox*> running;
  while (sweep.master.step() != Master::Step::finished) {
    for (Inbox& inbox : inboxes)
      for (const std::int64_t task : inbox.assigned()) {
        if (task == 0 || task == 5) CHECK(running.empty());
        CHECK((running.count(0) == 0 && running.count(5) == 0));
        order.push_back(task);
        running[task] = &inbox;
      }
    if (!running.empty()) {  // one report at a time, so that workers get out of step
      const auto last = std::prev(running.end());
      last->second->report(last->first);
      running.erase(last);
    }
  }
  REQUIRE(order.size() == 6);
  CHECK(std::vector<std::int64_t>(order.begin() + 3, order.end()) == std::vector<std::int64_t>{2, 0, 5});
}

TEST_CASE("every task is run exactly once, whatever the order in which ranks get their turns") {
  const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
  std::mt19937 random(seed);
  std::vector<double> costs(300);
  for (double& cost : costs) cost = std::exp(std::normal_distribution<double>()(random));
  Sweep sweep(4, tasks_of_cost(costs));
  std::map<std::int64_t, int> runs;
  const TaskBody body = [&](std::int64_t task, const StopRequested& stop) {
    ++runs[task];
    return succeed(task, stop);
  };
  auto workers = workers_of(sweep, 4, body);
  play(sweep, workers, seed);
  CHECK(runs.size() == 300);
  CHECK(std::all_of(runs.begin(), runs.end(), [](const auto& run) { return run.second == 1; }));
  CHECK(sweep.master.dispatch().left == 0);
  CHECK(sweep.master.dispatch().finished[static_cast<std::size_t>(TaskOutcome::ok)] == 300);
}

TEST_CASE("failed tasks are counted by outcome and the sweep goes on, in any order of turns") {
  const unsigned seed = GENERATE(1u, 2u, 3u);
  Sweep sweep(2, tasks_of_cost(std::vector<double>(30, 1.0)));
  const TaskBody body = [](std::int64_t task, const StopRequested&) -> TaskResult {
    if (task % 10 == 3) return {TaskOutcome::diverged, "joint gap 12 at step 4"};
    if (task == 7) return {TaskOutcome::error, std::string(1000, 'x')};
    return {TaskOutcome::ok, ""};
  };
  auto workers = workers_of(sweep, 2, body);
  play(sweep, workers, seed);
  const Dispatch& dispatch = sweep.master.dispatch();
  CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::ok)] == 26);
  CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::diverged)] == 3);
  CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::error)] == 1);
  REQUIRE(dispatch.failures.size() == 4);
  for (const auto& failure : dispatch.failures)
    CHECK(failure.message == (failure.task == 7 ? std::string(199, 'x') : "joint gap 12 at step 4"));
}

TEST_CASE("without tasks the workers are dismissed at once") {
  Sweep sweep(2, {});
  REQUIRE(sweep.master.step() == Master::Step::finished);
  Worker worker(sweep.network[2], succeed, no_signal);
  CHECK(worker.step() == Worker::Step::finished);
}

TEST_CASE("a report of a task that the worker does not have is a protocol error") {
  Sweep sweep(2, tasks_of_cost({2, 1}));
  sweep.master.step();
  Inbox(sweep.network[1]).report(1);
  CHECK_THROWS_WITH(sweep.master.step(), "rank 1 reports task 1, which is not assigned to it");
}

TEST_CASE("a message of the wrong kind is a protocol error") {
  Sweep sweep(1, tasks_of_cost({1}));
  sweep.network[1].send(0, Finish{});
  CHECK_THROWS_AS(sweep.master.step(), ProtocolError);
}

TEST_CASE("what a worker's body throws ends the worker") {
  Sweep sweep(1, tasks_of_cost({1}));
  Worker worker(
      sweep.network[1],
      [](std::int64_t, const StopRequested&) -> TaskResult { throw std::runtime_error("no space left on device"); },
      no_signal);
  sweep.master.step();
  CHECK_THROWS_WITH(worker.step(), "no space left on device");
}

TEST_CASE("the message of a task that is ok is a warning, kept once") {
  Sweep sweep(1, {{0, 1}, {1, 1}, {2, 1}});
  const TaskBody body = [](std::int64_t task, const StopRequested&) {
    return TaskResult{TaskOutcome::ok, task == 1 ? "" : "two answers"};
  };
  Worker worker(sweep.network[1], body, no_signal);
  while (sweep.master.step() != Master::Step::finished) worker.step();
  const Dispatch& dispatch = sweep.master.dispatch();
  CHECK(dispatch.failures.empty());
  REQUIRE(dispatch.warnings.size() == 1);
  CHECK(dispatch.warnings.front().message == "two answers");
}

}  // namespace test_dispatch
