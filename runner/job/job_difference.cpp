#include "runner/job/job_difference.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// By JSON pointer.
Json settings(const Job& job) {
  Json values = job.values;
  for (const char* free : {"name", "description", "$schema"}) values.erase(free);
  return values.flatten();
}

}  // namespace

std::string shown(const Json& value) {
  if (value.is_null()) return "nothing";
  constexpr std::size_t longest = 80;
  const std::string text = value.dump();
  return text.size() <= longest ? text : text.substr(0, longest) + "...";
}

std::optional<JobDifference> first_difference(const Job& now, const Job& before) {
  const Json a = settings(now), b = settings(before);
  for (const Json* keys : {&b, &a})
    for (const auto& [pointer, ignored] : keys->items()) {
      const Json value = a.value(pointer, Json()), earlier = b.value(pointer, Json());
      if (value == earlier) continue;
      std::string key = pointer.substr(1);
      std::replace(key.begin(), key.end(), '/', '.');
      return JobDifference{key, shown(value), shown(earlier)};
    }
  return std::nullopt;
}

}  // namespace rodsweep
