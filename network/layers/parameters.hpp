// All weights of a network in one flat array of named matrices, which Adam updates, ranks sum, and files store.
//
// Layers keep the index of their matrices, so a gradient is just another Parameters of the same shapes. Each matrix
// begins at a multiple of 16 entries; the gaps stay zero.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "network/layers/tensor.hpp"
#include "solver/numbers/counter_random.hpp"

namespace rodsweep {

template <class T>
class Parameters {
 public:
  struct Entry {
    std::string name;
    int rows, cols;
    std::size_t offset;  ///< in values()
  };
  using Map = Eigen::Map<Tensor<T>>;
  using ConstMap = Eigen::Map<const Tensor<T>>;

  /// Adds a matrix of zeros; returns its index.
  int add(const std::string& name, int rows, int cols) {
    entries_.push_back({name, rows, cols, values_.size()});
    const std::size_t size = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
    values_.resize(values_.size() + (size + 15) / 16 * 16, T(0));
    return static_cast<int>(entries_.size()) - 1;
  }

  Map operator[](int index) {
    const Entry& e = entries_[static_cast<std::size_t>(index)];
    return {values_.data() + e.offset, e.rows, e.cols};
  }
  ConstMap operator[](int index) const {
    const Entry& e = entries_[static_cast<std::size_t>(index)];
    return {values_.data() + e.offset, e.rows, e.cols};
  }

  const std::vector<Entry>& entries() const { return entries_; }
  AlignedVector<T>& values() { return values_; }
  const AlignedVector<T>& values() const { return values_; }

  /// The same matrices, all zero.
  Parameters zeros() const {
    Parameters out = *this;
    std::fill(out.values_.begin(), out.values_.end(), T(0));
    return out;
  }

 private:
  std::vector<Entry> entries_;
  AlignedVector<T> values_;
};

/// Draws initial weights: uniform in +-sqrt(3 / fan_in) times `gain`, the same on every machine.
class WeightSource {
 public:
  explicit WeightSource(std::uint64_t seed) : random_(seed) {}
  template <class T>
  void fill(Eigen::Map<Tensor<T>> weights, double gain = 1) {
    const double bound = gain * std::sqrt(3.0 / static_cast<double>(weights.cols()));
    for (Eigen::Index c = 0; c < weights.cols(); ++c)
      for (Eigen::Index r = 0; r < weights.rows(); ++r)
        weights(r, c) = static_cast<T>(bound * (2 * random_.uniform() - 1));
  }

 private:
  SplitMix random_;
};

}  // namespace rodsweep
