// Vectors and quaternions between memory, where they stand one after the other, and lanes, one in each: transpositions
// of as many records as a register has lanes, or of fewer at the end of an array.
#pragma once

#include <algorithm>
#include <utility>

#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

/// Registers and lanes of a run of records of three or four entries: entry `e` of the run is entry e % size of record
/// e / size. What a shuffle takes of its first operand comes first, so W = lane_width marks the second.
namespace lane_records {

inline constexpr int W = lane_width;
using Indices = std::make_integer_sequence<int, W>;

/// Component c of W records of three, which fill v.
template <int c, int... lane>
inline Lane component(const Lane (&v)[3], std::integer_sequence<int, lane...>) {
  const Lane pair = __builtin_shufflevector(v[0], v[1], (3 * lane + c < 2 * W ? 3 * lane + c : 0)...);
  return __builtin_shufflevector(pair, v[2], (3 * lane + c < 2 * W ? lane : 3 * lane + c - W)...);
}

/// Of four: half of the records are in either pair of registers.
template <int c, int... lane>
inline Lane component(const Lane (&v)[4], std::integer_sequence<int, lane...>) {
  const Lane low = __builtin_shufflevector(v[0], v[1], (4 * lane + c) % (2 * W)...);
  const Lane high = __builtin_shufflevector(v[2], v[3], (4 * lane + c) % (2 * W)...);
  return __builtin_shufflevector(low, high, (lane < W / 2 ? lane : W + lane)...);
}

/// Register r of W records of three with the components v.
template <int r, int... i>
inline Lane part(const Lane (&v)[3], std::integer_sequence<int, i...>) {
  const Lane pair = __builtin_shufflevector(v[0], v[1], (r * W + i) / 3 + ((r * W + i) % 3 == 1 ? W : 0)...);
  return __builtin_shufflevector(pair, v[2], ((r * W + i) % 3 == 2 ? W + (r * W + i) / 3 : i)...);
}

template <int r, int... i>
inline Lane part(const Lane (&v)[4], std::integer_sequence<int, i...>) {
  const Lane low = __builtin_shufflevector(v[0], v[1], (r * W + i) / 4 + i % 2 * W...);
  const Lane high = __builtin_shufflevector(v[2], v[3], (r * W + i) / 4 + i % 2 * W...);
  return __builtin_shufflevector(low, high, ((r * W + i) % 4 < 2 ? i : W + i)...);
}

/// Calls `visit` with lane_width records, those of `from` and copies of the last one.
template <class Record, class Visit>
inline auto padded(const Record* from, int count, const Visit& visit) {
  if (count >= W) return visit(from);
  Record copies[W];
  for (int i = 0; i < W; ++i) copies[i] = from[std::min(i, count - 1)];
  return visit(copies);
}

template <class Record, std::size_t size>
inline void store(const Lane (&v)[size], Record* to, int count) {
  std::memcpy(reinterpret_cast<double*>(to), v, static_cast<std::size_t>(std::min(count, W)) * size * sizeof(double));
}

}  // namespace lane_records

/// The first of `count` vectors, one in each lane; lanes that are too many have the last.
inline LaneVector load(const Vector3* from, int count) {
  using namespace lane_records;
  return padded(from, count, [](const Vector3* records) {
    Lane v[3];
    std::memcpy(v, records, sizeof v);
    return LaneVector{component<0>(v, Indices()), component<1>(v, Indices()), component<2>(v, Indices())};
  });
}

inline LaneQuaternion load(const Quaternion* from, int count) {
  using namespace lane_records;
  return padded(from, count, [](const Quaternion* records) {
    Lane v[4];
    std::memcpy(v, records, sizeof v);
    return LaneQuaternion{component<3>(v, Indices()), component<0>(v, Indices()), component<1>(v, Indices()),
                          component<2>(v, Indices())};
  });
}

/// To at most `count`.
inline void store(const LaneVector& v, Vector3* to, int count) {
  using namespace lane_records;
  const Lane in[3] = {v.x, v.y, v.z};
  const Lane out[3] = {part<0>(in, Indices()), part<1>(in, Indices()), part<2>(in, Indices())};
  store(out, to, count);
}

inline void store(const LaneQuaternion& q, Quaternion* to, int count) {
  using namespace lane_records;
  const Lane in[4] = {q.x, q.y, q.z, q.w};
  const Lane out[4] = {part<0>(in, Indices()), part<1>(in, Indices()), part<2>(in, Indices()), part<3>(in, Indices())};
  store(out, to, count);
}

/// Of records of four that stand `stride` doubles apart, all of them.
inline void scatter(const Lane (&v)[4], double* to, std::ptrdiff_t stride) {
  using namespace lane_records;
  const Lane out[4] = {part<0>(v, Indices()), part<1>(v, Indices()), part<2>(v, Indices()), part<3>(v, Indices())};
#pragma GCC unroll 4
  for (int r = 0; r < 4; ++r) {
#if defined(__AVX512F__)
    const Lane4 even = __builtin_shufflevector(out[r], out[r], 0, 1, 2, 3);
    const Lane4 odd = __builtin_shufflevector(out[r], out[r], 4, 5, 6, 7);
    std::memcpy(to + 2 * r * stride, &even, sizeof even);
    std::memcpy(to + (2 * r + 1) * stride, &odd, sizeof odd);
#else
    std::memcpy(to + r * W / 4 * stride + r * W % 4, &out[r], sizeof out[r]);
#endif
  }
}

}  // namespace rodsweep
