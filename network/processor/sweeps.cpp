#include "network/processor/sweeps.hpp"

#include "network/layers/silu.hpp"

namespace rodsweep {
namespace {

template <class T>
void resize(typename Gru<T>::Tape& tape, int size, Eigen::Index items) {
  for (Tensor<T>* part : {&tape.z, &tape.r, &tape.c, &tape.uc, &tape.h}) part->resize(size, items);
}

}  // namespace

template <class T>
Sweeps<T>::Sweeps(Parameters<T>& parameters, int in, int latent, int out, Recurrence recurrence, WeightSource& source)
    : latent_(latent),
      recurrence_(recurrence),
      encode_(parameters, "encode", in, latent, source),
      to_up_(parameters, "to_up", latent, gates() * latent, source),
      to_down_(parameters, "to_down", 2 * latent, gates() * latent, source),
      up_(recurrence == Recurrence::gated ? Gru<T>(parameters, "up", latent, source) : Gru<T>()),
      down_(recurrence == Recurrence::gated ? Gru<T>(parameters, "down", latent, source) : Gru<T>()),
      decode_(parameters, "decode", 2 * latent, latent, out, source, 0.1) {}

template <class T>
void Sweeps<T>::step(const Parameters<T>& p, const Gru<T>& gru, const TensorIn<T>& p_in, const TensorIn<T>& h,
                     typename Gru<T>::Tape& tape, Eigen::Index first, Eigen::Ref<Tensor<T>> out) const {
  if (recurrence_ == Recurrence::gated)
    gru.forward(p, p_in, h, tape, first, out);
  else
    LinearRecurrence<T>::forward(p_in, h, tape, first, out);
}

template <class T>
void Sweeps<T>::step_back(const Parameters<T>& p, const Gru<T>& gru, const typename Gru<T>::Tape& tape,
                          Eigen::Index first, const TensorIn<T>& d_out, Parameters<T>& gradient,
                          Eigen::Ref<Tensor<T>> dp, Eigen::Ref<Tensor<T>> dh) const {
  if (recurrence_ == Recurrence::gated)
    gru.backward(p, tape, first, d_out, gradient, dp, dh);
  else
    LinearRecurrence<T>::backward(tape, first, d_out, dp, dh);
}

template <class T>
void Sweeps<T>::forward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, Tape& tape,
                        Tensor<T>& y) const {
  const Eigen::Index n = x.cols();
  tape.before.resize(latent_, n);
  encode_.forward(p, x, tape.before);
  tape.e = silu(tape.before.array());
  tape.p_up.resize(gates() * latent_, n);
  to_up_.forward(p, tape.e, tape.p_up);
  resize<T>(tape.up_gates, latent_, n);
  resize<T>(tape.down_gates, latent_, n);
  tape.decoded_in.resize(2 * latent_, n);
  tape.up.resize(latent_, n);
  tape.down.resize(latent_, n);

  Tensor<T> into;
  for (int level = forest.levels() - 1; level >= 0; --level) {
    const int begin = forest.level_begin[static_cast<std::size_t>(level)];
    const int end = forest.level_begin[static_cast<std::size_t>(level) + 1];
    into.setZero(latent_, end - begin);
    if (level + 1 < forest.levels())
      for (int i = end; i < forest.level_begin[static_cast<std::size_t>(level) + 2]; ++i)
        into.col(forest.parent[static_cast<std::size_t>(i)] - begin) += tape.up.col(i);
    step(p, up_, tape.p_up.middleCols(begin, end - begin), into, tape.up_gates, begin,
         tape.up.middleCols(begin, end - begin));
  }
  tape.joined.resize(2 * latent_, n);
  tape.joined.topRows(latent_) = tape.e;
  tape.joined.bottomRows(latent_) = tape.up;
  tape.p_down.resize(gates() * latent_, n);
  to_down_.forward(p, tape.joined, tape.p_down);
  for (int level = 0; level < forest.levels(); ++level) {
    const int begin = forest.level_begin[static_cast<std::size_t>(level)];
    const int end = forest.level_begin[static_cast<std::size_t>(level) + 1];
    into.setZero(latent_, end - begin);
    if (level > 0)
      for (int i = begin; i < end; ++i) into.col(i - begin) = tape.down.col(forest.parent[static_cast<std::size_t>(i)]);
    step(p, down_, tape.p_down.middleCols(begin, end - begin), into, tape.down_gates, begin,
         tape.down.middleCols(begin, end - begin));
  }
  tape.decoded_in.topRows(latent_) = tape.up;
  tape.decoded_in.bottomRows(latent_) = tape.down;
  decode_.forward(p, tape.decoded_in, tape.decoder, y);
}

template <class T>
void Sweeps<T>::backward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, const Tape& tape,
                         const TensorIn<T>& dy, Parameters<T>& gradient) const {
  const Eigen::Index n = x.cols();
  Tensor<T> d_decoded = Tensor<T>::Zero(2 * latent_, n);
  decode_.backward(p, tape.decoded_in, tape.decoder, dy, gradient, &d_decoded);
  Tensor<T> d_up = d_decoded.topRows(latent_), d_down = d_decoded.bottomRows(latent_);

  Tensor<T> dp(gates() * latent_, n), d_into;
  for (int level = forest.levels() - 1; level >= 0; --level) {
    const int begin = forest.level_begin[static_cast<std::size_t>(level)];
    const int end = forest.level_begin[static_cast<std::size_t>(level) + 1];
    d_into.resize(latent_, end - begin);
    step_back(p, down_, tape.down_gates, begin, d_down.middleCols(begin, end - begin), gradient,
              dp.middleCols(begin, end - begin), d_into);
    if (level > 0)
      for (int i = begin; i < end; ++i) d_down.col(forest.parent[static_cast<std::size_t>(i)]) += d_into.col(i - begin);
  }
  Tensor<T> d_joined = Tensor<T>::Zero(2 * latent_, n);
  to_down_.backward(p, tape.joined, dp, gradient, &d_joined);
  d_up += d_joined.bottomRows(latent_);

  for (int level = 0; level < forest.levels(); ++level) {
    const int begin = forest.level_begin[static_cast<std::size_t>(level)];
    const int end = forest.level_begin[static_cast<std::size_t>(level) + 1];
    d_into.resize(latent_, end - begin);
    step_back(p, up_, tape.up_gates, begin, d_up.middleCols(begin, end - begin), gradient,
              dp.middleCols(begin, end - begin), d_into);
    if (level + 1 < forest.levels())
      for (int i = end; i < forest.level_begin[static_cast<std::size_t>(level) + 2]; ++i)
        d_up.col(i) += d_into.col(forest.parent[static_cast<std::size_t>(i)] - begin);
  }
  Tensor<T> d_e = d_joined.topRows(latent_);
  to_up_.backward(p, tape.e, dp, gradient, &d_e);
  d_e.array() *= silu_derivative(tape.before.array());
  encode_.backward(p, x, d_e, gradient, nullptr);
}

template class Sweeps<float>;
template class Sweeps<double>;

}  // namespace rodsweep
