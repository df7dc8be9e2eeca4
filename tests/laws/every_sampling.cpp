// Every sampling: a drawn value depends on seed, sample and key alone. So old values stay if another key is drawn too,
// and if there are more samples, grid points or scenes.
#include <cmath>
#include <map>
#include <set>

#include "runner/keys/key.hpp"
#include "runner/sweep/sobol.hpp"
#include "solver/numbers/counter_random.hpp"
#include "tests/catch.hpp"
#include "tests/laws/key_places.hpp"

namespace rodsweep::laws {
namespace test_samplings {

constexpr int samples = 8;

/// The swept values by parameter, one for each task.
std::map<std::string, std::vector<double>> drawn(const Json& job) {
  const Plan plan(read(job));
  std::map<std::string, std::vector<double>> values;
  for (const ParameterColumn& column : plan.parameters()) {
    if (!column.swept) continue;
    if (const auto* numbers = std::get_if<ColumnValues<double>>(&column.values))
      values[column.path] = numbers->all();
    else if (const auto* integers = std::get_if<ColumnValues<std::int64_t>>(&column.values))
      for (const std::int64_t integer : integers->all()) values[column.path].push_back(static_cast<double>(integer));
  }
  return values;
}

/// The job with some draws.
Json with_draws(Json job, const std::string& sampling) {
  job["sampling"] = sampling;
  job["samples"] = samples;
  job["scene"]["damping_per_s"] = uniform(0, 1);
  job["scene"]["length_m"] = uniform(1, 2);
  job["scene"]["tip_force_n"] = {0, uniform(-2, -1), 0};
  job["scene"]["youngs_modulus_pa"] = {{"log_uniform", {1e5, 1e6}}};
  return job;
}

Json bending_rods(const std::string& sampling) { return with_draws(jobs_by_scene().at("bending_rod"), sampling); }

const std::vector<std::string>& samplings() { return find_key(job_key().keys, "sampling")->choices; }

/// A range of two numbers that the key accepts; null if there are none.
Json range(const KeyPlace& at) {
  if (!at.key.sweepable || (at.key.kind != Key::Kind::number && at.key.kind != Key::Kind::integer)) return nullptr;
  std::vector<double> ends;
  for (const Json& value : accepted(at, 4))
    if (value.is_number()) ends.push_back(value);
  const auto [low, high] = std::minmax_element(ends.begin(), ends.end());
  if (ends.size() < 2 || *low == *high) return nullptr;
  return {{at.key.kind == Key::Kind::integer ? "integer" : "uniform", {number(*low), number(*high)}}};
}

TEST_CASE("a draw stays the same if any other key is drawn too") {
  int tried = 0;
  visit_keys([&](const KeyPlace& at) {
    if (at.job.value("/scene/type"_json_pointer, Json()) != "bending_rod") return;
    const Json other = range(at);
    if (other.is_null()) return;
    for (const std::string& sampling : samplings()) {
      const KeyPlace with{with_draws(at.job, sampling), at.pointer, at.key, at.sweepable};
      const Json more = with.with(other);
      CAPTURE(sampling, at.path());
      if (objection(more) != "") continue;  // not all values between two accepted ones need be
      const auto after = drawn(more);
      for (const auto& [path, values] : drawn(with.job))
        if (at.path().rfind(path, 0) != 0) CHECK(after.at(path) == values);
      ++tried;
    }
  });
  CHECK(tried > 50);
}

TEST_CASE("draws stay the same with more samples, grid points, zips and scenes") {
  for (const std::string& sampling : samplings()) {
    CAPTURE(sampling);
    const Json job = bending_rods(sampling);
    const auto before = drawn(job);
    Json more = job;
    more["samples"] = samples + 1;
    for (const auto& [path, values] : drawn(more))
      CHECK(std::equal(before.at(path).begin(), before.at(path).end(), values.begin()));
    Json scene = job["scene"];
    scene["segments"] = {{"integer", {3, 20}}};
    for (Json other : {grid({job["scene"], scene}), grid({scene, job["scene"]}), zip({job["scene"], job["scene"]})}) {
      more = job;
      more["scene"] = other;
      more["time"]["step_s"] = zip({1e-3, 2e-3});
      const auto after = drawn(more);
      for (const auto& [path, values] : before)
        for (std::size_t first = 0; first < after.at(path).size(); first += values.size())
          CHECK(std::equal(values.begin(), values.end(), after.at(path).begin() + static_cast<std::ptrdiff_t>(first)));
    }
    more = job;
    more["seed"] = 1;
    for (const auto& [path, values] : drawn(more)) CHECK(values != before.at(path));
  }
}

TEST_CASE("no two keys have the same directions, and each is even alone") {
  std::map<std::string, Directions> keys;
  std::set<int> dimensions;
  visit_keys([&](const KeyPlace& at) {
    if (!at.key.sweepable || (at.key.kind != Key::Kind::number && at.key.kind != Key::Kind::integer)) return;
    const auto [known, is_new] = keys.try_emplace(at.path());
    if (!is_new) return;
    const std::optional<int> dimension = at.key.sobol_dimension;
    CAPTURE(at.path());
    CHECK((!dimension || dimensions.insert(*dimension).second));
    CHECK((!dimension || at.path().find('[') == std::string::npos));  // not several in a list
    known->second = dimension ? sobol_directions(*dimension) : random_directions(7, random_stream(at.path()));
    std::set<std::uint32_t> places;
    for (std::uint64_t i = 0; i < 64; ++i) places.insert(digits(known->second, i) >> 26);
    CHECK(places.size() == 64);
  });
  std::set<Directions> all;
  for (const auto& [path, directions] : keys) all.insert(directions);
  CHECK(all.size() == keys.size());
}

}  // namespace test_samplings
}  // namespace rodsweep::laws
