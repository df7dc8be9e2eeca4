#include "runner/plan/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "runner/keys/key.hpp"
#include "runner/keys/sweep_words.hpp"
#include "runner/text/job_error.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// A difference between two jobs; a null value is a missing key.
struct Difference {
  std::string path;
  Json now, before;
};

std::optional<Difference> difference(const Json& now, const Json& before, const std::string& path);

bool extends(const Json& now, const Json& before) { return !difference(now, before, ""); }

bool any_extends(const Json& values, const Json& before) {
  return std::any_of(values.begin(), values.end(), [&](const Json& value) { return extends(value, before); });
}

std::optional<Difference> of_objects(const Json& now, const Json& before, const std::string& path) {
  for (const auto& [name, value] : before.items()) {
    if (name == guess_label_key().name) continue;
    if (!now.contains(name)) return Difference{member(path, name), Json(), value};
    if (auto found = difference(now[name], value, member(path, name))) return found;
  }
  for (const auto& [name, value] : now.items()) {
    if (name != guess_label_key().name && !before.contains(name)) return Difference{member(path, name), value, Json()};
  }
  return std::nullopt;
}

std::optional<Difference> difference(const Json& now, const Json& before, const std::string& path) {
  const std::string word = sweep_word(now), word_before = sweep_word(before);
  if (is_listed(word) && word == word_before) {
    for (const Json& value : before[word]) {
      if (!any_extends(now[word], value)) return Difference{path, now, value};
    }
    return std::nullopt;
  }
  if (is_listed(word)) {
    if (any_extends(now[word], before)) return std::nullopt;
    return Difference{path, now, before};
  }
  if (now.is_object() && before.is_object() && word == word_before && word.empty()) {
    return of_objects(now, before, path);
  }
  if (now.is_array() && before.is_array() && now.size() == before.size() && word_before.empty()) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (auto found = difference(now[i], before[i], element(path, i))) return found;
    }
    return std::nullopt;
  }
  if (now == before) return std::nullopt;
  return Difference{path, now, before};
}

/// Renames files with equal content to the paths in `as`, because a moved job has other paths.
void rename(Json& value, const InputFiles& files, const InputFiles& as) {
  if (value.is_structured())
    for (Json& part : value) rename(part, files, as);
  if (!value.is_string()) return;
  const auto file = files.find(value.get<std::string>());
  if (file == files.end() || file->second.hash.empty()) return;
  const auto same =
      std::find_if(as.begin(), as.end(), [&](const auto& other) { return other.second.hash == file->second.hash; });
  if (same != as.end()) value = same->first;
}

}  // namespace

void check_extends(const Job& job, const Job& before) {
  const std::string file = before.path.native();
  const auto refuse = [&](const std::string& path, const std::string& what) {
    throw job_error(
        job.path, path,
        "{}. --extend allows these changes to the job of {} (rodsweep info {} --job): more samples or grid values, or "
        "another time limit; to compare other guesses, run this job without --extend, so that one run times them all",
        what, file, file);
  };
  if (job.samples < before.samples) {
    refuse("samples", fmt::format("{} here are fewer than the {} in {}", job.samples, before.samples, file));
  }
  Json now = job.values, then = before.values;
  rename(then, before.files, job.files);
  for (const char* free : {"$schema", "name", "description", "samples", "task_time_limit_s"})
    now.erase(free), then.erase(free);
  if (const auto found = difference(now, then, "")) {
    refuse(found->path, fmt::format("{} here, {} in {}", shown(found->now), shown(found->before), file));
  }
}

bool extends(const Job& job, const Job& before) {
  try {
    check_extends(job, before);
    return true;
  } catch (const JobError&) {
    return false;
  }
}

}  // namespace rodsweep
