// A solve with given factors over all couplings of a matrix, and its derivatives with respect to the factors.
//
// For every pair of coupled places k > j, with B_kj the block of row k and column j, and s = 0, 1 the number of k's
// segment that couples them,
//   h_j = r_j - sum over rows k > j of B_kj^T T_ks^T h_k                      last place to first
//   v_ks = -sum over columns j < k on s of B_kj y_j,  y_k = N_k h_k + sum over s of T_ks v_ks     first to last
// so that y = (1 + M)^-1 N (1 + M^T)^-1 r, M_kj = T_ks B_kj: linear in r, and symmetric and positive definite if N is,
// for any T.
//
// Block IC(0) of this order is a special case. All joints that share a segment are coupled, B_kj = J_k W J_j^T with the
// segment's inverse mass W. Eliminating another of its joints changes W only: IC(0) replaces B_kj by J_k W' J_j^T,
// which is a matrix of k and s times B_kj. With T_ks = N_k = S_k^-1 instead (D-ILU: Barrett et al. 1994, section
// 3.4.3), pivots of lattices are indefinite.
//
// Factors are N_k's lower triangle by columns (21 entries), T_k0 and T_k1 by columns (36 each). A state longer than
// `longest_state` is dropped, because a product of many T may grow without bound during training.
#pragma once

#include "network/encoding/scaled_system.hpp"

namespace rodsweep {

template <class T>
struct CoupledPasses {
  static constexpr int triangle = 21, size = triangle + 2 * 36;
  static constexpr T longest_state = 1e4;

  Tensor<T> h, v, y;  ///< [6, places], [12, places], [6, places]

  /// Sets h, v and y from factors [93, places] and r [6, places].
  void forward(const ScaledSystem<T>& a, const TensorIn<T>& factors, const TensorIn<T>& r);
  /// Sets the derivatives with respect to the factors, [93, places], from those with respect to y.
  void backward(const ScaledSystem<T>& a, const TensorIn<T>& factors, const TensorIn<T>& dy,
                Tensor<T>& d_factors) const;
};

}  // namespace rodsweep
