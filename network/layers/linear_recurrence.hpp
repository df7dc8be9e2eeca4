// A recurrence that is linear in its state, with gates that look at the inputs alone (Martin & Cundy 2018; Feng et al.
// 2024, "Were RNNs all we needed?"):
//   z = logistic(P_z),  h' = (1 - z) * P_c + z * h
// P = W x + b (2 H rows: z, c) is the caller's. Beside a gated recurrent unit (gru.hpp) nothing is multiplied by h but
// z, so that a step waits for one sum and no product of matrices.
#pragma once

#include "network/layers/gru.hpp"

namespace rodsweep {

template <class T>
struct LinearRecurrence {
  static constexpr int gates = 2;

  /// Columns [first, first + h.cols()) of the tape (z, c and h of it) and of `out`; `p_in` the same columns of P.
  static void forward(const TensorIn<T>& p_in, const TensorIn<T>& h, typename Gru<T>::Tape& tape, Eigen::Index first,
                      Eigen::Ref<Tensor<T>> out) {
    const Eigen::Index n = h.cols(), H = h.rows();
    auto z = tape.z.middleCols(first, n), c = tape.c.middleCols(first, n);
    z = p_in.topRows(H).array().logistic();
    c = p_in.bottomRows(H);
    tape.h.middleCols(first, n) = h;
    out = c.array() + z.array() * (h.array() - c.array());
  }

  /// From d_out: dP and dh (set) of the same columns.
  static void backward(const typename Gru<T>::Tape& tape, Eigen::Index first, const TensorIn<T>& d_out,
                       Eigen::Ref<Tensor<T>> dp, Eigen::Ref<Tensor<T>> dh) {
    const Eigen::Index n = d_out.cols(), H = d_out.rows();
    const auto z = tape.z.middleCols(first, n).array(), c = tape.c.middleCols(first, n).array();
    const auto h = tape.h.middleCols(first, n).array();
    const auto d = d_out.array();
    dp.topRows(H) = d * (h - c) * z * (T(1) - z);
    dp.bottomRows(H) = d * (T(1) - z);
    dh = d * z;
  }
};

}  // namespace rodsweep
