#include "network/layers/hidden_layers.hpp"

#include "network/layers/silu.hpp"

namespace rodsweep {

template <class T>
HiddenLayers<T>::HiddenLayers(Parameters<T>& parameters, const std::string& name, int width, int count,
                              WeightSource& source) {
  for (int k = 0; k < count; ++k)
    layers_.emplace_back(parameters, name + "." + std::to_string(k), width, width, source);
}

template <class T>
const Tensor<T>& HiddenLayers<T>::forward(const Parameters<T>& p, const Tensor<T>& x, Tape& tape) const {
  tape.before.resize(layers_.size());
  tape.after.resize(layers_.size());
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    const Tensor<T>& in = k == 0 ? x : tape.after[k - 1];
    tape.before[k].resize(in.rows(), in.cols());
    layers_[k].forward(p, in, tape.before[k]);
    tape.after[k] = silu(tape.before[k].array());
  }
  return output(x, tape);
}

template <class T>
void HiddenLayers<T>::backward(const Parameters<T>& p, const Tensor<T>& x, const Tape& tape, Tensor<T>& d,
                               Parameters<T>& gradient) const {
  Tensor<T> d_before;
  for (std::size_t k = layers_.size(); k-- > 0;) {
    d_before = d.array() * silu_derivative(tape.before[k].array());
    d.setZero();
    layers_[k].backward(p, k == 0 ? x : tape.after[k - 1], d_before, gradient, &d);
  }
}

template class HiddenLayers<float>;
template class HiddenLayers<double>;

}  // namespace rodsweep
