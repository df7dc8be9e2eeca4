#include "runner/command/training_resume.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodsweep {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The settings that affect the results, by JSON pointer. The data set is compared by its hash instead.
Json settings_of(const Job& job) {
  Json values = job.values;
  for (const char* key : {"name", "description", "$schema", "data"}) values.erase(key);
  return values.flatten();
}

void check_same_job(const Job& job, const std::string& earlier_text, const fs::path& path) {
  const Json now = settings_of(job), earlier = settings_of(parse_job(earlier_text, path));
  for (const Json* keys : {&earlier, &now})
    for (const auto& [key, ignored] : keys->items()) {
      const Json value = now.value(key, Json()), before = earlier.value(key, Json());
      if (value == before) continue;
      std::string key_path = key.substr(1);
      std::replace(key_path.begin(), key_path.end(), '/', '.');
      throw FileError(fmt::format("{} cannot be continued with {}: {} was {} and is {}; name another file with -o FILE",
                                  path.native(), job.path.native(), key_path, before.dump(), value.dump()));
    }
}

}  // namespace

std::optional<StoredModel> earlier_training(const RunOptions& options, const Job& job, const fs::path& path) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return std::nullopt;
  if (!options.resume)
    throw FileError(
        fmt::format("{} exists already and is never overwritten: continue it with --resume, or name another file with "
                    "-o FILE",
                    path.native()));
  StoredModel earlier = read_training(path);
  check_same_job(job, earlier.card.job_text, path);
  if (earlier.card.ending == Ending::none && !earlier.checkpoint)
    throw FileError(fmt::format("{} holds an unfinished training without a checkpoint", path.native()));
  return earlier;
}

}  // namespace rodsweep
