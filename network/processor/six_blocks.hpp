// Products with 6x6 blocks of the training code's tensors: columns of six numbers in registers of eight.
#pragma once

#include <cstring>

namespace rodsweep::six {

/// Six numbers and two zeros.
template <class T>
struct ColumnOf;
template <>
struct ColumnOf<float> {
  using Type = float __attribute__((vector_size(32)));
};
template <>
struct ColumnOf<double> {
  using Type = double __attribute__((vector_size(64)));
};
template <class T>
using Column = typename ColumnOf<T>::Type;
template <class T>
struct Block {
  Column<T> column[6];
};

template <class T>
Column<T> column(const T* six) {
  Column<T> out{};
  std::memcpy(&out, six, 6 * sizeof(T));
  return out;
}
template <class T>
void add(const Column<T>& v, T* six) {
  for (int r = 0; r < 6; ++r) six[r] += v[r];
}
template <class T>
Block<T> block(const T* entries) {
  Block<T> out;
  for (int c = 0; c < 6; ++c) out.column[c] = column(entries + 6 * c);
  return out;
}
/// A symmetric matrix from its lower triangle.
template <class T>
Block<T> symmetric(const T* triangle) {
  Block<T> out{};
  for (int c = 0; c < 6; ++c)
    for (int r = c; r < 6; ++r) out.column[r][c] = out.column[c][r] = *triangle++;
  return out;
}

template <class T>
Column<T> times(const Block<T>& a, const Column<T>& x) {
  Column<T> y = x[0] * a.column[0];
  for (int c = 1; c < 6; ++c) y += x[c] * a.column[c];
  return y;
}
template <class T>
T sum(const Column<T>& v) {
  return ((v[0] + v[1]) + (v[2] + v[3])) + (v[4] + v[5]);
}
template <class T>
Column<T> transposed_times(const Block<T>& a, const Column<T>& x) {
  Column<T> y{};
  for (int c = 0; c < 6; ++c) y[c] = sum<T>(a.column[c] * x);
  return y;
}

/// transposed_times() with sums in another order, three times as fast.
template <class T>
Column<T> folded_times(const Block<T>& a, const Column<T>& x) {
  const auto fold = [](const Column<T>& u, const Column<T>& v) {
    return __builtin_shufflevector(u, v, 0, 2, 4, 6, 8, 10, 12, 14) +
           __builtin_shufflevector(u, v, 1, 3, 5, 7, 9, 11, 13, 15);
  };
  const Column<T> low = fold(fold(a.column[0] * x, a.column[1] * x), fold(a.column[2] * x, a.column[3] * x));
  const Column<T> high = fold(fold(a.column[4] * x, a.column[5] * x), Column<T>{});
  return fold(low, high);
}

/// Adds d(u^T N v) / dN to the derivatives with respect to the triangle.
template <class T>
void add_derivatives(const Column<T>& u, const Column<T>& v, T* triangle) {
  for (int c = 0; c < 6; ++c)
    for (int r = c; r < 6; ++r) *triangle++ += r == c ? u[r] * v[r] : u[r] * v[c] + u[c] * v[r];
}

}  // namespace rodsweep::six
