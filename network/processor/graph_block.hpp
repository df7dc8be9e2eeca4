// One step of a graph network (Battaglia et al. 2018, algorithm 1) with residual connections, latent size H:
//   e'_k = e_k + phi([e_k; v_s; v_r; u])           every edge k from sender s to receiver r
//   v'_i = v_i + psi([v_i; S_i; R_i; u])           S_i, R_i: sums of e' over the edges that i sends and receives
//   u'   = u + MLP([mean e'; mean v'; u])          per rod; only with a global state, which is 0 before the first
// phi and psi are MLPs with one hidden layer or more, whose first matrix is kept in parts: W [e; v_s; v_r] is
// W_e e + (W_s v)_s + (W_r v)_r, so nothing is concatenated and two thirds of the work are done per node. W_s, W_r and
// the part of psi's matrix that multiplies v are one product.
#pragma once

#include "network/graph/rod_graph.hpp"
#include "network/layers/mlp.hpp"

namespace rodsweep {

/// The state between steps.
template <class T>
struct GraphState {
  Tensor<T> nodes, edges, globals;  ///< [H, nodes], [H, edges], [H, rods]
};

/// The parts that a step updates: each includes those before it.
enum class Updates { edges, nodes, globals };

template <class T>
class GraphBlock {
 public:
  /// What backward() needs of forward(); reused from batch to batch.
  struct Tape {
    Tensor<T> from_nodes;                ///< W_s v, W_r v and psi's W_v v
    Tensor<T> from_globals;              ///< phi's W_u u and psi's
    Tensor<T> edge_before, edge_hidden;  ///< phi's hidden layer, before silu and after
    Tensor<T> sums;                      ///< S and R
    Tensor<T> node_before, node_hidden;  ///< psi's
    typename HiddenLayers<T>::Tape edge_deeper, node_deeper;
    Tensor<T> means;  ///< mean e', mean v', u
    typename Mlp<T>::Tape global;
  };

  GraphBlock() = default;
  /// `updates`: the parts that the block can change; `reads_globals`: the block has u as an input.
  GraphBlock(Parameters<T>& parameters, const std::string& name, int latent, int hidden_layers, Updates updates,
             bool reads_globals, WeightSource& source);

  /// Sets the parts of `out` that `updates` includes.
  void forward(const Parameters<T>& p, const RodGraph& graph, const GraphState<T>& in, Updates updates, Tape& tape,
               GraphState<T>& out) const;
  /// `d`: on entry the gradient with respect to the state after the step, on return to the state before it.
  void backward(const Parameters<T>& p, const RodGraph& graph, const GraphState<T>& in, Updates updates,
                const Tape& tape, GraphState<T>& d, Parameters<T>& gradient) const;

 private:
  int latent_ = 0, from_nodes_ = -1, from_globals_ = -1;
  Linear<T> from_edges_, edge_out_, from_sums_, node_out_;
  HiddenLayers<T> edge_deeper_, node_deeper_;
  Mlp<T> global_;
};

}  // namespace rodsweep
