// A compact task list returns the tasks that were added, with consecutive rows.
#include <stdexcept>
#include <tuple>
#include <vector>

#include "runner/plan/task_list.hpp"
#include "tests/catch.hpp"

using namespace rodsweep;

namespace test_task_list {

/// Tasks of a few shapes in no order, with the `index` and the first rows that a list assigns.
std::vector<Task> some_tasks(int count) {
  std::vector<Task> tasks;
  PerRows<std::int64_t> first{};
  for (int i = 0; i < count; ++i) {
    Task task;
    task.index = i;
    task.point = i / 2;
    task.sample = i / 2 % 7;
    task.own_guess = i % 2;
    task.segments = 4 + i * i % 5;
    task.joints = task.segments - 1;
    task.steps = 10 + i % 3;
    task.frames = i % 4 == 0 ? 2 : 0;
    task.cost = 1.5 * task.segments;
    for (std::size_t kind = 0; kind < row_kinds; ++kind) {
      task.rows[kind] = {first[kind], static_cast<std::int64_t>(kind) * task.segments + i % 3};
      first[kind] += task.rows[kind].count;
    }
    tasks.push_back(task);
  }
  return tasks;
}

TaskList listed(const std::vector<Task>& tasks) {
  TaskList list;
  for (const Task& task : tasks) list.add(task);
  return list;
}

void check_equal(const Task& a, const Task& b) {
  const auto values = [](const Task& t) {
    return std::tie(t.index, t.point, t.sample, t.own_guess, t.segments, t.joints, t.steps, t.frames, t.cost);
  };
  CHECK((values(a) == values(b)));
  for (std::size_t kind = 0; kind < row_kinds; ++kind) {
    CHECK(a.rows[kind].first == b.rows[kind].first);
    CHECK(a.rows[kind].count == b.rows[kind].count);
  }
}

TEST_CASE("a list of tasks gives back what it was given, one by one and in order") {
  const std::vector<Task> tasks = some_tasks(150);
  const TaskList list = listed(tasks);
  REQUIRE(list.size() == 150);
  for (const std::size_t i : {149, 0, 63, 64, 65, 127, 128}) {
    check_equal(list.at(static_cast<std::int64_t>(i)), tasks[i]);
    CHECK(list.cost(static_cast<std::int64_t>(i)) == tasks[i].cost);
  }
  std::size_t next = 0;
  for (const Task& task : list) check_equal(task, tasks.at(next++));
  CHECK(next == 150);
  const auto& last = tasks.back().rows[Rows::step];
  CHECK(list.rows()[Rows::step] == last.first + last.count);
  CHECK_THROWS_AS(list.at(150), std::out_of_range);
  CHECK_THROWS_AS(list.at(-1), std::out_of_range);
}

TEST_CASE("rows of a kind that is dropped are nowhere, and the others stay") {
  std::vector<Task> tasks = some_tasks(100);
  TaskList list = listed(tasks);
  list.drop(Rows::contact_step);
  for (Task& task : tasks) task.rows[Rows::contact_step] = {0, 0};
  check_equal(list.at(99), tasks[99]);
  CHECK(list.rows()[Rows::contact_step] == 0);

  tasks.push_back(tasks.front());
  Task& added = tasks.back();
  added.index = 100;
  for (std::size_t kind = 0; kind < row_kinds; ++kind) added.rows[kind].first = list.rows()[kind];
  list.add(added);
  check_equal(list.at(100), added);
}

}  // namespace test_task_list
