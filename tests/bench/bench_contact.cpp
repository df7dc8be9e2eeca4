// The cost of contact over the number of segments of a heap of constant density: broad phase, finding contacts,
// projection. Google Benchmark times the cases; a final table has the medians per segment.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "solver/contact/contact_projection.hpp"
#include "solver/scene/scene_parts.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr int sizes[] = {1000, 10000, 100000};

/// Layers of parallel rods of ten segments. Each layer crosses the one below at right angles and overlaps it a little.
Scene heap(int segments) {
  RodParameters p;
  p.radius_m = 0.05;
  const int rods = segments / 10, columns = static_cast<int>(std::lround(std::cbrt(rods / 14.0))), rows = 7 * columns;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.01, 0.01);
  Scene scene;
  for (int k = 0; k < rods; ++k) {
    const int layer = k / (rows * columns), row = k / columns % rows, column = k % columns;
    std::vector<Vector3> vertices;
    for (int i = 0; i <= 10; ++i) {
      const double along = 2.2 * column + 0.2 * i, across = 0.3 * row, y = 0.095 * layer + jitter(random);
      vertices.emplace_back(layer % 2 ? across : along, y, layer % 2 ? along : across);
    }
    scene.rods.push_back(chain(segments_through(vertices, p), p, 1));
  }
  scene.contact = ContactSettings{};
  return scene;
}

/// A heap after a fall of one step of 0.01 s from rest.
struct Fallen {
  Scene scene;
  ContactProjection projection;
  ContactBodies bodies;
  std::vector<Box> boxes;
  std::vector<double> margins;

  explicit Fallen(int segments) : scene(heap(segments)), projection(scene, *scene.contact, 0.01), bodies(scene) {
    projection.start_step(0.01);
    for (Rod& rod : scene.rods) rod.constraint_dt = 0.01;
    std::vector<CapsuleAxis> axes;
    bodies.place(scene, axes);
    for (const CapsuleAxis& axis : axes) {
      Box box{axis.at(1), axis.at(1)};
      box.include(axis.at(-1));
      boxes.push_back(box.grown(0.06));
      margins.push_back(0.025);
    }
    for (Rod& rod : scene.rods)
      for (Vector3& position : rod.position) position.y() -= 1e-3;
    projection.find(false);
  }
  Fallen(const Fallen&) = delete;
  Fallen& operator=(const Fallen&) = delete;

  static Fallen& of(const benchmark::State& state) {
    static std::map<int, Fallen> made;
    const int segments = static_cast<int>(state.range(0));
    return made.try_emplace(segments, segments).first->second;
  }
};

void search(benchmark::State& state) {
  Fallen& fallen = Fallen::of(state);
  for (auto _ : state) {
    BroadPhase broad_phase(fallen.margins, [&fallen](int a, int b) { return fallen.bodies.matter(a, b); });
    benchmark::DoNotOptimize(broad_phase.pairs(fallen.boxes).data());
  }
}

/// Reuses the pairs of an earlier step.
void find(benchmark::State& state) {
  Fallen& fallen = Fallen::of(state);
  for (auto _ : state) fallen.projection.find(false);
}

void project(benchmark::State& state) {
  Fallen& fallen = Fallen::of(state);
  for (auto _ : state) benchmark::DoNotOptimize(fallen.projection.project());
}

void print_summary(const Medians& median) {
  std::printf("\nContact, per segment [us]: searching pairs anew, finding contacts of known pairs, one projection\n");
  std::printf("%8s %10s %8s %8s %22s\n", "segments", "search", "find", "project", "contacts per segment");
  for (const int n : sizes) {
    const auto us = [&](const char* name) { return median(name, n) / n * 1e6; };
    Fallen fallen(n);
    std::printf("%8d %10.3f %8.3f %8.3f %22.2f\n", n, us("search"), us("find"), us("project"),
                static_cast<double>(fallen.projection.contacts().size()) / n);
  }
}

}  // namespace

int main(int argc, char** argv) {
  register_cases({{"search", search}, {"find", find}, {"project", project}}, sizes);
  return run_benchmarks(argc, argv, print_summary);
}
