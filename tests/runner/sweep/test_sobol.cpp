#include <algorithm>
#include <array>
#include <cmath>

#include "runner/sweep/sobol.hpp"
#include "solver/numbers/counter_random.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_sobol {

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

TEST_CASE("without scrambling the points are Sobol's, with the direction numbers of Joe and Kuo") {
  // new-joe-kuo-6.21201, points 0 to 7, first four dimensions.
  const double known[8][4] = {{0, 0, 0, 0},
                              {0.5, 0.5, 0.5, 0.5},
                              {0.75, 0.25, 0.25, 0.25},
                              {0.25, 0.75, 0.75, 0.75},
                              {0.375, 0.375, 0.625, 0.875},
                              {0.875, 0.875, 0.125, 0.375},
                              {0.625, 0.125, 0.875, 0.625},
                              {0.125, 0.625, 0.375, 0.125}};
  for (int d = 0; d < 4; ++d) {
    const Directions directions = sobol_directions(d);
    for (std::size_t i = 0; i < 8; ++i) CHECK(digits(directions, i) * 0x1p-32 == known[i][d]);
  }
}

TEST_CASE("scrambling keeps one point in each of 2^k equal intervals, and its digits depend on those before them") {
  constexpr std::size_t points = 256;
  for (std::uint32_t seed : {0u, 1u, 0x9e3779b9u}) {
    std::vector<int> hits(points, 0);
    const Directions directions = random_directions(seed, 3);
    for (std::size_t i = 0; i < points; ++i) ++hits[scrambled(digits(directions, i), seed) >> 24];
    CHECK(std::count(hits.begin(), hits.end(), 1) == points);
  }
  CHECK(scrambled(0x70000000u, 5) >> 28 == scrambled(0x7fffffffu, 5) >> 28);
  int alike = 0;  // whether the second digits of both halves are flipped alike, as by a shift
  for (std::uint32_t seed = 0; seed < 64; ++seed) {
    const auto mixed = static_cast<std::uint32_t>(random_bits(seed, 0, 0));
    alike += ((scrambled(0, mixed) ^ scrambled(0x80000000u, mixed)) & 0x40000000u) == 0;
  }
  CHECK(alike > 20);
  CHECK(alike < 44);
}

/// The root mean square error of means of 64 samples, over 300 seeds; without `is_even`: of independent samples.
template <class Function>
double error_of_means(const std::array<std::optional<int>, 3>& dimensions, bool is_even, const Function& f) {
  constexpr std::uint64_t seeds = 300, samples = 64;
  std::vector<double> means;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    std::vector<EvenSequence> sequences;
    for (std::uint64_t key = 0; key < 3; ++key) sequences.emplace_back(dimensions[key], seed, key);
    double sum = 0;
    for (std::uint64_t i = 0; i < samples; ++i) {
      std::array<double, 3> u{};
      for (std::uint64_t key = 0; key < 3; ++key) u[key] = is_even ? sequences[key].unit(i) : random_unit(seed, i, key);
      sum += f(u);
    }
    means.push_back(sum / samples);
  }
  const double expected = f.mean();
  double squares = 0;
  for (const double mean : means) squares += (mean - expected) * (mean - expected) / seeds;
  return std::sqrt(squares);
}

struct Sum {
  double operator()(const std::array<double, 3>& u) const { return std::exp(u[0]) + u[1] * u[1] + std::sqrt(u[2]); }
  static double mean() { return std::exp(1) - 1 + 1.0 / 3 + 2.0 / 3; }
};
struct Product {
  double operator()(const std::array<double, 3>& u) const {
    return std::exp(1.5 * u[0]) * std::exp(-1.2 * u[1]) * (1 + 0.5 * std::cos(1.5 * u[2]));
  }
  static double mean() {
    return (std::exp(1.5) - 1) / 1.5 * (1 - std::exp(-1.2)) / 1.2 * (1 + 0.5 * std::sin(1.5) / 1.5);
  }
};

TEST_CASE("means of even samples are as exact as docs/jobs.md says") {
  const auto gain = [](const auto& f, std::optional<int> a, std::optional<int> b, std::optional<int> c) {
    return error_of_means({a, b, c}, false, f) / error_of_means({a, b, c}, true, f);
  };
  CHECK(gain(Sum(), 0, 1, 2) > 40);
  CHECK(gain(Sum(), {}, {}, {}) > 40);
  CHECK(gain(Product(), 0, 1, 2) > 20);
  CHECK(gain(Product(), 0, 1, 7) > 6);
  CHECK(gain(Product(), 4, 5, 6) > 10);
  CHECK(gain(Product(), {}, {}, {}) > 2.5);
}

TEST_CASE("logarithmic and whole draws and components of vectors are even too, pairs of usual keys also together") {
  Json job = with("/sampling", "\"sobol\"");
  job["samples"] = 64;
  job["scene"]["youngs_modulus_pa"] = {{"log_uniform", {1e4, 1e6}}};
  job["scene"]["segments"] = {{"integer", {3, 6}}};
  job["scene"]["length_m"] = uniform(1, 2);
  job["scene"]["tip_force_n"] = {0, uniform(0, 1), 0};
  const Plan plan = plan_of(job);
  const auto moduli = values_of<double>(plan, "scene.youngs_modulus_pa"),
             lengths = values_of<double>(plan, "scene.length_m");
  const auto forces = values_of<double>(plan, "scene.tip_force_n");
  int of_three = 0, soft = 0, low = 0, short_and_soft = 0;
  for (std::size_t k = 0; k < 64; ++k) {
    of_three += plan.task(static_cast<std::int64_t>(k)).segments == 3;
    soft += moduli[k] < 1e5;
    low += forces[3 * k + 1] < 0.5;
    short_and_soft += lengths[k] < 1.5 && moduli[k] < 1e5;
  }
  CHECK(of_three == 16);
  CHECK(soft == 32);
  CHECK(low == 32);
  CHECK(short_and_soft == 16);
}

}  // namespace test_sobol
