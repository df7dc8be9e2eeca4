// The cost of contact over the number of segments of a heap of constant density: broad phase, finding contacts. Google
// Benchmark times the cases; a final table has the medians per segment. Another has whole steps in contact of scenes as
// they are simulated, beside their assembly and direct solution.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "solver/contact/contact_projection.hpp"
#include "solver/scene/scene_parts.hpp"
#include "solver/step/time_step.hpp"
#include "tests/bench/contact_scenes.hpp"
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

  explicit Fallen(int segments) : scene(heap(segments)), projection(scene, *scene.contact, 0.01, false), bodies(scene) {
    projection.start_step(0.01);
    for (Rod& rod : scene.rods) rod.constraint_dt = 0.01;
    std::vector<CapsuleAxis> axes;
    bodies.place(scene, axes);
    for (const CapsuleAxis& axis : axes) {
      Box box{axis.at(1), axis.at(1)};
      box.extend(axis.at(-1));
      boxes.push_back(grown(box, 0.06));
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

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

template <class T>
double median_of(std::vector<T> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return static_cast<double>(values[values.size() / 2]);
}

/// Medians over the steps in which something carries an impulse.
void print_steps(const char* name, const SceneSpec& spec, double dt, int steps) {
  Scene scene = build_scene(spec);
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  TimeStepper stepper(scene, {dt});
  std::vector<double> times, solves, iterations, residuals;
  for (int i = 0; i < steps; ++i) {
    const double start = seconds();
    const StepReport report = stepper.step(projection);
    const double taken = seconds() - start;
    const auto is_pushed = [](const Rod& rod) {
      return std::any_of(rod.contact_impulse.begin(), rod.contact_impulse.end(),
                         [](const Vector6& impulse) { return !impulse.isZero(0); });
    };
    if (std::none_of(scene.rods.begin(), scene.rods.end(), is_pushed)) continue;
    times.push_back(taken);
    iterations.push_back(report.newton_iterations);
    residuals.push_back(report.contact_residual);
  }
  std::vector<LinearSystem> systems;
  std::vector<DirectFactor> factors;
  std::vector<VectorX> solutions;
  for (const Rod& rod : scene.rods) {
    systems.emplace_back(rod);
    factors.emplace_back(rod);
    solutions.push_back(VectorX::Zero(6 * rod.joint_count()));
  }
  for (int i = 0; i < 21; ++i) {
    const double start = seconds();
    for (std::size_t r = 0; r < scene.rods.size(); ++r) {
      systems[r].assemble(scene.rods[r], dt);
      factors[r].solve(scene.rods[r], systems[r], solutions[r]);
    }
    solves.push_back(seconds() - start);
  }
  const auto fine = std::count_if(residuals.begin(), residuals.end(), [](double residual) { return residual <= 1e-5; });
  const double step = median_of(times), solve = median_of(solves), newton = median_of(iterations);
  std::printf("%-14s %6zu %10.3f %10.3f %8.0f %16.1f %16.0f\n", name, times.size(), 1e3 * step, 1e3 * solve, newton,
              step / newton / solve, 100.0 * static_cast<double>(fine) / static_cast<double>(times.size()));
}

void print_steps() {
  std::printf("\nWhole steps in contact [ms], six Newton iterations at most\n");
  std::printf("%-14s %6s %10s %10s %8s %16s %16s\n", "scene", "steps", "step", "solve", "Newton", "solves/iteration",
              "residual<1e-5, %");
  auto lattice = dropped_octet_lattice();
  lattice.contact->friction = 0.5;
  print_steps("octet lattice", lattice, 0.004, 300);
  auto falling = touching<FallingRods>(0.03, 1e7, 1e7);
  falling.rods = 6;
  print_steps("falling rods", falling, 0.01, 100);
  auto heap = falling;
  heap.rods = 100;
  heap.height_m = 0.1;
  print_steps("heap", heap, 0.005, 300);
  print_steps("heap, .001 s", heap, 0.001, 1500);
  auto bundle = touching<Bundle>(0.01, 1e7, 1e7);
  bundle.initial_angle_deg = 20;
  print_steps("bundle", bundle, 0.005, 200);
  print_steps("bundle, .001 s", bundle, 0.001, 1000);
  auto knot = touching<Knot>(0.015, 1e6, 1e5);
  knot.segments = 60;
  knot.length_m = 2;
  knot.gravity_m_s2 = {0, 0, 0};
  knot.damping_per_s = 5;
  print_steps("knot", knot, 0.005, 200);
  auto coil = touching<CoilingRod>(0.01, 1e6, 1e5);
  coil.segments = 80;
  coil.length_m = 1.5;
  coil.height_m = 0.05;
  print_steps("coiling rod", coil, 0.005, 280);
}

void print_summary(const Medians& median) {
  std::printf("\nContact, per segment [us]: searching pairs anew, finding contacts of known pairs\n");
  std::printf("%8s %10s %8s %22s\n", "segments", "search", "find", "contacts per segment");
  for (const int n : sizes) {
    const auto us = [&](const char* name) { return median(name, n) / n * 1e6; };
    Fallen fallen(n);
    std::printf("%8d %10.3f %8.3f %22.2f\n", n, us("search"), us("find"),
                static_cast<double>(fallen.projection.contacts().size()) / n);
  }
  print_steps();
}

}  // namespace

int main(int argc, char** argv) {
  register_cases({{"search", search}, {"find", find}}, sizes);
  return run_benchmarks(argc, argv, print_summary);
}
