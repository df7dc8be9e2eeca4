// The cost of inference by message passing on one rod of 50 segments, and the share of its matrix products.
#include <array>
#include <cstdio>

#include "network/encoding/graph_encoding.hpp"
#include "network/layers/product.hpp"
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

  explicit Case(int latent = 32, int steps = 4) {
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

void encode(benchmark::State& state) {
  Case c;
  const Rod& rod = c.scene.rods.front();
  LinearSystem system(rod);
  system.assemble(rod, 0.02);
  const GraphEncoding encoding(Encoding::paper_residual, rod);
  for (auto _ : state) {
    encoding.encode(rod, system, 1, c.x_nodes, c.x_edges);
    benchmark::ClobberMemory();
  }
}

void message_passing(benchmark::State& state) {
  const Case c(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  MessagePassing<float>::Tape tape;
  Tensor<float> y;
  for (auto _ : state) {
    c.net.forward(c.parameters, c.graph, c.x_nodes, c.x_edges, tape, y);
    benchmark::ClobberMemory();
  }
}

/// Multiplies every matrix of the network by 50 columns.
void products(benchmark::State& state) {
  const Case c(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  std::vector<Tensor<float>> x, y;
  for (const auto& entry : c.parameters.entries()) {
    x.emplace_back(Tensor<float>::Random(entry.cols, segments));
    y.emplace_back(entry.rows, segments);
  }
  for (auto _ : state) {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (x[i].rows() > 1) multiply<float>(c.parameters[static_cast<int>(i)], nullptr, x[i], y[i]);
    benchmark::ClobberMemory();
  }
}

void print_summary(const Medians& median) {
  std::printf("\nInference on one rod of %d segments (target: at most 1.2 us per segment)\n", segments);
  std::printf("%8s %6s %12s %14s %10s %22s\n", "latent", "steps", "weights", "us/segment", "GFLOP/s",
              "products alone [%]");
  for (const auto& [latent, steps] : sizes) {
    const std::string arguments = "/" + std::to_string(latent) + "/" + std::to_string(steps);
    const double seconds = median("message_passing" + arguments);
    const auto weights = static_cast<double>(Case(latent, steps).parameters.values().size());
    std::printf("%8d %6d %12.0f %14.3f %10.0f %22.0f\n", latent, steps, weights, seconds / segments * 1e6,
                2 * weights * segments / seconds * 1e-9, 100 * median("products" + arguments) / seconds);
  }
  std::printf("Features: %.3f us per segment\n", median("encode/") / segments * 1e6);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::RegisterBenchmark("encode", encode);
  for (const auto& [latent, steps] : sizes) {
    benchmark::RegisterBenchmark("message_passing", message_passing)->Args({latent, steps});
    benchmark::RegisterBenchmark("products", products)->Args({latent, steps});
  }
  return run_benchmarks(argc, argv, print_summary);
}
