#include "runner/job/job_difference.hpp"

#include <fmt/format.h>

#include "runner/job/guess_keys.hpp"
#include "runner/job/key_path.hpp"
#include "runner/job/sweep.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

void collect(const Json& a, const Json& b, const std::string& path, std::vector<KeyDifference>& found) {
  if (a == b) return;
  if (!a.is_object() || !b.is_object() || !sweep_word(a).empty() || !sweep_word(b).empty()) {
    found.push_back({path, a, b});
    return;
  }
  for (const auto& [name, value] : a.items()) collect(value, b.value(name, Json()), member(path, name), found);
  for (const auto& [name, value] : b.items())
    if (!a.contains(name)) collect(Json(), value, member(path, name), found);
}

/// {"label": the guess without it}
Json by_label(const Json& guesses) {
  Json object = Json::object();
  for (const Json& guess : guesses) {
    Json bare = guess;
    if (sweep_word(guess).empty())
      bare.begin()->erase(guess_label_key().name);
    else
      bare.erase(guess_label_key().name);
    object[guess_label(guess)] = std::move(bare);
  }
  return object;
}

Json comparable(const Job& job) {
  Json values = job.values;
  for (const char* free : {"name", "description", "$schema"}) values.erase(free);
  if (values.contains("guesses")) values["guesses"] = by_label(values["guesses"]);
  return values;
}

}  // namespace

std::vector<KeyDifference> job_differences(const Job& a, const Job& b) {
  std::vector<KeyDifference> found;
  collect(comparable(a), comparable(b), "", found);
  for (const auto& [written, file] : a.files) {
    const auto other = b.files.find(written);
    if (other == b.files.end() || other->second.hash == file.hash) continue;
    found.push_back({file.key_path, fmt::format("{}, hash {}", written, file.hash),
                     fmt::format("{}, hash {}", written, other->second.hash)});
  }
  return found;
}

}  // namespace rodsweep
