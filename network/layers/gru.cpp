#include "network/layers/gru.hpp"

#include "network/layers/product.hpp"

namespace rodsweep {

template <class T>
Gru<T>::Gru(Parameters<T>& parameters, const std::string& name, int size, WeightSource& source)
    : recurrent_(parameters.add(name + ".recurrent", 3 * size, size)), size_(size) {
  source.fill<T>(parameters[recurrent_]);
}

template <class T>
void Gru<T>::forward(const Parameters<T>& p, const TensorIn<T>& p_in, const TensorIn<T>& h, Tape& tape,
                     Eigen::Index first, Eigen::Ref<Tensor<T>> out) const {
  const Eigen::Index n = h.cols(), H = size_;
  Tensor<T> u = Tensor<T>::Zero(3 * H, n);
  add_product<T>(p[recurrent_], h, u);
  auto z = tape.z.middleCols(first, n), r = tape.r.middleCols(first, n), c = tape.c.middleCols(first, n);
  z = (p_in.topRows(H) + u.topRows(H)).array().logistic();
  r = (p_in.middleRows(H, H) + u.middleRows(H, H)).array().logistic();
  tape.uc.middleCols(first, n) = u.bottomRows(H);
  c = (p_in.bottomRows(H).array() + r.array() * u.bottomRows(H).array()).tanh();
  tape.h.middleCols(first, n) = h;
  out = c.array() + z.array() * (h.array() - c.array());
}

template <class T>
void Gru<T>::backward(const Parameters<T>& p, const Tape& tape, Eigen::Index first, const TensorIn<T>& d_out,
                      Parameters<T>& gradient, Eigen::Ref<Tensor<T>> dp, Eigen::Ref<Tensor<T>> dh) const {
  const Eigen::Index n = d_out.cols(), H = size_;
  const auto z = tape.z.middleCols(first, n).array(), r = tape.r.middleCols(first, n).array();
  const auto c = tape.c.middleCols(first, n).array(), uc = tape.uc.middleCols(first, n).array();
  const auto h = tape.h.middleCols(first, n).array();
  const auto d = d_out.array();
  Tensor<T> du(3 * H, n);
  dp.bottomRows(H) = d * (T(1) - z) * (T(1) - c * c);
  dp.topRows(H) = d * (h - c) * z * (T(1) - z);
  dp.middleRows(H, H) = dp.bottomRows(H).array() * uc * r * (T(1) - r);
  du.topRows(2 * H) = dp.topRows(2 * H);
  du.bottomRows(H) = dp.bottomRows(H).array() * r;
  add_outer_product<T>(du, tape.h.middleCols(first, n), gradient[recurrent_]);
  dh = d * z;
  add_transposed_product<T>(p[recurrent_], du, dh);
}

template class Gru<float>;
template class Gru<double>;

}  // namespace rodsweep
