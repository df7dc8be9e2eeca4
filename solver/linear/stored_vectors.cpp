#include "solver/linear/stored_vectors.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

// The part of a panel in a register. If it is a half, no registers are left for the sums of single vectors.
#ifdef __AVX512F__
using Lanes = Lane8;
constexpr int most_singles = 3;
#else
using Lanes = Lane4;
constexpr int most_singles = 0;
#endif
constexpr int parts = sizeof(Lane8) / sizeof(Lanes);

inline const double* doubles(const Lane8* lanes) { return reinterpret_cast<const double*>(lanes); }
inline double* doubles(Lane8* lanes) { return reinterpret_cast<double*>(lanes); }

inline const Lanes* part_of(const Lane8* panel, int part) { return reinterpret_cast<const Lanes*>(panel) + part; }
inline Lanes* part_of(Lane8* panel, int part) { return reinterpret_cast<Lanes*>(panel) + part; }

/// h += (D_ii / 2 + L_ii) V_i of a part of a panel.
inline void add_half(const Block6& block, const Lanes* v, Lanes (&h)[6]) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c) {
    const double* column = doubles(&block.column[c]);
    h[c] += 0.5 * column[c] * v[c * parts];
#pragma GCC unroll 6
    for (int r = 1; r < 6; ++r)
      if (r > c) h[r] += column[r] * v[c * parts];
  }
}

/// p += A_ij V_j of a part of a panel.
inline void add_product(const Block6& block, const Lanes* v, Lanes (&p)[6]) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c) {
    const double* column = doubles(&block.column[c]);
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) p[r] += column[r] * v[c * parts];
  }
}

/// sums[k] += V_k^T H of a panel's vectors k.
inline void add_outer(const Lane8* v, const Lanes (&h)[6], Lanes (&sums)[8]) {
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r)
#pragma GCC unroll 8
    for (int k = 0; k < 8; ++k) sums[k] += doubles(&v[r])[k] * h[r];
}

/// Lane c is a half, later lanes are one, earlier lanes zero.
constexpr Lane8 half_from[6] = {{0.5, 1, 1, 1, 1, 1, 0, 0}, {0, 0.5, 1, 1, 1, 1, 0, 0}, {0, 0, 0.5, 1, 1, 1, 0, 0},
                                {0, 0, 0, 0.5, 1, 1, 0, 0}, {0, 0, 0, 0, 0.5, 1, 0, 0}, {0, 0, 0, 0, 0, 0.5, 0, 0}};

/// h += (D_ii / 2 + L_ii) v_i of a single vector.
inline void add_half(const Block6& block, const Lane8& v, Lane8& h) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c) h += half_from[c] * block.column[c] * doubles(&v)[c];
}

/// p += A_ij v_j of a single vector.
inline void add_product(const Block6& block, const Lane8& v, Lane8& p) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c) p += block.column[c] * doubles(&v)[c];
}

}  // namespace

StoredVectors::StoredVectors(int unknowns, int count)
    : unknowns_(at(unknowns)),
      count_(count),
      panel_count_(count > 8 && count % 8 <= most_singles ? count / 8 : (count + 7) / 8),
      single_count_(std::max(count - 8 * panel_count_, 0)),
      entries_(at(panel_count_) * unknowns_),
      singles_(at(single_count_) * unknowns_ / 6),
      half_(at((8 * panel_count_ + single_count_) * panel_count_)),
      among_singles_(Eigen::Matrix3d::Zero()),
      dots_(at(panel_count_) + 1) {}

void StoredVectors::set(int index, const VectorX& v) {
  if (const int number = index - 8 * panel_count_; number >= 0) {
    for (std::size_t i = 0; i < unknowns_ / 6; ++i) single(number)[i] = load6(v.data() + 6 * i);
    return;
  }
  double* lane = doubles(panel(index / 8)) + index % 8;
  for (std::size_t i = 0; i < unknowns_; ++i) lane[8 * i] = v[static_cast<Eigen::Index>(i)];
}

template <int singles>
void StoredVectors::pass(const BlockMatrix& a, const VectorX& b, int index, int part) {
  const auto half = [&](int vector) -> Lanes& { return *part_of(&half_[at(vector * panel_count_ + index)], part); };
  const Lane8* v = panel(index);
  Lanes own[8]{}, dot{}, with_single[singles + 1]{};
  Lane8 dot_single[singles + 1]{}, among[singles + 1][singles + 1]{};
  for (int i = 0; i < a.block_rows(); ++i) {
    const Lanes* row = part_of(v + 6 * i, part);
    Lanes h[6]{};
    Lane8 h_single[singles + 1]{};
    const Block6& diagonal = a.blocks[at(a.diagonal(i))];
    add_half(diagonal, row, h);
#pragma GCC unroll 3
    for (int s = 0; s < singles; ++s) add_half(diagonal, single(s)[i], h_single[s]);
    for (int k = a.row_begin(i); k < a.diagonal(i); ++k) {
      const Block6& block = a.blocks[at(k)];
      add_product(block, part_of(v + 6 * a.column(k), part), h);
#pragma GCC unroll 3
      for (int s = 0; s < singles; ++s) add_product(block, single(s)[a.column(k)], h_single[s]);
    }
    add_outer(v + 6 * i, h, own);
    for (int other = 0; other < panel_count_; ++other)
      if (other != index) {
        Lanes sums[8];
#pragma GCC unroll 8
        for (int k = 0; k < 8; ++k) sums[k] = half(8 * other + k);
        add_outer(panel(other) + 6 * i, h, sums);
#pragma GCC unroll 8
        for (int k = 0; k < 8; ++k) half(8 * other + k) = sums[k];
      }
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) {
      dot += b[6 * i + r] * row[r * parts];
#pragma GCC unroll 3
      for (int s = 0; s < singles; ++s)
        with_single[s] += doubles(&single(s)[i])[r] * h[r] + h_single[s][r] * row[r * parts];
    }
#pragma GCC unroll 3
    for (int s = 0; s < singles; ++s) {
      dot_single[s] += load6(b.data() + 6 * i) * single(s)[i];
#pragma GCC unroll 3
      for (int t = 0; t <= s; ++t) among[s][t] += single(s)[i] * h_single[t] + single(t)[i] * h_single[s];
    }
  }
#pragma GCC unroll 8
  for (int k = 0; k < 8; ++k) half(8 * index + k) = own[k];
  *part_of(&dots_[at(index)], part) = dot;
#pragma GCC unroll 3
  for (int s = 0; s < singles; ++s) {
    half(8 * panel_count_ + s) = with_single[s];
    doubles(dots_.data())[8 * panel_count_ + s] = sum(dot_single[s]);
#pragma GCC unroll 3
    for (int t = 0; t <= s; ++t) among_singles_(s, t) = sum(among[s][t]);
  }
}

void StoredVectors::project(const BlockMatrix& a, const VectorX& b, Eigen::MatrixXd& gram, VectorX& right_side) {
  std::fill(half_.begin(), half_.end(), Lane8{});
  for (int p = 0; p < panel_count_; ++p)
    for (int part = 0; part < parts; ++part) {
      if constexpr (most_singles > 0) {
        if (single_count_ == 1) pass<1>(a, b, p, part);
        if (single_count_ == 2) pass<2>(a, b, p, part);
        if (single_count_ == 3) pass<3>(a, b, p, part);
      }
      if (single_count_ == 0) pass<0>(a, b, p, part);
    }
  std::copy_n(doubles(dots_.data()), count_, right_side.data());
  const int in_panels = std::min(8 * panel_count_, count_);
  const double* half = doubles(half_.data());
  const int width = 8 * panel_count_;
  for (int i = 0; i < in_panels; ++i)
    for (int k = 0; k <= i; ++k) gram(i, k) = gram(k, i) = half[i * width + k] + half[k * width + i];
  for (int i = in_panels; i < count_; ++i) {
    for (int k = 0; k < in_panels; ++k) gram(i, k) = gram(k, i) = half[i * width + k];
    for (int k = in_panels; k <= i; ++k) gram(i, k) = gram(k, i) = among_singles_(i - in_panels, k - in_panels);
  }
}

void StoredVectors::multiply(const BlockMatrix& a, const StoredVectors& v) {
  for (int i = 0; i < a.block_rows(); ++i) {
    for (int p = 0; p < panel_count_; ++p)
      for (int part = 0; part < parts; ++part) {
        Lanes product[6]{};
        for (int k = a.row_begin(i); k < a.row_end(i); ++k)
          add_product(a.blocks[at(k)], part_of(v.panel(p) + 6 * a.column(k), part), product);
        for (int r = 0; r < 6; ++r) *part_of(panel(p) + 6 * i + r, part) = product[r];
      }
    for (int s = 0; s < single_count_; ++s) {
      Lane8 product{};
      for (int k = a.row_begin(i); k < a.row_end(i); ++k)
        add_product(a.blocks[at(k)], v.single(s)[a.column(k)], product);
      single(s)[i] = product;
    }
  }
}

void StoredVectors::dots(const double* x, VectorX& c) {
  for (int p = 0; p < panel_count_; ++p) {
    Lane8 sums[6]{};
    for (std::size_t i = 0; i < unknowns_; i += 6)
#pragma GCC unroll 6
      for (std::size_t r = 0; r < 6; ++r) sums[r] += x[i + r] * panel(p)[i + r];
    dots_[at(p)] = (sums[0] + sums[1]) + (sums[2] + sums[3]) + (sums[4] + sums[5]);
  }
  for (int s = 0; s < single_count_; ++s) {
    Lane8 sums{};
    for (std::size_t i = 0; i < unknowns_ / 6; ++i) sums += load6(x + 6 * i) * single(s)[i];
    doubles(dots_.data())[8 * panel_count_ + s] = sum(sums);
  }
  std::copy_n(doubles(dots_.data()), count_, c.data());
}

template <class Take>
void StoredVectors::combined(const VectorX& c, Take take) {
  std::fill(dots_.begin(), dots_.end(), Lane8{});
  std::copy_n(c.data(), count_, doubles(dots_.data()));
  const Lane8* factors = dots_.data();
  const int rows = static_cast<int>(unknowns_ / 6), panels = panel_count_, singles = single_count_;
  for (int i = 0; i < rows; ++i) {
    Lane8 sums[6]{};
    for (int p = 0; p < panels; ++p) {
      const Lane8* row = entries_.data() + 6 * (p * rows + i);
#pragma GCC unroll 6
      for (int r = 0; r < 6; ++r) sums[r] += factors[p] * row[r];
    }
    Lane8 of_row = sum_lanes(sums);
    const double* factor = doubles(factors + panels);
    for (int s = 0; s < singles; ++s) of_row += factor[s] * singles_[at(s * rows + i)];
    take(i, of_row);
  }
}

void StoredVectors::combine(const VectorX& c, VectorX& x) {
  double* to = x.data();
  combined(c, [&](int i, const Lane8& of_row) { store6(to + 6 * i, of_row); });
}

void StoredVectors::subtract(const VectorX& c, double* x) {
  combined(c, [&](int i, const Lane8& of_row) { store6(x + 6 * i, load6(x + 6 * i) - of_row); });
}

}  // namespace rodsweep
