#include "network/processor/coupled_passes.hpp"

#include "network/processor/six_blocks.hpp"

namespace rodsweep {
namespace {

using namespace six;

template <class T>
bool within_bound(const Column<T>& state) {
  return sum<T>(state * state) < CoupledPasses<T>::longest_state * CoupledPasses<T>::longest_state;
}

/// Calls each(place, begin, end) for places in ascending or descending order. [begin, end) are a row's couplings.
template <class Each>
void ascending(const std::vector<SystemPattern::Coupling>& couplings, Eigen::Index places, const Each& each) {
  std::size_t begin = 0;
  for (int k = 0; k < places; ++k) {
    std::size_t end = begin;
    while (end < couplings.size() && couplings[end].row == k) ++end;
    each(k, begin, end);
    begin = end;
  }
}
template <class Each>
void descending(const std::vector<SystemPattern::Coupling>& couplings, Eigen::Index places, const Each& each) {
  std::size_t end = couplings.size();
  for (int k = static_cast<int>(places) - 1; k >= 0; --k) {
    std::size_t begin = end;
    while (begin > 0 && couplings[begin - 1].row == k) --begin;
    each(k, begin, end);
    end = begin;
  }
}

/// Number of sides on which a row has couplings.
template <class T>
int sides_of(const ScaledSystem<T>& a, std::size_t begin, std::size_t end) {
  int sides = 0;
  for (std::size_t i = begin; i < end; ++i) sides = std::max(sides, a.couplings[i].side + 1);
  return sides;
}

/// B_kj of a coupling.
template <class T>
Block<T> b(const ScaledSystem<T>& a, const SystemPattern::Coupling& c) {
  return block(a.coupling.col(c.block).data());
}

template <class T>
Block<T> n(const TensorIn<T>& factors, int place) {
  return symmetric(factors.col(place).data());
}
template <class T>
Block<T> t(const TensorIn<T>& factors, int place, int side) {
  return block(factors.col(place).data() + CoupledPasses<T>::triangle + 36 * side);
}

/// Adds d(u^T T v) / dT to the derivatives with respect to a side's factor.
template <class T>
void add_outer(const Column<T>& u, const Column<T>& v, Tensor<T>& d_factors, int place, int side) {
  T* to = d_factors.col(place).data() + CoupledPasses<T>::triangle + 36 * side;
  for (int c = 0; c < 6; ++c, to += 6) add<T>(u * v[c], to);
}

}  // namespace

template <class T>
void CoupledPasses<T>::forward(const ScaledSystem<T>& a, const TensorIn<T>& factors, const TensorIn<T>& r) {
  h = r;
  descending(a.couplings, r.cols(), [&](int k, std::size_t begin, std::size_t end) {
    const Column<T> state = column(&h(0, k));
    if (begin == end || !within_bound<T>(state)) return;
    const int sides = sides_of(a, begin, end);
    Column<T> w[2] = {};
    for (int side = 0; side < sides; ++side) w[side] = folded_times(t<T>(factors, k, side), state);
    for (std::size_t i = begin; i < end; ++i) {
      const SystemPattern::Coupling& c = a.couplings[i];
      add<T>(-folded_times(b(a, c), w[c.side]), &h(0, c.column));
    }
  });
  v.setZero(12, r.cols());
  y.setZero(6, r.cols());
  ascending(a.couplings, r.cols(), [&](int k, std::size_t begin, std::size_t end) {
    Column<T> sums[2] = {};
    for (std::size_t i = begin; i < end; ++i) {
      const SystemPattern::Coupling& c = a.couplings[i];
      if (const Column<T> state = column(&y(0, c.column)); within_bound<T>(state))
        sums[c.side] -= times(b(a, c), state);
    }
    add<T>(times(n<T>(factors, k), column(&h(0, k))), &y(0, k));
    for (int side = 0; side < sides_of(a, begin, end); ++side) {
      add<T>(sums[side], &v(6 * side, k));
      add<T>(times(t<T>(factors, k, side), sums[side]), &y(0, k));
    }
  });
}

template <class T>
void CoupledPasses<T>::backward(const ScaledSystem<T>& a, const TensorIn<T>& factors, const TensorIn<T>& dy,
                                Tensor<T>& d_factors) const {
  Tensor<T> d = dy, dh = Tensor<T>::Zero(6, dy.cols());
  d_factors.setZero(size, dy.cols());
  descending(a.couplings, dy.cols(), [&](int k, std::size_t begin, std::size_t end) {
    const Column<T> dk = column(&d(0, k));
    add<T>(times(n<T>(factors, k), dk), &dh(0, k));
    add_derivatives<T>(dk, column(&h(0, k)), &d_factors(0, k));
    if (begin == end) return;
    Column<T> dv[2];
    for (int side = 0; side < sides_of(a, begin, end); ++side) {
      add_outer<T>(dk, column(&v(6 * side, k)), d_factors, k, side);
      dv[side] = folded_times(t<T>(factors, k, side), dk);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const SystemPattern::Coupling& c = a.couplings[i];
      if (within_bound<T>(column(&y(0, c.column)))) add<T>(-folded_times(b(a, c), dv[c.side]), &d(0, c.column));
    }
  });
  ascending(a.couplings, dy.cols(), [&](int k, std::size_t begin, std::size_t end) {
    const Column<T> state = column(&h(0, k));
    if (begin == end || !within_bound<T>(state)) return;
    Column<T> dw[2] = {};
    for (std::size_t i = begin; i < end; ++i) {
      const SystemPattern::Coupling& c = a.couplings[i];
      dw[c.side] -= times(b(a, c), column(&dh(0, c.column)));
    }
    for (int side = 0; side < sides_of(a, begin, end); ++side) {
      add_outer<T>(state, dw[side], d_factors, k, side);
      add<T>(times(t<T>(factors, k, side), dw[side]), &dh(0, k));
    }
  });
}

template struct CoupledPasses<float>;
template struct CoupledPasses<double>;

}  // namespace rodsweep
