#include "network/processor/graph_block.hpp"

#include "network/layers/product.hpp"
#include "network/layers/silu.hpp"

namespace rodsweep {
namespace {

/// Columns first[rod] to first[rod + 1].
template <class Matrix>
auto columns_of(Matrix& matrix, const std::vector<int>& first, int rod) {
  const int begin = first[static_cast<std::size_t>(rod)];
  return matrix.middleCols(begin, first[static_cast<std::size_t>(rod) + 1] - begin);
}

/// y_k += parts of x at both ends of every edge: rows [0, H) at the sender, [H, 2 H) at the receiver.
template <class T>
void add_from_ends(const RodGraph& graph, const Tensor<T>& x, Tensor<T>& y) {
  const Eigen::Index size = y.rows();
  for (int k = 0; k < graph.edges(); ++k)
    y.col(k) += x.col(graph.sender[static_cast<std::size_t>(k)]).head(size) +
                x.col(graph.receiver[static_cast<std::size_t>(k)]).segment(size, size);
}

/// The transpose: x_k added to the sender's rows [0, H) and the receiver's [H, 2 H).
template <class T>
void add_to_ends(const RodGraph& graph, const Tensor<T>& x, Tensor<T>& y) {
  const Eigen::Index size = x.rows();
  for (int k = 0; k < graph.edges(); ++k) {
    y.col(graph.sender[static_cast<std::size_t>(k)]).head(size) += x.col(k);
    y.col(graph.receiver[static_cast<std::size_t>(k)]).segment(size, size) += x.col(k);
  }
}

/// Column i of y += the column of x that belongs to i's rod.
template <class T>
void add_per_rod(const TensorIn<T>& x, const std::vector<int>& first, Tensor<T>& y) {
  for (int rod = 0; rod < x.cols(); ++rod) columns_of(y, first, rod).colwise() += x.col(rod);
}

/// The transpose: sums over the columns of every rod.
template <class T>
void sum_per_rod(const Tensor<T>& x, const std::vector<int>& first, Eigen::Ref<Tensor<T>> y) {
  for (int rod = 0; rod < y.cols(); ++rod) y.col(rod) = columns_of(x, first, rod).rowwise().sum();
}

/// Divides by the number of columns per rod: sums become means. A rod of one segment has no edges; their mean is zero.
template <class T>
void divide_by_count(const std::vector<int>& first, Eigen::Ref<Tensor<T>> y) {
  for (int rod = 0; rod < y.cols(); ++rod) {
    const int count = first[static_cast<std::size_t>(rod) + 1] - first[static_cast<std::size_t>(rod)];
    y.col(rod) /= static_cast<T>(std::max(count, 1));
  }
}

}  // namespace

template <class T>
GraphBlock<T>::GraphBlock(Parameters<T>& parameters, const std::string& name, int latent, int hidden_layers,
                          Updates updates, bool reads_globals, WeightSource& source)
    : latent_(latent) {
  // A first layer's parts share its fan-in, 3 H or 4 H.
  const double gain = std::sqrt(reads_globals ? 1 / 4.0 : 1 / 3.0);
  const bool nodes = updates != Updates::edges;
  const int readers = nodes ? 2 : 1;
  from_nodes_ = parameters.add(name + ".from_nodes", (readers + 1) * latent, latent);
  source.fill<T>(parameters[from_nodes_], gain);
  if (reads_globals) {
    from_globals_ = parameters.add(name + ".from_globals", readers * latent, latent);
    source.fill<T>(parameters[from_globals_], gain);
  }
  from_edges_ = Linear<T>(parameters, name + ".from_edges", latent, latent, source, gain);
  edge_deeper_ = HiddenLayers<T>(parameters, name + ".edge_hidden", latent, hidden_layers - 1, source);
  edge_out_ = Linear<T>(parameters, name + ".edge_out", latent, latent, source);
  if (!nodes) return;
  from_sums_ = Linear<T>(parameters, name + ".from_sums", 2 * latent, latent, source, std::sqrt(2.0) * gain);
  node_deeper_ = HiddenLayers<T>(parameters, name + ".node_hidden", latent, hidden_layers - 1, source);
  node_out_ = Linear<T>(parameters, name + ".node_out", latent, latent, source);
  if (updates == Updates::globals)
    global_ = Mlp<T>(parameters, name + ".global", (reads_globals ? 3 : 2) * latent, latent, latent, source, 1,
                     hidden_layers);
}

template <class T>
void GraphBlock<T>::forward(const Parameters<T>& p, const RodGraph& graph, const GraphState<T>& in, Updates updates,
                            Tape& tape, GraphState<T>& out) const {
  const Eigen::Index H = latent_, readers = updates == Updates::edges ? 1 : 2;
  tape.from_nodes.resize(p[from_nodes_].rows(), graph.nodes);
  multiply<T>(p[from_nodes_].topRows((readers + 1) * H), nullptr, in.nodes, tape.from_nodes.topRows((readers + 1) * H));
  if (from_globals_ >= 0) {
    tape.from_globals.resize(p[from_globals_].rows(), graph.rods());
    multiply<T>(p[from_globals_].topRows(readers * H), nullptr, in.globals, tape.from_globals.topRows(readers * H));
  }

  tape.edge_before.resize(H, graph.edges());
  from_edges_.forward(p, in.edges, tape.edge_before);
  add_from_ends(graph, tape.from_nodes, tape.edge_before);
  if (from_globals_ >= 0) add_per_rod<T>(tape.from_globals.topRows(H), graph.first_edge, tape.edge_before);
  tape.edge_hidden = silu(tape.edge_before.array());
  out.edges.resize(H, graph.edges());
  edge_out_.forward(p, edge_deeper_.forward(p, tape.edge_hidden, tape.edge_deeper), out.edges);
  out.edges += in.edges;
  if (updates == Updates::edges) return;

  tape.sums.setZero(2 * H, graph.nodes);
  add_to_ends(graph, out.edges, tape.sums);
  tape.node_before.resize(H, graph.nodes);
  from_sums_.forward(p, tape.sums, tape.node_before);
  tape.node_before += tape.from_nodes.bottomRows(H);
  if (from_globals_ >= 0) add_per_rod<T>(tape.from_globals.bottomRows(H), graph.first_node, tape.node_before);
  tape.node_hidden = silu(tape.node_before.array());
  out.nodes.resize(H, graph.nodes);
  node_out_.forward(p, node_deeper_.forward(p, tape.node_hidden, tape.node_deeper), out.nodes);
  out.nodes += in.nodes;
  if (updates == Updates::nodes) return;

  tape.means.resize(global_.in(), graph.rods());
  sum_per_rod<T>(out.edges, graph.first_edge, tape.means.topRows(H));
  sum_per_rod<T>(out.nodes, graph.first_node, tape.means.middleRows(H, H));
  divide_by_count<T>(graph.first_edge, tape.means.topRows(H));
  divide_by_count<T>(graph.first_node, tape.means.middleRows(H, H));
  if (from_globals_ >= 0) tape.means.bottomRows(H) = in.globals;
  global_.forward(p, tape.means, tape.global, out.globals);
  if (from_globals_ >= 0) out.globals += in.globals;
}

template <class T>
void GraphBlock<T>::backward(const Parameters<T>& p, const RodGraph& graph, const GraphState<T>& in, Updates updates,
                             const Tape& tape, GraphState<T>& d, Parameters<T>& gradient) const {
  const Eigen::Index H = latent_, readers = updates == Updates::edges ? 1 : 2;
  if (updates == Updates::globals) {
    Tensor<T> d_means = Tensor<T>::Zero(global_.in(), graph.rods());
    global_.backward(p, tape.means, tape.global, d.globals, gradient, &d_means);
    if (from_globals_ >= 0) d.globals += d_means.bottomRows(H);
    divide_by_count<T>(graph.first_edge, d_means.topRows(H));
    divide_by_count<T>(graph.first_node, d_means.middleRows(H, H));
    add_per_rod<T>(d_means.topRows(H), graph.first_edge, d.edges);
    add_per_rod<T>(d_means.middleRows(H, H), graph.first_node, d.nodes);
  }
  Tensor<T> d_from_nodes = Tensor<T>::Zero((readers + 1) * H, graph.nodes);
  Tensor<T> d_from_globals(from_globals_ < 0 ? 0 : readers * H, graph.rods());

  if (updates != Updates::edges) {
    Tensor<T> d_before = Tensor<T>::Zero(H, graph.nodes), d_sums = Tensor<T>::Zero(2 * H, graph.nodes);
    node_out_.backward(p, node_deeper_.output(tape.node_hidden, tape.node_deeper), d.nodes, gradient, &d_before);
    node_deeper_.backward(p, tape.node_hidden, tape.node_deeper, d_before, gradient);
    d_before.array() *= silu_derivative(tape.node_before.array());
    from_sums_.backward(p, tape.sums, d_before, gradient, &d_sums);
    add_from_ends(graph, d_sums, d.edges);
    d_from_nodes.bottomRows(H) = d_before;
    if (from_globals_ >= 0) sum_per_rod<T>(d_before, graph.first_node, d_from_globals.bottomRows(H));
  }

  Tensor<T> d_before = Tensor<T>::Zero(H, graph.edges());
  edge_out_.backward(p, edge_deeper_.output(tape.edge_hidden, tape.edge_deeper), d.edges, gradient, &d_before);
  edge_deeper_.backward(p, tape.edge_hidden, tape.edge_deeper, d_before, gradient);
  d_before.array() *= silu_derivative(tape.edge_before.array());
  from_edges_.backward(p, in.edges, d_before, gradient, &d.edges);
  add_to_ends(graph, d_before, d_from_nodes);
  add_outer_product<T>(d_from_nodes, in.nodes, gradient[from_nodes_].topRows((readers + 1) * H));
  add_transposed_product<T>(p[from_nodes_].topRows((readers + 1) * H), d_from_nodes, d.nodes);
  if (from_globals_ < 0) return;
  sum_per_rod<T>(d_before, graph.first_edge, d_from_globals.topRows(H));
  add_outer_product<T>(d_from_globals, in.globals, gradient[from_globals_].topRows(readers * H));
  add_transposed_product<T>(p[from_globals_].topRows(readers * H), d_from_globals, d.globals);
}

template class GraphBlock<float>;
template class GraphBlock<double>;

}  // namespace rodsweep
