#include "network/layers/mlp.hpp"

#include "network/layers/silu.hpp"

namespace rodsweep {

template <class T>
Mlp<T>::Mlp(Parameters<T>& parameters, const std::string& name, int in, int hidden, int out, WeightSource& source,
            double last_gain, int hidden_layers)
    : first_(parameters, name + ".0", in, hidden, source),
      second_(parameters, name + ".1", hidden, out, source, last_gain),
      deeper_(parameters, name + ".hidden", hidden, hidden_layers - 1, source) {}

template <class T>
void Mlp<T>::forward(const Parameters<T>& p, const TensorIn<T>& x, Tape& tape, Tensor<T>& y) const {
  tape.before.resize(first_.out(), x.cols());
  first_.forward(p, x, tape.before);
  tape.hidden = silu(tape.before.array());
  y.resize(second_.out(), x.cols());
  second_.forward(p, deeper_.forward(p, tape.hidden, tape.deeper), y);
}

template <class T>
void Mlp<T>::backward(const Parameters<T>& p, const TensorIn<T>& x, const Tape& tape, const TensorIn<T>& dy,
                      Parameters<T>& gradient, Tensor<T>* dx) const {
  Tensor<T> d = Tensor<T>::Zero(tape.hidden.rows(), tape.hidden.cols());
  second_.backward(p, deeper_.output(tape.hidden, tape.deeper), dy, gradient, &d);
  deeper_.backward(p, tape.hidden, tape.deeper, d, gradient);
  d.array() *= silu_derivative(tape.before.array());
  first_.backward(p, x, d, gradient, dx);
}

template class Mlp<float>;
template class Mlp<double>;

}  // namespace rodsweep
