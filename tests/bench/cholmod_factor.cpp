#include "tests/bench/cholmod_factor.hpp"

#include <cholmod.h>
#include <malloc.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

// Defined if CHOLMOD's libraries bring them.
extern "C" {
[[gnu::weak]] void openblas_set_num_threads(int);
[[gnu::weak]] void omp_set_max_active_levels(int);
}

namespace rodsweep::bench {
namespace {

/// Calls entry(column, row, value) for the lower triangle by columns. Rows of A are its columns.
template <class Entry>
void visit_lower_triangle(const BlockMatrix& a, const Entry& entry) {
  for (int i = 0; i < a.block_rows(); ++i)
    for (int c = 0; c < 6; ++c)
      for (int k = a.row_begin(i); k < a.row_end(i); ++k)
        for (int r = a.column(k) == i ? c : 0; r < 6 && a.column(k) >= i; ++r)
          entry(6 * i + c, 6 * a.column(k) + r, a.blocks[static_cast<std::size_t>(k)].column[r][c]);
}

cholmod_dense dense(double* values, int size) {
  cholmod_dense out{};
  out.nrow = out.nzmax = out.d = static_cast<std::size_t>(size);
  out.ncol = 1;
  out.x = values;
  out.xtype = CHOLMOD_REAL;
  out.dtype = CHOLMOD_DOUBLE;
  return out;
}

}  // namespace

struct CholmodFactor::Impl {
  cholmod_common common{};
  cholmod_sparse matrix{};
  cholmod_factor* factor = nullptr;
  std::vector<int> start, rows;
  std::vector<double> values;
  VectorX rhs;
  cholmod_dense *x = nullptr, *work = nullptr, *other_work = nullptr;

  explicit Impl(const BlockMatrix& pattern) {
    if (openblas_set_num_threads) openblas_set_num_threads(1);
    if (omp_set_max_active_levels) omp_set_max_active_levels(0);
    // It allocates in every factorisation. Freed memory is kept, so that it pays for page faults only once.
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    start.assign(static_cast<std::size_t>(pattern.unknowns()) + 1, 0);
    visit_lower_triangle(pattern, [&](int column, int row, double) {
      rows.push_back(row);
      start[static_cast<std::size_t>(column) + 1] = static_cast<int>(rows.size());
    });
    values.resize(rows.size());
    matrix.nrow = matrix.ncol = static_cast<std::size_t>(pattern.unknowns());
    matrix.nzmax = rows.size();
    matrix.p = start.data();
    matrix.i = rows.data();
    matrix.x = values.data();
    matrix.stype = -1;
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = matrix.packed = 1;
    factor = cholmod_analyze(&matrix, &common);
    if (!factor) throw std::runtime_error("cholmod_analyze failed");
  }
  ~Impl() {
    for (cholmod_dense** of : {&x, &work, &other_work}) cholmod_free_dense(of, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
};

CholmodFactor::CholmodFactor(const BlockMatrix& pattern) : impl_(std::make_unique<Impl>(pattern)) {}
CholmodFactor::~CholmodFactor() = default;

bool CholmodFactor::solve(const BlockMatrix& a, const VectorX& b, VectorX& x) {
  Impl& s = *impl_;
  double* next = s.values.data();
  visit_lower_triangle(a, [&](int, int, double value) { *next++ = value; });
  if (!cholmod_factorize(&s.matrix, s.factor, &s.common) || s.common.status == CHOLMOD_NOT_POSDEF) return false;
  s.rhs = b;
  cholmod_dense rhs = dense(s.rhs.data(), static_cast<int>(b.size()));
  if (!cholmod_solve2(CHOLMOD_A, s.factor, &rhs, nullptr, &s.x, nullptr, &s.work, &s.other_work, &s.common))
    return false;
  std::copy_n(static_cast<const double*>(s.x->x), b.size(), x.data());
  return true;
}

}  // namespace rodsweep::bench
