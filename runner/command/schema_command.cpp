#include "runner/command/commands.hpp"

#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "runner/file/layout.hpp"
#include "runner/keys/key.hpp"
#include "runner/plan/task_outcome.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {
namespace {

void add_paths(const std::vector<Key>& keys, std::set<std::string>& names) {
  for (const Key& key : keys) {
    if (key.text == Key::Text::path) names.insert(key.name);
    add_paths(key.keys, names);
  }
}

// The names of the scenes that have a floor of their own, the only obstacle that a scene adds to those of its job.
template <class... Scenes>
std::vector<std::string> with_floor(const std::variant<Scenes...>*) {
  std::vector<std::string> names;
  const auto add = [&names](const auto& scene) {
    if constexpr (std::is_base_of_v<TouchingRods, std::decay_t<decltype(scene)>>)
      if (!build_scene(scene).obstacles.empty()) names.emplace_back(scene.name);
  };
  (add(Scenes{}), ...);
  return names;
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
                            {"with_floor", with_floor(static_cast<const SceneSpec*>(nullptr))},
                            {"gauss_seidel_iterations", *iterations.preset}}}});
}

}  // namespace rodsweep
