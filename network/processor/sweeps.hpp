// Two gated recurrent sweeps over the joints of trees, the network's counterpart of a block factorisation's two passes:
//   e_k = silu(W_e x_k + b_e)
//   h_k = GRU_up(W_u e_k, sum over children c of h_c)            tips to roots
//   g_k = GRU_down(W_d [e_k; h_k], g_parent)                     roots to tips
//   y_k = MLP([h_k; g_k])
// Every output has seen the whole tree at O(n) cost. Items are in the order of a JointForest.
#pragma once

#include "network/graph/joint_forest.hpp"
#include "network/layers/gru.hpp"
#include "network/layers/mlp.hpp"

namespace rodsweep {

template <class T>
class Sweeps {
 public:
  struct Tape {
    Tensor<T> before, e, p_up, up, joined, p_down, down, decoded_in;
    typename Gru<T>::Tape up_gates, down_gates;
    typename Mlp<T>::Tape decoder;
  };

  Sweeps() = default;
  /// Features in, latent size, outputs per joint.
  Sweeps(Parameters<T>& parameters, int in, int latent, int out, WeightSource& source);

  void forward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, Tape& tape, Tensor<T>& y) const;
  /// Adds to `gradient`; inputs are data, so nothing flows to x.
  void backward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, const Tape& tape,
                const TensorIn<T>& dy, Parameters<T>& gradient) const;

  int latent() const { return latent_; }
  /// What network/processor/sweeps_inference.cpp works with.
  struct Layers {
    const Linear<T>&encode, &to_up, &to_down;
    const Gru<T>&up, &down;
    const Mlp<T>& decode;
  };
  Layers layers() const { return {encode_, to_up_, to_down_, up_, down_, decode_}; }

 private:
  int latent_ = 0;
  Linear<T> encode_, to_up_, to_down_;
  Gru<T> up_, down_;
  Mlp<T> decode_;
};

}  // namespace rodsweep
