// The error after several corrections with factors of all couplings: conjugate gradients with the factors as
// preconditioner.
//
// With F the matrix of network/processor/coupled_passes.hpp and r_0 = r^, E_0 = (x - x_base)^T A^ (x - x_base),
//   z_i = F r_i,  p_i = z_i + (r_i.z_i / r_i-1.z_i-1) p_i-1,  a_i = r_i.z_i / p_i.A^ p_i,  r_i+1 = r_i - a_i A^ p_i
//   E_i+1 = E_i - a_i r_i.z_i,   L = sqrt(E_k / max(x^T A x, E_0))
// The error after one correction predicts little about the next: it can be small although F is a bad preconditioner.
// E_k is the minimum over all polynomials in F A^. Therefore, as in energy_loss.hpp, the gradient is exact with a_i and
// the coefficients of p_i-1 held fixed.
#pragma once

#include "network/processor/coupled_passes.hpp"

namespace rodsweep {

template <class T>
class CorrectionLoss {
 public:
  explicit CorrectionLoss(int corrections) : steps_(static_cast<std::size_t>(corrections)) {}

  /// The sum of L over the systems for factors [93, places]; sets d_factors, dL / dfactors, if given.
  double operator()(const ScaledSystem<T>& systems, const TensorIn<T>& factors, Tensor<T>* d_factors);

 private:
  struct Step {
    CoupledPasses<T> answer;
    Tensor<T> p, ap;
    std::vector<T> length, kept;  ///< per system: a_i, and the coefficient of p_i-1 in p_i
  };
  void go_back(const ScaledSystem<T>& systems, const TensorIn<T>& factors, Tensor<T> dx, Tensor<T>& d_factors);

  std::vector<Step> steps_;
  Tensor<T> r_;
};

}  // namespace rodsweep
