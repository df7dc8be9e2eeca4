#include "runner/command/commands.hpp"

#include <set>
#include <string>
#include <vector>

#include "runner/file/layout.hpp"
#include "runner/keys/job_schema.hpp"
#include "runner/keys/key.hpp"
#include "runner/plan/task_outcome.hpp"
#include "runner/specs/guess_keys.hpp"

namespace rodsweep {
namespace {

void add_paths(const std::vector<Key>& keys, std::set<std::string>& names) {
  for (const Key& key : keys) {
    if (key.text == Key::Text::path) names.insert(key.name);
    add_paths(key.keys, names);
  }
}

}  // namespace

std::string schema_text() {
  std::vector<std::string> outcomes, planned;
  for (int i = 0; i < task_outcomes; ++i) outcomes.emplace_back(to_string(static_cast<TaskOutcome>(i)));
  visit_planned_columns(
      [](const RowPlace&) { return true; },
      [&](const std::string& path, const char*, auto) { planned.push_back(path.substr(path.rfind('/') + 1)); });
  std::set<std::string> paths;
  const std::vector<Key> keys = job_key().keys;
  add_paths(keys, paths);
  add_paths(guess_keys(), paths);
  const Key& iterations = *find_key(find_key(keys, "solve")->keys, "iterations");
  return job_schema_text({{"x-files",
                           {{"schema_version", schema_version},
                            {"outcomes", outcomes},
                            {"planned", planned},
                            {"paths", paths},
                            {"gauss_seidel_iterations", *iterations.preset}}}});
}

}  // namespace rodsweep
