#include "solver/linear/stored_vectors.hpp"

#include <algorithm>
#include <cstring>

namespace rodsweep {
namespace {

template <class T>
inline T load(const double* from) {
  T out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

template <class T>
inline void store(double* to, const T& value) {
  std::memcpy(to, &value, sizeof value);
}

/// p += A_ij V_j, in the lanes of V_j from `v` on.
template <class T>
inline void add_product(const Block6& block, const double* v, std::size_t width, T (&p)[6]) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c) {
    const T lanes = load<T>(v + static_cast<std::size_t>(c) * width);
    const double* column = reinterpret_cast<const double*>(&block.column[c]);
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) p[r] += column[r] * lanes;
  }
}

/// `rows` rows of G, V_i^T P, of as many vectors from `v` on.
template <class T, int rows>
inline void add_outer(const double* v, std::size_t width, const T (&p)[6], double* half) {
  T sum[rows];
#pragma GCC unroll 8
  for (int k = 0; k < rows; ++k) sum[k] = load<T>(half + static_cast<std::size_t>(k) * width);
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r)
#pragma GCC unroll 8
    for (int k = 0; k < rows; ++k)
      sum[k] += v[static_cast<std::size_t>(r) * width + static_cast<std::size_t>(k)] * p[r];
#pragma GCC unroll 8
  for (int k = 0; k < rows; ++k) store(half + static_cast<std::size_t>(k) * width, sum[k]);
}

}  // namespace

StoredVectors::StoredVectors(int unknowns, int count)
    : block_rows_(unknowns / 6),
      count_(count),
      width_(static_cast<std::size_t>((count + 3) / 4 * 4)),
      entries_(static_cast<std::size_t>(unknowns) * width_),
      half_(width_ * width_),
      dots_(width_) {}

void StoredVectors::set(int index, const VectorX& v) {
  for (int i = 0; i < 6 * block_rows_; ++i) row(i)[index] = v[i];
}

void StoredVectors::project(const BlockMatrix& a, const VectorX& b, Eigen::MatrixXd& gram, VectorX& right_side) {
  std::fill(half_.begin(), half_.end(), 0);
  std::fill(dots_.begin(), dots_.end(), 0);
  const auto of_lanes = [&](auto lanes, int i, std::size_t first) {
    using T = decltype(lanes);
    T p[6]{};
    const double* own = row(6 * i);
    add_product<T>(a.blocks[static_cast<std::size_t>(a.diagonal(i))], own + first, width_, p);
    for (T& entry : p) entry *= 0.5;
    for (int k = a.row_begin(i); k < a.diagonal(i); ++k)
      add_product<T>(a.blocks[static_cast<std::size_t>(k)], row(6 * a.column(k)) + first, width_, p);
    std::size_t k = 0;
    for (; k + 8 <= width_; k += 8) add_outer<T, 8>(own + k, width_, p, half_.data() + k * width_ + first);
    for (; k < width_; k += 4) add_outer<T, 4>(own + k, width_, p, half_.data() + k * width_ + first);
    T dots = load<T>(dots_.data() + first);
    for (int r = 0; r < 6; ++r) dots += b[6 * i + r] * load<T>(own + static_cast<std::size_t>(r) * width_ + first);
    store(dots_.data() + first, dots);
  };
  for (int i = 0; i < block_rows_; ++i) {
    std::size_t first = 0;
    for (; first + 8 <= width_; first += 8) of_lanes(Lane8{}, i, first);
    for (; first < width_; first += 4) of_lanes(Lane4{}, i, first);
  }
  for (int i = 0; i < count_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    right_side[i] = dots_[at];
    for (std::size_t k = 0; k <= at; ++k)
      gram(i, static_cast<Eigen::Index>(k)) = half_[at * width_ + k] + half_[k * width_ + at];
  }
}

void StoredVectors::multiply(const BlockMatrix& a, const StoredVectors& v) {
  const auto of_lanes = [&](auto lanes, int i, std::size_t first) {
    using T = decltype(lanes);
    T p[6]{};
    for (int k = a.row_begin(i); k < a.row_end(i); ++k)
      add_product<T>(a.blocks[static_cast<std::size_t>(k)], v.row(6 * a.column(k)) + first, width_, p);
    for (int r = 0; r < 6; ++r) store(row(6 * i + r) + first, p[r]);
  };
  for (int i = 0; i < block_rows_; ++i) {
    std::size_t first = 0;
    for (; first + 8 <= width_; first += 8) of_lanes(Lane8{}, i, first);
    for (; first < width_; first += 4) of_lanes(Lane4{}, i, first);
  }
}

void StoredVectors::dots(const double* x, VectorX& c) {
  const auto of_lanes = [&](auto lanes, std::size_t first) {
    using T = decltype(lanes);
    T sums[2]{};
    for (int i = 0; i < 6 * block_rows_; ++i) sums[i % 2] += x[i] * load<T>(row(i) + first);
    store(dots_.data() + first, sums[0] + sums[1]);
  };
  std::size_t first = 0;
  for (; first + 8 <= width_; first += 8) of_lanes(Lane8{}, first);
  for (; first < width_; first += 4) of_lanes(Lane4{}, first);
  std::copy_n(dots_.begin(), count_, c.data());
}

void StoredVectors::set_factors(const VectorX& c) {
  std::fill(dots_.begin(), dots_.end(), 0);
  std::copy_n(c.data(), count_, dots_.begin());
}

/// Six entries of V c.
Lane8 StoredVectors::combined(int block_row) const {
  const double* own = row(6 * block_row);
  Lane8 sum[6]{};
  std::size_t first = 0;
  for (; first + 8 <= width_; first += 8) {
    const Lane8 factors = load<Lane8>(dots_.data() + first);
    for (int r = 0; r < 6; ++r) sum[r] += factors * load<Lane8>(own + static_cast<std::size_t>(r) * width_ + first);
  }
  if (first < width_) {
    const Lane4 factors = load<Lane4>(dots_.data() + first);
    for (int r = 0; r < 6; ++r) {
      const Lane4 part = factors * load<Lane4>(own + static_cast<std::size_t>(r) * width_ + first);
      sum[r] += __builtin_shufflevector(part, Lane4{}, 0, 1, 2, 3, 4, 4, 4, 4);
    }
  }
  return sum_lanes(sum);
}

void StoredVectors::combine(const VectorX& c, VectorX& x) {
  set_factors(c);
  for (int i = 0; i < block_rows_; ++i) store6(x.data() + 6 * i, combined(i));
}

void StoredVectors::subtract(const VectorX& c, double* x) {
  set_factors(c);
  for (int i = 0; i < block_rows_; ++i) store6(x + 6 * i, load6(x + 6 * i) - combined(i));
}

}  // namespace rodsweep
