#include "network/layers/linear.hpp"

#include "network/layers/product.hpp"

namespace rodsweep {

template <class T>
Linear<T>::Linear(Parameters<T>& parameters, const std::string& name, int in, int out, WeightSource& source,
                  double gain)
    : weight_(parameters.add(name + ".weight", out, in)),
      bias_(parameters.add(name + ".bias", out, 1)),
      in_(in),
      out_(out) {
  source.fill<T>(parameters[weight_], gain);
}

template <class T>
void Linear<T>::forward(const Parameters<T>& p, const TensorIn<T>& x, Eigen::Ref<Tensor<T>> y) const {
  multiply<T>(p[weight_], p[bias_].data(), x, y);
}

template <class T>
void Linear<T>::backward(const Parameters<T>& p, const TensorIn<T>& x, const TensorIn<T>& dy, Parameters<T>& gradient,
                         Tensor<T>* dx) const {
  add_outer_product<T>(dy, x, gradient[weight_]);
  gradient[bias_] += dy.rowwise().sum();
  if (dx) add_transposed_product<T>(p[weight_], dy, *dx);
}

template class Linear<float>;
template class Linear<double>;

}  // namespace rodsweep
