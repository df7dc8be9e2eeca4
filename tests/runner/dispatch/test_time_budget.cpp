// Tasks that fit into the time limit of a start, by the known pace and by failed attempts.
#include <catch2/catch.hpp>

#include "runner/dispatch/time_budget.hpp"
#include "tests/runner/dispatch_examples.hpp"

using namespace rodsweep;
using namespace rodsweep::examples;

namespace test_time_budget {

using Seconds = TimeBudget::Seconds;

PendingTask of_cost(double cost, double tried_s = 0) {
  PendingTask task{0, cost};
  task.tried_s = tried_s;
  return task;
}

TEST_CASE("without a limit everything fits") {
  TimeBudget time;
  time.learn(1, Seconds(1e6));
  CHECK(time.fits(of_cost(1e9, 1e12), Seconds(1e9)));
  CHECK(time.ever_fits(of_cost(1e9, 1e12)));
  CHECK_FALSE(time.is_over(Seconds(1e9)));
}

TEST_CASE("a task takes what its cost says at the pace of what is known, two thirds of what is left at most") {
  TimeBudget time(Seconds(100), Seconds(1000));
  CHECK(time.fits(of_cost(1e9), Seconds(0)));  // no pace is known
  time.learn(10, Seconds(20));
  CHECK(time.expected(of_cost(5)).count() == Approx(10));
  CHECK(time.fits(of_cost(33), Seconds(0)));
  CHECK_FALSE(time.fits(of_cost(34), Seconds(0)));
  CHECK(time.fits(of_cost(16), Seconds(50)));
  CHECK_FALSE(time.fits(of_cost(17), Seconds(50)));
  time.learn(10, Seconds(60));
  CHECK(time.expected(of_cost(5)).count() == Approx(20));
}

TEST_CASE("the part of a task that was done before it was given up tells the pace too") {
  TimeBudget time(Seconds(100), Seconds(100));
  time.learn_part(50, 0.1, Seconds(100));
  CHECK(time.expected(of_cost(50)).count() == Approx(1000));
  time.learn_part(50, 0, Seconds(100));  // without a complete step
  CHECK(time.expected(of_cost(50)).count() == Approx(1000));
  CHECK(time.ever_fits(of_cost(49)));  // cheaper tasks may fit
  time.learn(5, Seconds(5));
  CHECK(time.expected(of_cost(49)).count() == Approx(49));
}

TEST_CASE("a start that has the whole limit tries what may just fit, once") {
  TimeBudget time(Seconds(99), Seconds(100));
  time.learn(1, Seconds(1));
  CHECK(time.fits(of_cost(140), Seconds(0)));
  CHECK_FALSE(time.fits(of_cost(140), Seconds(20)));
  CHECK_FALSE(time.fits(of_cost(160), Seconds(0)));
  CHECK(time.ever_fits(of_cost(140, 50)));
  CHECK_FALSE(time.ever_fits(of_cost(140, 95)));
  CHECK_FALSE(time.ever_fits(of_cost(10, 95)));
  CHECK_FALSE(time.ever_fits(of_cost(160)));
}

TEST_CASE("a task's own limit bounds what it is expected to take") {
  TimeBudget time(Seconds(100), Seconds(100));
  time.learn(1, Seconds(1));
  PendingTask task = of_cost(1e6);
  task.limit_s = 30;
  CHECK(time.expected(task).count() == Approx(30));
  CHECK(time.fits(task, Seconds(0)));
  CHECK_FALSE(time.fits(task, Seconds(60)));
  task.limit_s = 95;  // more than its last attempt of 80 s
  task.tried_s = 80;
  CHECK(time.ever_fits(task));
  task.limit_s = 10;  // less
  task.tried_s = 95;
  CHECK(time.expected(task).count() == Approx(10));
  CHECK(time.ever_fits(task));
}

TEST_CASE("a sweep whose tasks ran for a whole limit in vain says which is the longest") {
  Timeouts limited;
  limited.time = TimeBudget(Seconds(0.1), Seconds(0.1));
  Sweep sweep(1, tasks_of_cost({3, 3}), limited);
  Inbox worker(sweep.network[1]);
  sweep.master.step();
  REQUIRE(worker.assigned() == std::vector<std::int64_t>{0});
  test::HandClock::pass(Seconds(0.12));
  sweep.master.step();
  worker.assigned();
  REQUIRE(worker.stops == 1);
  Report report(0, TaskOutcome::pending, 0.1, "");
  report.share = 0.1;  // so the task takes a second, and so does the other
  sweep.network[1].send(0, report);
  while (sweep.master.step() != Master::Step::finished) {
  }
  const Dispatch& end = sweep.master.dispatch();
  CHECK(end.left == 2);
  REQUIRE(end.too_long);
  CHECK(end.too_long->index == 1);
  CHECK(end.too_long_s == Approx(1));
}

TEST_CASE("a run whose start took the time limit runs one task, the cheapest that a whole limit has time for") {
  Timeouts limited;
  limited.time = TimeBudget(Seconds(-2), Seconds(15));
  limited.time.learn(1, Seconds(1));
  std::vector<PendingTask> tasks = tasks_of_cost({40, 3, 2, 1});
  tasks[3].crashes = 1;
  Sweep sweep(2, tasks, limited);
  Inbox one(sweep.network[1]), other(sweep.network[2]);
  sweep.master.step();
  sweep.master.step();
  REQUIRE(one.assigned() == std::vector<std::int64_t>{2});
  test::HandClock::pass(Seconds(3));
  sweep.master.step();
  CHECK(one.assigned().empty());
  CHECK(one.stops == 0);
  one.report(2);
  CHECK(sweep.master.step() == Master::Step::finished);
  CHECK(one.assigned().empty());
  CHECK(other.assigned().empty());
  const Dispatch& end = sweep.master.dispatch();
  CHECK(end.left == 3);
  CHECK(end.late);
  CHECK_FALSE(end.too_long);
}

TEST_CASE("that task too is abandoned after the whole limit, and a task that is too long is not begun") {
  Timeouts limited;
  limited.time = TimeBudget(Seconds(1), Seconds(10));
  limited.time.learn(1, Seconds(1));
  Sweep sweep(1, tasks_of_cost({9}), limited);
  Inbox worker(sweep.network[1]);
  sweep.master.step();
  REQUIRE(worker.assigned() == std::vector<std::int64_t>{0});
  test::HandClock::pass(Seconds(9));
  sweep.master.step();
  worker.assigned();
  CHECK(worker.stops == 0);
  test::HandClock::pass(Seconds(2));
  sweep.master.step();
  worker.assigned();
  CHECK(worker.stops == 1);

  Sweep too_long(1, tasks_of_cost({20}), limited);
  Inbox idle(too_long.network[1]);
  CHECK(too_long.master.step() == Master::Step::finished);
  CHECK(idle.assigned().empty());
  CHECK(too_long.master.dispatch().too_long);
}

}  // namespace test_time_budget
