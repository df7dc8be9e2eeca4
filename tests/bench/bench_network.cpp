// The cost of inference by message passing on one rod of 50 segments.
#include <array>
#include <cstdio>

#include "network/encoding/graph_encoding.hpp"
#include "network/processor/message_passing.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/bench/medians.hpp"

namespace {

using namespace rodsweep;

constexpr int segments = 50;
constexpr std::array<std::array<int, 2>, 4> sizes{{{32, 4}, {32, 6}, {64, 4}, {64, 6}}};  // latent, steps

/// A rod and a network as a guess for CG uses it: outputs for joints only.
struct Case {
  Scene scene;
  RodGraph graph;
  Parameters<float> parameters;
  MessagePassing<float> net;
  Tensor<float> x_nodes, x_edges;

  Case(int latent, int steps) {
    BendingRod spec;
    spec.segments = segments;
    scene = build_scene(spec);
    graph = rod_graph(scene.rods.front());
    WeightSource source(1);
    const int node_in = GraphEncoding::node_features(Encoding::paper_residual);
    const int edge_in = GraphEncoding::edge_features(Encoding::paper_residual);
    net = MessagePassing<float>(parameters, {node_in, edge_in, latent, steps, 6, 0, false}, source);
    x_nodes = Tensor<float>::Random(node_in, graph.nodes);
    x_edges = Tensor<float>::Random(edge_in, graph.edges());
  }
};

void message_passing(benchmark::State& state) {
  const Case c(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  MessagePassing<float>::Tape tape;
  Tensor<float> y;
  for (auto _ : state) {
    c.net.forward(c.parameters, c.graph, c.x_nodes, c.x_edges, tape, y);
    benchmark::ClobberMemory();
  }
}

void print_summary(const Medians& median) {
  std::printf("\nInference on one rod of %d segments (target: at most 1.2 us per segment)\n", segments);
  std::printf("%8s %6s %12s %14s %10s\n", "latent", "steps", "weights", "us/segment", "GFLOP/s");
  for (const auto& [latent, steps] : sizes) {
    const double seconds = median("message_passing/" + std::to_string(latent) + "/" + std::to_string(steps));
    const auto weights = static_cast<double>(Case(latent, steps).parameters.values().size());
    std::printf("%8d %6d %12.0f %14.3f %10.0f\n", latent, steps, weights, seconds / segments * 1e6,
                2 * weights * segments / seconds * 1e-9);
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (const auto& [latent, steps] : sizes)
    benchmark::RegisterBenchmark("message_passing", message_passing)->Args({latent, steps});
  return run_benchmarks(argc, argv, print_summary);
}
