// y = W x + b of inference, with 16-bit operands if the processor supports them (bfloat16, AVX512_BF16), else in single
// precision. 16 bits halve the loads and multiplications of product.hpp. Sums are in single precision.
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

/// Stores a lane of floats, rounded to nearest.
void store_narrow(Narrow* to, const FloatLane& values);
/// Stores any number of floats, rounded to nearest.
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
  AlignedVector<Narrow> entries_;  ///< 16 bits: [pair of columns][row][2]; 32 bits: [column][row]
};

}  // namespace rodsweep
