#include <catch2/catch.hpp>
#include <cmath>

#include "runner/keys/key.hpp"
#include "runner/specs/guess_keys.hpp"
#include "runner/text/words.hpp"
#include "solver/numbers/counter_random.hpp"

using namespace rodsweep;

TEST_CASE("the nearest known word is found for small mistakes and none for large ones") {
  const std::vector<std::string> known{"length_m", "segments", "step_s", "gravity_m_s2", "zero"};
  CHECK(nearest("lenght_m", known) == "length_m");
  CHECK(nearest("Segment", known) == "segments");
  CHECK(nearest("steps", known) == "step_s");
  CHECK(nearest("gravity", known) == "gravity_m_s2");
  CHECK(nearest("zreo", known) == "zero");
  CHECK(nearest("temperature", known) == "");
  CHECK(nearest("", known) == "");
  CHECK(nearest(std::string(100000, 'x'), known) == "");
}

TEST_CASE("counter-based random numbers are the same on every machine") {
  CHECK(random_stream("") == 0xcbf29ce484222325u);
  CHECK(random_stream("a") == 0xaf63dc4c8601ec8cu);  // published FNV-1a value
  CHECK(random_bits(0, 0, 0) == random_bits(0, 0, 0));
  CHECK(random_bits(1, 2, 3) != random_bits(1, 3, 2));
  CHECK(random_bits(1, 2, 3) != random_bits(2, 1, 3));
}

TEST_CASE("random numbers of neighbouring counters, seeds and streams are uncorrelated") {
  const auto stream_a = random_stream("scene.length_m"), stream_b = random_stream("scene.radius_m");
  constexpr int n = 20000;
  double mean = 0, next = 0, seeds = 0, streams = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    const double u = random_unit(7, i, stream_a) - 0.5;
    mean += u / n;
    next += 12 * u * (random_unit(7, i + 1, stream_a) - 0.5) / n;
    seeds += 12 * u * (random_unit(8, i, stream_a) - 0.5) / n;
    streams += 12 * u * (random_unit(7, i, stream_b) - 0.5) / n;
  }
  CHECK(std::abs(mean) < 0.01);  // standard deviations .002 and .007
  CHECK(std::abs(next) < 0.035);
  CHECK(std::abs(seeds) < 0.035);
  CHECK(std::abs(streams) < 0.035);
}

namespace test_job_parts {

/// Calls check(key) for a key and all keys within it.
template <class Check>
void for_every_key(const Key& key, const Check& check) {
  check(key);
  for (const Key& child : key.keys) for_every_key(child, check);
}

TEST_CASE("every key is described") {
  const auto check = [](const Key& key) {
    INFO(key.name);
    CHECK_FALSE(key.name.empty());
    CHECK_FALSE(key.help.empty());
    CHECK_FALSE(allowed(key).empty());
    if (key.kind == Key::Kind::choice) CHECK_FALSE(key.choices.empty());
    const bool has_unit_suffix = (key.name.size() > 2 && key.name.find("_m") == key.name.size() - 2) ||
                                 key.name.find("_pa") != std::string::npos;
    if (has_unit_suffix) CHECK_FALSE(key.unit.empty());
    if (!key.tag.empty()) CHECK(find_key(key.keys, key.tag) != nullptr);
  };
  for_every_key(job_key(), check);
  for (const Key& guess : guess_keys()) for_every_key(guess, check);
  check(guess_label_key());
}

}  // namespace test_job_parts
