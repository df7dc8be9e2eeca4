#include "network/layers/narrow_product.hpp"

#include <stdexcept>
#include <string>

#include "network/layers/product.hpp"

#if defined(__AVX512BF16__)
#include <immintrin.h>
#endif

namespace rodsweep {

NarrowMatrix::NarrowMatrix(const TensorIn<float>& weight)
    : rows_(weight.rows()), length_(narrow_length(weight.cols())) {
  if (rows_ % lane_floats != 0)
    throw std::invalid_argument("NarrowMatrix: " + std::to_string(rows_) + " rows; must be a multiple of " +
                                std::to_string(lane_floats));
  entries_.resize(static_cast<std::size_t>(rows_ * length_));
  for (Eigen::Index c = 0; c < weight.cols(); ++c)
    for (Eigen::Index r = 0; r < rows_; ++r)
      narrow(weight.col(c).data() + r, 1,
             &entries_[static_cast<std::size_t>(narrow_bits == 16 ? 2 * (c / 2 * rows_ + r) + c % 2 : c * rows_ + r)]);
}

#if defined(__AVX512BF16__)

namespace {

/// Computes R lanes of rows for C items. One instruction multiplies a pair of operands per row.
template <int R, int C>
void tile(const Narrow* w, Eigen::Index rows, Eigen::Index pairs, const float* bias, const Narrow* x,
          Eigen::Index x_stride, float* y, Eigen::Index y_stride) {
  __m512 sum[R][C];
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c) sum[r][c] = bias ? _mm512_loadu_ps(bias + r * lane_floats) : _mm512_setzero_ps();
  for (Eigen::Index k = 0; k < pairs; ++k, w += 2 * rows, x += 2)
    for (int r = 0; r < R; ++r) {
      __m512bh entries;
      std::memcpy(&entries, w + 2 * r * lane_floats, sizeof entries);
      for (int c = 0; c < C; ++c) {
        std::int32_t pair;
        std::memcpy(&pair, x + c * x_stride, sizeof pair);
        sum[r][c] = _mm512_dpbf16_ps(sum[r][c], entries, (__m512bh)_mm512_set1_epi32(pair));
      }
    }
  for (int c = 0; c < C; ++c)
    for (int r = 0; r < R; ++r) _mm512_storeu_ps(y + c * y_stride + r * lane_floats, sum[r][c]);
}

}  // namespace

void store_narrow(Narrow* to, const FloatLane& values) {
  const __m256bh rounded = _mm512_cvtneps_pbh((__m512)values);
  std::memcpy(to, &rounded, sizeof rounded);
}

void narrow(const float* from, Eigen::Index count, Narrow* to) {
  Eigen::Index i = 0;
  for (; i + lane_floats <= count; i += lane_floats) store_narrow(to + i, load_lane(from + i));
  if (i == count) return;
  const auto rest = static_cast<__mmask16>((1U << (count - i)) - 1);
  const __m256bh rounded = _mm512_cvtneps_pbh(_mm512_maskz_loadu_ps(rest, from + i));
  _mm256_mask_storeu_epi16(to + i, rest, (__m256i)rounded);
}

void NarrowMatrix::multiply(const float* bias, const Eigen::Ref<const NarrowColumns>& x,
                            Eigen::Ref<Tensor<float>> y) const {
  const auto columns = [&](auto width, Eigen::Index column) {
    constexpr int C = decltype(width)::value;
    const Narrow* from = x.data() + column * x.outerStride();
    Eigen::Index row = 0;
    const auto rows = [&](auto lanes) {
      constexpr int R = decltype(lanes)::value;
      for (; row + R * lane_floats <= rows_; row += R * lane_floats)
        tile<R, C>(entries_.data() + 2 * row, rows_, length_ / 2, bias ? bias + row : nullptr, from, x.outerStride(),
                   y.data() + column * y.outerStride() + row, y.outerStride());
    };
    rows(std::integral_constant<int, 3>());
    rows(std::integral_constant<int, 2>());
    rows(std::integral_constant<int, 1>());
  };
  Eigen::Index column = 0;
  for (; column + 8 <= x.cols(); column += 8) columns(std::integral_constant<int, 8>(), column);
  for (; column + 4 <= x.cols(); column += 4) columns(std::integral_constant<int, 4>(), column);
  for (; column < x.cols(); ++column) columns(std::integral_constant<int, 1>(), column);
}

#else

void store_narrow(Narrow* to, const FloatLane& values) { store_lane(to, values); }

void narrow(const float* from, Eigen::Index count, Narrow* to) {
  std::memcpy(to, from, static_cast<std::size_t>(count) * sizeof(float));
}

void NarrowMatrix::multiply(const float* bias, const Eigen::Ref<const NarrowColumns>& x,
                            Eigen::Ref<Tensor<float>> y) const {
  rodsweep::multiply<float>(Eigen::Map<const Tensor<float>>(entries_.data(), rows_, length_), bias, x, y);
}

#endif

}  // namespace rodsweep
