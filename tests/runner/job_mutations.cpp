#include "tests/runner/job_mutations.hpp"

#include <iterator>
#include <sstream>
#include <vector>

#include "runner/sweep/sweep_space.hpp"

namespace rodsweep {
namespace {

template <class Items>
auto& any_of(Items& items, std::mt19937_64& random) {
  return *std::next(std::begin(items), static_cast<std::ptrdiff_t>(random() % std::size(items)));
}

const std::vector<Json>& odd_values() {
  static const std::vector<Json> values = [] {
    const Json listed = Json::parse(R"([
          null, true, -1, 0, 1, 2, 7, 0.5, 1e300, -1e300, 1e-300, 9007199254740993, 18446744073709551615, "", "x",
          "zero", "grid", "\u0000", "ü\n", [], {}, [[]], [0,0,0], ["zero"], {"grid": []}, {"grid": [1, "a"]},
          {"grid": [{}, []]}, {"zip": [1, 2]}, {"zip": [1, 2, 3]}, {"uniform": [1, 2]}, {"uniform": [2, 1]},
          {"log_uniform": [0, 1]}, {"integer": [1, 3]}, {"gird": [5, 10]}, {"label": "x"},
          {"subspace": {"size": {"grid": [1, 2]}}}, {"copingnet": {"model": "x.h5"}}, {"copingnet": {"model": 5}},
          {"guarded": {"guess": "zero", "threshold": 1}}, {"knn": {"data": "."}}, {"oracle": {"error": "x"}},
          {"obstacles": [{"sphere": {}}]}, {"mean_m_s": [1, 2]}
        ])");
    std::vector<Json> all(listed.begin(), listed.end());
    all.emplace_back(std::string(5000, 'a'));
    return all;
  }();
  return values;
}

void collect(Json& node, std::vector<Json*>& nodes) {
  nodes.push_back(&node);
  if (node.is_structured())
    for (Json& child : node) collect(child, nodes);
}

std::string changed_name(const std::string& name, std::mt19937_64& random) {
  std::string changed = name.empty() ? "a" : name;
  char& letter = any_of(changed, random);
  switch (random() % 4) {
    case 0: letter = 'q'; break;
    case 1: changed.pop_back(); break;
    case 2: changed += changed; break;
    default: std::swap(letter, changed.back());
  }
  return changed;
}

void change(Json& job, std::mt19937_64& random) {
  std::vector<Json*> nodes;
  collect(job, nodes);
  Json& node = *any_of(nodes, random);
  const Json copy = *any_of(nodes, random);    // a value from another place
  switch (&node == &job ? 8 : random() % 9) {  // the root has no key for a message to name
    case 0: node = any_of(odd_values(), random); return;
    case 1: node = copy; return;
    case 2: node = Json{{random() % 2 ? "grid" : "zip", {node, copy}}}; return;
    case 3: node = Json{{"guarded", {{"guess", node}, {"threshold", 1}}}}; return;
    case 4:
      if (node.is_number()) {
        const double factors[] = {-1, 10, 1e9, 0.1, 1.0 / 3};
        node = node.get<double>() * any_of(factors, random);
        return;
      }
      node = Json::array({node});
      return;
    default: break;
  }
  if (!node.is_object() || node.empty()) {
    if (node.is_array() && !node.empty()) node.erase(random() % node.size());
    return;
  }
  const auto entry = std::next(node.begin(), static_cast<std::ptrdiff_t>(random() % node.size()));
  const std::string name = entry.key();
  const Json value = entry.value();
  switch (random() % 4) {
    case 0: node.erase(name); break;
    case 1: node.erase(name), node[changed_name(name, random)] = value; break;
    case 2: node[name] = any_of(odd_values(), random); break;
    default: (copy.is_object() && !copy.empty() ? node[copy.begin().key()] : node["label"]) = value;
  }
}

}  // namespace

Json mutated(Json job, std::mt19937_64& random) {
  for (auto changes = 1 + random() % 3; changes > 0; --changes) change(job, random);
  return job;
}

std::string verdict(const std::string& text, const std::string& file) {
  constexpr std::int64_t most_tasks = 500;
  try {
    const Job job = parse_job(text, file, MissingFiles::accepted);
    if (is_training(job)) return "";
    const SweepSpace space(job.values, job.path);
    if (space.grid_points() <= most_tasks / job.samples) Plan plan(job);
  } catch (const JobError& error) {
    return error.what();
  }
  return "";
}

std::string inside_word(const std::string& message, std::string_view input) {
  for (const char* word : {"json.exception", "std::", "bad_alloc", "basic_string", "vector::", "map::", "_M_", "H5T_",
                           "the job has no value", "is not a text"})
    if (message.find(word) != std::string::npos && input.find(word) == std::string::npos) return word;
  return "";
}

std::string fault_of(const std::string& refusal, const std::string& file) {
  if (const std::string word = inside_word(refusal); !word.empty()) return "it says " + word;
  std::istringstream lines(refusal);
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, file.size() + 2, file + ": ") != 0) return "a line does not begin with the file: " + line;
    const std::string rest = line.substr(file.size() + 2);
    const bool of_all = rest.find("zero byte") != std::string::npos ||
                        rest.find("too many tasks") != std::string::npos ||
                        rest.find("too large") != std::string::npos || rest.find(" more") == rest.size() - 5 ||
                        rest.compare(0, 5, "line ") == 0;
    if (!of_all && (rest.find(": ") == std::string::npos || rest[0] == '{' || rest[0] == '['))
      return "a line names no key: " + line;
  }
  return "";
}

}  // namespace rodsweep
