// Jobs for tests: a small valid job, functions that change it, and its error message after a change.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runner/plan/plan.hpp"

namespace rodsweep {

using Json = nlohmann::ordered_json;

Json bending_scene();

Json helix_scene();

/// Two small trees, one rod each.
Json forest_scene();

/// Two rods of unequal length that are held at one end; writes the file of their curves.
Json two_rods(const std::filesystem::path& curves);

Json small_job();

/// The small job as a data set.
Json data_job();

/// Trains a network on a data set.
Json train_job();

/// The small job with the JSON text `value` at a JSON pointer such as "/scene/segments".
Json with(const std::string& pointer, const std::string& value, Json job = small_job());

Json without(const std::string& pointer, Json job = small_job());

Json grid(Json values);
Json zip(Json values);
Json uniform(double a, double b);

Job job_of(const Json& job);
Plan plan_of(const Json& job);

std::optional<ParameterColumn> find_column(const Plan& plan, const std::string& path);

/// The values of a parameter in all tasks.
template <class Value>
std::vector<Value> values_of(const Plan& plan, const std::string& path) {
  return std::get<ColumnValues<Value>>(find_column(plan, path).value().values).all();
}

/// The message of the `Error` that `call` throws; "" if it throws none.
template <class Error, class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// The error message for the text of a job; "" if the job is valid.
std::string refusal_of_text(const std::string& text);

std::string refusal(const Json& job);

}  // namespace rodsweep
