// Every key of a job: a grid of two values that are accepted alone is accepted, and its tasks are those of the two jobs.
// Keys that cannot be swept say so.
#include <tuple>

#include "runner/measure/plan_check.hpp"
#include "tests/catch.hpp"
#include "tests/laws/key_places.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep::laws {
namespace test_keys {

using Identity = std::tuple<std::string, std::vector<std::string>, std::string>;

std::vector<Identity> tasks(const Json& job) {
  const Plan plan = checked_plan(read(job));
  std::vector<Identity> found;
  for (const Task& task : plan.tasks()) {
    const TaskInputs identity = plan.inputs(task.index);
    found.emplace_back(identity.trajectory, identity.guesses, identity.record);
  }
  return found;
}

/// A rod may tear or diverge with a value that the table allows, but no task fails.
void run_all(const Json& job) {
  const Plan plan = checked_plan(read(job));
  for (const Task& task : plan.tasks()) {
    const TaskRecord record = record_of(plan, task.index);
    CAPTURE(task.index, record.message);
    CHECK(record.outcome != TaskOutcome::error);
  }
}

TEST_CASE("the tasks of a swept key are those of its values") {
  int swept = 0;
  visit_keys([&](const KeyPlace& at) {
    if (!at.key.sweepable) return;
    CAPTURE(at.path(), at.job.dump());
    std::vector<Json> values = accepted(at, 2);
    if (values.empty()) {
      FAIL_CHECK("no value is accepted: " << objection(at.job));
      return;
    }
    if (values.size() < 2) values.push_back(values.front());
    std::vector<Identity> expected;
    for (const Json& value : values)
      for (const Identity& task : tasks(at.with(value))) expected.push_back(task);
    std::vector<Identity> found;
    CHECK(message_of<JobError>([&] { found = tasks(at.with(grid(values))); }) == "");
    CHECK(found.size() == expected.size());
    CHECK((at.is_tag || found == expected));  // a swept tag gives no defaults to keys that only one value has
    run_all(at.with(grid(values)));
    ++swept;
  });
  CHECK(swept > 100);
}

TEST_CASE("a key that cannot be swept says so") {
  int refused = 0;
  visit_keys([&](const KeyPlace& at) {
    if (at.key.sweepable) return;
    const Json value = at.job.value(Json::json_pointer(at.pointer), Json("x"));
    CHECK_THAT(objection(at.with(grid({value, value}))),
               Catch::Matchers::ContainsSubstring(at.path() + ": this key cannot be swept"));
    ++refused;
  });
  CHECK(refused > 50);
}

}  // namespace test_keys
}  // namespace rodsweep::laws
