#include "network/layers/product.hpp"

#include <cstring>

#include "network/layers/native_lanes.hpp"

namespace rodsweep {
namespace {

// `sums` registers hold a tile of outputs; up to `widest` columns share a load of W.
constexpr int sums = lane_bytes == 64 ? 16 : 8, widest = lane_bytes == 64 ? 8 : 4;

template <class T>
struct LaneOf;
template <>
struct LaneOf<float> {
  using Type = float __attribute__((vector_size(lane_bytes)));
};
template <>
struct LaneOf<double> {
  using Type = double __attribute__((vector_size(lane_bytes)));
};
template <class T>
using Lane = typename LaneOf<T>::Type;

template <class T>
constexpr int lane_size = lane_bytes / sizeof(T);

template <class T>
Lane<T> load(const T* from) {
  Lane<T> out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

/// The first `count` entries, then zeros.
template <class T>
Lane<T> load(const T* from, Eigen::Index count) {
  Lane<T> out{};
  std::memcpy(&out, from, static_cast<std::size_t>(count) * sizeof(T));
  return out;
}

template <class T>
struct Operands {
  const T* weight;
  Eigen::Index weight_stride, rows, depth;
  const T* bias;
  const T* x;
  Eigen::Index x_stride;
  T* y;
  Eigen::Index y_stride;
};

/// Computes R lanes of rows from `row` for C columns from `column`.
template <int R, int C, class T>
void tile(const Operands<T>& o, Eigen::Index row, Eigen::Index column) {
  Lane<T> sum[R][C];
  for (int r = 0; r < R; ++r) {
    const Lane<T> start = o.bias ? load(o.bias + row + r * lane_size<T>) : Lane<T>{};
    for (int c = 0; c < C; ++c) sum[r][c] = start;
  }
  const T *w = o.weight + row, *x = o.x + column * o.x_stride;
  for (Eigen::Index k = 0; k < o.depth; ++k, w += o.weight_stride, ++x)
    for (int r = 0; r < R; ++r) {
      const Lane<T> entries = load(w + r * lane_size<T>);
      for (int c = 0; c < C; ++c) sum[r][c] += entries * x[c * o.x_stride];
    }
  for (int c = 0; c < C; ++c)
    for (int r = 0; r < R; ++r)
      std::memcpy(o.y + (column + c) * o.y_stride + row + r * lane_size<T>, &sum[r][c], sizeof sum[r][c]);
}

/// Computes the rows from `row`, fewer than a lane. A full load reads into the next column of W, if there is one.
template <int C, class T>
void last_rows(const Operands<T>& o, Eigen::Index row, Eigen::Index column) {
  const Eigen::Index count = o.rows - row, end = (o.depth - 1) * o.weight_stride + o.rows;
  Lane<T> sum[C];
  for (Lane<T>& s : sum) s = o.bias ? load(o.bias + row, count) : Lane<T>{};
  const T* x = o.x + column * o.x_stride;
  for (Eigen::Index k = 0; k < o.depth; ++k, ++x) {
    const Eigen::Index at = k * o.weight_stride + row;
    const Lane<T> entries = at + lane_size<T> <= end ? load(o.weight + at) : load(o.weight + at, count);
    for (int c = 0; c < C; ++c) sum[c] += entries * x[c * o.x_stride];
  }
  for (int c = 0; c < C; ++c)
    std::memcpy(o.y + (column + c) * o.y_stride + row, &sum[c], static_cast<std::size_t>(count) * sizeof(T));
}

/// Computes tiles of R lanes while they fit, then smaller ones.
template <int R, int C, class T>
void rows_from(const Operands<T>& o, Eigen::Index row, Eigen::Index column) {
  for (; row + R * lane_size<T> <= o.rows; row += R * lane_size<T>) tile<R, C>(o, row, column);
  if constexpr (R > 1)
    rows_from<R / 2, C>(o, row, column);
  else if (row < o.rows)
    last_rows<C>(o, row, column);
}

template <int C, class T>
void columns_from(const Operands<T>& o, Eigen::Index column, Eigen::Index columns) {
  for (; column + C <= columns; column += C) rows_from<sums / C, C>(o, 0, column);
  if constexpr (C > 1) columns_from<C / 2>(o, column, columns);
}

}  // namespace

template <class T>
void multiply(const TensorIn<T>& weight, const T* bias, const TensorIn<T>& x, Eigen::Ref<Tensor<T>> y) {
  columns_from<widest>(Operands<T>{weight.data(), weight.outerStride(), weight.rows(), weight.cols(), bias, x.data(),
                                   x.outerStride(), y.data(), y.outerStride()},
                       0, x.cols());
}

template <class T>
void add_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y) {
  y.noalias() += a * b;
}

template <class T>
void add_outer_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y) {
  y.noalias() += a * b.transpose();
}

template <class T>
void add_transposed_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y) {
  y.noalias() += a.transpose() * b;
}

#define RODSWEEP_PRODUCTS(T)                                                                          \
  template void multiply<T>(const TensorIn<T>&, const T*, const TensorIn<T>&, Eigen::Ref<Tensor<T>>); \
  template void add_product<T>(const TensorIn<T>&, const TensorIn<T>&, Eigen::Ref<Tensor<T>>);        \
  template void add_outer_product<T>(const TensorIn<T>&, const TensorIn<T>&, Eigen::Ref<Tensor<T>>);  \
  template void add_transposed_product<T>(const TensorIn<T>&, const TensorIn<T>&, Eigen::Ref<Tensor<T>>);
RODSWEEP_PRODUCTS(float)
RODSWEEP_PRODUCTS(double)
#undef RODSWEEP_PRODUCTS

}  // namespace rodsweep
