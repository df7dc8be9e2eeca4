// Two gated recurrent sweeps over the joints of trees, the network's counterpart of a block factorisation's two passes:
//   e_k = silu(W_e x_k + b_e)
//   h_k = up(W_u e_k, sum over children c of h_c)                tips to roots
//   g_k = down(W_d [e_k; h_k], g_parent)                         roots to tips
//   y_k = MLP([h_k; g_k])
// up and down are gated recurrent units (gru.hpp) or linear in the state (linear_recurrence.hpp).
// Every output has seen the whole tree at O(n) cost. Items are in the order of a JointForest.
#pragma once

#include "network/encoding/coping_net_settings.hpp"
#include "network/graph/joint_forest.hpp"
#include "network/layers/linear_recurrence.hpp"
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
  Sweeps(Parameters<T>& parameters, int in, int latent, int out, Recurrence recurrence, WeightSource& source);

  void forward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, Tape& tape, Tensor<T>& y) const;
  /// Adds to `gradient`; inputs are data, so nothing flows to x.
  void backward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, const Tape& tape,
                const TensorIn<T>& dy, Parameters<T>& gradient) const;

  int latent() const { return latent_; }
  Recurrence recurrence() const { return recurrence_; }
  /// What network/processor/sweeps_inference.cpp works with.
  struct Layers {
    const Linear<T>&encode, &to_up, &to_down;
    const Gru<T>&up, &down;
    const Mlp<T>& decode;
  };
  Layers layers() const { return {encode_, to_up_, to_down_, up_, down_, decode_}; }

 private:
  int gates() const { return recurrence_ == Recurrence::gated ? 3 : LinearRecurrence<T>::gates; }
  void step(const Parameters<T>& p, const Gru<T>& gru, const TensorIn<T>& p_in, const TensorIn<T>& h,
            typename Gru<T>::Tape& tape, Eigen::Index first, Eigen::Ref<Tensor<T>> out) const;
  void step_back(const Parameters<T>& p, const Gru<T>& gru, const typename Gru<T>::Tape& tape, Eigen::Index first,
                 const TensorIn<T>& d_out, Parameters<T>& gradient, Eigen::Ref<Tensor<T>> dp,
                 Eigen::Ref<Tensor<T>> dh) const;

  int latent_ = 0;
  Recurrence recurrence_ = Recurrence::gated;
  Linear<T> encode_, to_up_, to_down_;
  Gru<T> up_, down_;  ///< empty where the recurrence is linear
  Mlp<T> decode_;
};

}  // namespace rodsweep
