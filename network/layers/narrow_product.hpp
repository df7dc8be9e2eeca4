// y = W x + b of inference with operands of 16 bits if the processor supports them (bfloat16, AVX512_BF16), with half the
// loads and multiplications of product.hpp; else in single precision. Sums are in single precision.
#pragma once

#include <cstdint>

#include "network/layers/float_lanes.hpp"
#include "network/layers/tensor.hpp"

namespace rodsweep {

#if defined(__AVX512BF16__)
using Narrow = std::uint16_t;  ///< the upper half of a float
constexpr int narrow_bits = 16;
#else
using Narrow = float;
constexpr int narrow_bits = 32;
#endif

/// A lane of floats, rounded to the nearest.
void store_narrow(Narrow* to, const FloatLane& values);
/// Any number of them.
void narrow(const float* from, Eigen::Index count, Narrow* to);

/// Columns of operands of even length: an odd column is padded with a zero.
using NarrowColumns = Eigen::Matrix<Narrow, Eigen::Dynamic, Eigen::Dynamic>;
constexpr Eigen::Index narrow_length(Eigen::Index depth) { return depth + depth % 2; }

class NarrowMatrix {
 public:
  NarrowMatrix() = default;
  /// Throws std::invalid_argument unless the number of rows is a multiple of a lane (float_lanes.hpp).
  explicit NarrowMatrix(const TensorIn<float>& weight);

  /// Sets y [rows, items] to W x + bias [rows] (null: 0), x [narrow_length(depth), items].
  void multiply(const float* bias, const Eigen::Ref<const NarrowColumns>& x, Eigen::Ref<Tensor<float>> y) const;

 private:
  Eigen::Index rows_ = 0, length_ = 0;
  AlignedVector<Narrow> entries_;  ///< by pairs of columns, in them by rows, in them the pair; or by columns
};

}  // namespace rodsweep
