// For tests of refusals: tables of invalid jobs and their error messages.
#pragma once

#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <vector>

#include "tests/runner/job_examples.hpp"

namespace rodsweep {

/// Texts that the error message must contain: after the file, the key's path and value; the bound; the advice.
struct RefusedJob {
  Json job;
  std::string path_value;
  std::string bound = "";
  std::string advice = "";
};

inline void check_refused(const std::vector<RefusedJob>& jobs,
                          const std::function<std::string(const Json&)>& refusal_of = refusal) {
  for (const RefusedJob& refused : jobs) {
    CAPTURE(refused.job.dump());
    const std::string text = refusal_of(refused.job);
    CHECK_THAT(text, Catch::Contains("job.json: " + refused.path_value));
    CHECK_THAT(text, Catch::Contains(refused.bound));
    CHECK_THAT(text, Catch::Contains(refused.advice));
  }
}

}  // namespace rodsweep
