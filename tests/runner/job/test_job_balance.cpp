// Jobs whose steps keep the balance of momentum.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/runner/job_examples.hpp"

namespace rodsweep {
namespace test_job_balance {

TEST_CASE("steps are the paper's unless they are to keep the balance, which may be swept") {
  const Plan plan = plan_of(with("/time/balance", R"({"grid": [false, true]})"));
  REQUIRE(plan.size() % 2 == 0);
  for (const Task& task : plan.tasks()) {
    const TimeSpec time = plan.spec(task.index).time;
    CHECK(time.balance == (2 * task.index >= plan.size()));
    CHECK(time.momentum_tolerance == 1e-4);
  }
  const auto parameters = plan.parameters();
  const auto column = std::find_if(parameters.begin(), parameters.end(),
                                   [](const ParameterColumn& each) { return each.path == "time.balance"; });
  REQUIRE(column != parameters.end());
  CHECK(column->swept);
  CHECK(std::get<ColumnValues<std::int64_t>>(column->values).all().front() == 0);
  CHECK(std::get<ColumnValues<std::int64_t>>(column->values).all().back() == 1);
  CHECK_FALSE(plan_of(without("/guesses", with("/solve", R"({"method": "direct"})"))).spec(0).time.balance);
}

TEST_CASE("data sets have what the balance is kept against, where any task keeps it") {
  for (const char* balance : {"false", "true", R"({"grid": [false, true]})"}) {
    const Plan plan = plan_of(with("/time/balance", balance, data_job()));
    const bool any = std::string(balance) != "false";
    for (const Task& task : plan.tasks()) {
      const std::int64_t segments = task.rows[Rows::system_segment].count;
      CHECK(segments > 0);
      CHECK(task.rows[Rows::balanced_segment].count == (any ? segments : 0));
    }
  }
}

}  // namespace test_job_balance
}  // namespace rodsweep
