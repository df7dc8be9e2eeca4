// The error of a guess in the norm that CG minimises.
//
// The network's d^ is the direction of a correction. Its length is the best one, c = d^.r^ / d^.A^ d^, or c = 1 without
// `best_length`. The loss of a system is the energy norm of the remaining error, relative to that of the zero guess, or of
// the base if that is worse. With the best length
//   L = sqrt(E / max(x^T A x, E_base)),   E = min over c of |x - x_base - c d|_A^2 = E_base - (d^.r^)^2 / d^.A^ d^
// In the loop, E is taken after k further steps of Jacobi-preconditioned CG. CG multiplies the error by the polynomial
// in A^ that minimises E. By the envelope theorem the gradient is exact with the polynomial held fixed: with
// e_k = P_k(A^) e_0,  dE_k/de_0 = 2 P_k(A^) A^ e_k.
#pragma once

#include "network/encoding/scaled_system.hpp"

namespace rodsweep {

template <class T>
class EnergyLoss {
 public:
  explicit EnergyLoss(int cg_steps = 0, bool best_length = true) : cg_steps_(cg_steps), best_length_(best_length) {}

  /// The sum of L over the systems for d^ [6, places]; sets `gradient`, dL/dd^, if given.
  double operator()(const ScaledSystem<T>& systems, const TensorIn<T>& d, Tensor<T>* gradient);

 private:
  struct CgStep {
    std::vector<T> alpha, beta;  ///< per system
  };
  void iterate(const ScaledSystem<T>& a);
  void apply_polynomial(const ScaledSystem<T>& a);

  int cg_steps_;
  bool best_length_;
  Tensor<T> ad_, r_, p_, ap_, v_;
  std::vector<CgStep> steps_;
  std::vector<double> energy_;
};

}  // namespace rodsweep
