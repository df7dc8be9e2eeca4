// Workers that fall silent: their tasks go to others, they may come back, and nobody waits for ever.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>

#include "tests/runner/dispatch_examples.hpp"

using namespace rodsweep;
using namespace rodsweep::examples;

namespace {

using Seconds = std::chrono::duration<double>;
constexpr Seconds patience{0.04};

void alive(Inbox& worker) { worker.channel->send(0, Alive{}); }

/// Lets so much time pass that whoever says nothing is lost, with one word of the others in between.
template <class... Workers>
void wait_in_vain(Sweep& sweep, Workers&... others) {
  for (int quarter = 0; quarter < 5; ++quarter) {
    std::this_thread::sleep_for(patience / 4);
    (alive(others), ...);
    sweep.master.step();
  }
}

}  // namespace

TEST_CASE("a silent worker's task goes to another, the one in its hand as if nothing had been") {
  std::vector<int> lost;
  Notices notices;
  notices.lost = [&](int rank) { lost.push_back(rank); };
  Sweep sweep(2, tasks_of_cost(std::vector<double>(12, 1.0)), {patience, patience}, notices);
  Inbox silent(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  const auto held = silent.assigned();
  REQUIRE(held.size() == 2);
  wait_in_vain(sweep, other);
  CHECK(lost == std::vector<int>{1});

  std::vector<std::int64_t> order;
  for (bool finished = false; !finished;) {
    for (const std::int64_t task : other.assigned()) order.push_back(task), other.report(task);
    finished = sweep.master.step() == Master::Step::finished;
  }
  REQUIRE(order.size() == 12);
  CHECK(order.back() == held[0]);  // it may be to blame: last
  CHECK(order[1] != held[1]);
  CHECK(std::count(order.begin(), order.end(), held[1]) == 1);
  CHECK(silent.assigned().empty());
  CHECK((silent.drops == 0 && silent.finishes == 0));  // nothing is sent to who may be dead
  CHECK(other.assigned().empty());
  CHECK((other.finishes == 1 && other.apart));
  CHECK(sweep.master.dispatch().apart);
  CHECK(sweep.master.dispatch().left == 0);
}

TEST_CASE("a worker that comes back gives up what it had and gets more") {
  int found = 0;
  Notices notices;
  notices.found_again = [&](int rank) { found = rank; };
  Sweep sweep(1, tasks_of_cost({3, 2, 1}), {patience, patience}, notices);
  std::vector<std::int64_t> begun;
  bool hangs = true;
  Worker worker(
      sweep.network[1],
      [&](std::int64_t task, const StopRequested& stop) -> TaskResult {
        begun.push_back(task);
        if (std::exchange(hangs, false)) {
          const auto until = std::chrono::steady_clock::now() + 2 * patience;
          while (std::chrono::steady_clock::now() < until) {
            std::this_thread::sleep_for(patience / 8);
            sweep.master.step();
          }
          for (int looks = 0; looks < 1000 && !stop(); ++looks) {  // it is heard, and told
            std::this_thread::sleep_for(patience / 8);
            sweep.master.step();
          }
          return {};
        }
        return {TaskOutcome::ok, ""};
      },
      [] { return 0; });
  worker.set_beat(patience / 4, [] { return 0; });
  while (sweep.master.step() != Master::Step::finished) worker.step();
  CHECK(found == 1);
  CHECK(begun == std::vector<std::int64_t>{0, 1, 2, 0});
  CHECK_FALSE(sweep.master.dispatch().apart);
  CHECK(sweep.master.dispatch().left == 0);
  CHECK(worker.run() == false);
}

TEST_CASE("what a lost worker finished after all is not done again") {
  Sweep sweep(2, tasks_of_cost({5, 4, 3}), {patience, patience});
  Inbox slow(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  CHECK(slow.assigned() == std::vector<std::int64_t>{0});
  CHECK(other.assigned() == std::vector<std::int64_t>{1});
  wait_in_vain(sweep, other);
  slow.report(0);
  other.report(1);
  sweep.master.step();
  CHECK(other.assigned() == std::vector<std::int64_t>{2});
  slow.report(2);  // nonsense, but of a lost rank: others have it
  other.report(2);
  CHECK(sweep.master.step() == Master::Step::finished);
  CHECK(sweep.master.dispatch().finished[static_cast<std::size_t>(TaskOutcome::ok)] == 3);
  CHECK(sweep.master.dispatch().left == 0);
}

TEST_CASE("what a lost worker finished and had not brought to disk is done again") {
  Sweep sweep(2, tasks_of_cost({5, 4, 3, 2}), {patience, patience});
  Inbox lost(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  lost.report(lost.assigned().at(0));
  sweep.master.step();
  CHECK(lost.assigned() == std::vector<std::int64_t>{2});
  lost.report(2, TaskOutcome::torn);
  sweep.master.step();
  CHECK(lost.assigned() == std::vector<std::int64_t>{3});
  lost.channel->send(0, Alive{1});  // task 0 is safe, and 2 is not
  CHECK(other.assigned() == std::vector<std::int64_t>{1});
  other.report(1);
  wait_in_vain(sweep, other);
  std::vector<std::int64_t> again;
  for (bool finished = false; !finished;) {
    for (const std::int64_t task : other.assigned()) again.push_back(task), other.report(task);
    finished = sweep.master.step() == Master::Step::finished;
  }
  CHECK(again == std::vector<std::int64_t>{2, 3});
  CHECK(sweep.master.dispatch().finished[static_cast<std::size_t>(TaskOutcome::ok)] == 4);
  CHECK(sweep.master.dispatch().finished[static_cast<std::size_t>(TaskOutcome::torn)] == 0);
  CHECK(sweep.master.dispatch().failures.empty());
  CHECK(sweep.master.dispatch().left == 0);
}

TEST_CASE("a task may be given up with the first worker that it loses") {
  std::vector<std::int64_t> given_up;
  Notices notices;
  notices.give_up = [&](std::int64_t task, int) {
    given_up.push_back(task);
    return "gone";
  };
  Patience once{patience, patience};
  once.attempts = 1;
  Sweep sweep(2, tasks_of_cost({9, 2}), once, notices);
  Inbox dead(sweep.network[1]), good(sweep.network[2]);
  for (bool finished = false; !finished;) {
    dead.assigned();
    for (const std::int64_t task : good.assigned()) good.report(task);
    alive(good);
    std::this_thread::sleep_for(patience / 8);
    finished = sweep.master.step() == Master::Step::finished;
  }
  CHECK(given_up == std::vector<std::int64_t>{0});
  CHECK(sweep.master.dispatch().left == 0);
}

TEST_CASE("a task that loses three workers is given up, the last of them with nothing beside it") {
  std::vector<std::int64_t> given_up;
  Notices notices;
  notices.give_up = [&](std::int64_t task, int lost) {
    given_up.push_back(task);
    return "begun " + std::to_string(lost) + " times";
  };
  Sweep sweep(4, tasks_of_cost({9, 2, 2, 2, 2, 2, 2}), {patience, patience}, notices);
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
    std::this_thread::sleep_for(patience / 8);
    finished = sweep.master.step() == Master::Step::finished;
  }
  CHECK(given_up == std::vector<std::int64_t>{0});
  CHECK(std::count(dead.begin(), dead.end(), true) == 3);
  CHECK(in_flight_beside_last == 0);
  const Dispatch& dispatch = sweep.master.dispatch();
  CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::ok)] == 6);
  CHECK(dispatch.finished[static_cast<std::size_t>(TaskOutcome::crashed)] == 1);
  REQUIRE(dispatch.failures.size() == 1);
  CHECK(dispatch.failures[0].message == "begun 3 times");
}

TEST_CASE("when nobody is left for as long again, the sweep ends with what is done") {
  Sweep sweep(2, tasks_of_cost({3, 2, 1, 1}), {patience, patience});
  sweep.master.step();
  Inbox(sweep.network[1]).report(0);
  sweep.network[1].send(0, Alive{1});
  const auto begin = std::chrono::steady_clock::now();
  while (sweep.master.step() != Master::Step::finished) std::this_thread::sleep_for(patience / 8);
  CHECK(std::chrono::steady_clock::now() - begin > patience);
  CHECK(sweep.master.dispatch().left == 3);
  CHECK(sweep.master.dispatch().signal == 0);
  CHECK(sweep.master.dispatch().apart);
}

TEST_CASE("a worker that does not give its task up in good time does not hold up a stop") {
  Sweep sweep(2, tasks_of_cost({3, 2}), {Seconds(1e9), patience});
  Inbox deaf(sweep.network[1]), good(sweep.network[2]);
  sweep.master.step();
  deaf.assigned();
  for (const std::int64_t task : good.assigned()) good.report(task, TaskOutcome::pending);
  sweep.signal = SIGTERM;
  CHECK(sweep.master.step() != Master::Step::finished);
  std::this_thread::sleep_for(1.5 * patience);
  CHECK(sweep.master.step() == Master::Step::finished);
  good.assigned();
  CHECK((good.stops == 1 && good.apart));
  CHECK(sweep.master.dispatch().signal == SIGTERM);
  CHECK(sweep.master.dispatch().left == 2);
}

TEST_CASE("a master that was away itself loses nobody") {
  Sweep sweep(1, tasks_of_cost({1}), {patience, patience});
  sweep.master.step();
  std::this_thread::sleep_for(3 * patience);
  CHECK(sweep.master.step() == Master::Step::waited);
  Inbox worker(sweep.network[1]);
  for (const std::int64_t task : worker.assigned()) worker.report(task);
  CHECK(sweep.master.step() == Master::Step::finished);
  CHECK_FALSE(sweep.master.dispatch().apart);
}

TEST_CASE("with a time limit no task is begun that would not end before it, and what runs then is abandoned") {
  Patience limited;
  limited.time = TimeBudget(Seconds(0.3), Seconds(0.3));
  // A unit of cost turns out to take a second: the long tasks cannot be done, the short ones can.
  Sweep sweep(1, {{0, 0.02}, {1, 50}, {2, 0.001}, {3, 40}, {4, 0.001}}, limited);
  std::vector<std::int64_t> begun;
  Worker worker(
      sweep.network[1],
      [&](std::int64_t task, const StopRequested& stop) -> TaskResult {
        begun.push_back(task);
        if (task == 1) return {TaskOutcome::error, "at once"};  // nothing is known of costs before
        std::this_thread::sleep_for(Seconds(0.02));
        return stop() ? TaskResult{} : TaskResult{TaskOutcome::ok, ""};
      },
      [] { return 0; });
  while (sweep.master.step() != Master::Step::finished) worker.step();
  CHECK(sweep.master.dispatch().left == 0);  // the first task told that costs mean nothing
  CHECK(begun == std::vector<std::int64_t>{1, 3, 0, 2, 4});

  Sweep slow(1, {{0, 0.02}, {1, 50}, {2, 0.001}, {3, 40}, {4, 0.001}}, limited);
  Inbox inbox(slow.network[1]);
  slow.master.step();
  REQUIRE(inbox.assigned() == std::vector<std::int64_t>{1});
  slow.network[1].send(0, Report(1, TaskOutcome::ok, 50, ""));  // a second for each unit of cost
  std::vector<std::int64_t> order;
  while (slow.master.step() != Master::Step::finished)
    for (const std::int64_t task : inbox.assigned())
      order.push_back(task), slow.network[1].send(0, Report(task, TaskOutcome::ok, 0.001, ""));
  CHECK(order == std::vector<std::int64_t>{0, 2, 4});
  CHECK(slow.master.dispatch().left == 1);
  CHECK(slow.master.dispatch().late);
  CHECK_FALSE(slow.master.dispatch().apart);
  REQUIRE(slow.master.dispatch().too_long);  // at forty seconds of three tenths
  CHECK(slow.master.dispatch().too_long->index == 3);
  CHECK(slow.master.dispatch().too_long_s > 30);

  Sweep endless(1, {{0, 1}}, limited);
  Inbox runs(endless.network[1]);
  endless.master.step();
  REQUIRE(runs.assigned().size() == 1);
  std::this_thread::sleep_for(1.2 * limited.time.whole());
  endless.master.step();
  CHECK(runs.assigned().empty());
  CHECK(runs.stops == 1);
  endless.network[1].send(0, Report(0, TaskOutcome::pending, 0.1, ""));
  while (endless.master.step() != Master::Step::finished) {
  }
  CHECK(endless.master.dispatch().late);
  CHECK(endless.master.dispatch().left == 1);
  CHECK_FALSE(endless.master.dispatch().too_long);  // it may be done by the next start: nothing is known
}
