#include "solver/factor/condensation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/factor/strut_kernels.hpp"

namespace rodsweep {
namespace {

bool has_positive_mass(const Segment& segment) {
  return segment.is_static ||
         (segment.inverse_mass > 0 && segment.turn_mobility > 0 && segment.inverse_inertia_axial > 0);
}

Lane8 mass_of(const Segment& segment) {
  const double m = 1 / segment.inverse_mass, transverse = 1 / segment.turn_mobility;
  return Lane8{m, m, m, transverse, transverse, 1 / segment.inverse_inertia_axial, 0, 0};
}

}  // namespace

Condensation::Condensation(const Rod& rod)
    : graph_(strut_graph(rod)),
      home_(rod.segments.size()),
      stiffness_(rod.joints.size()),
      inverse_mass_(rod.segments.size()),
      motion_(rod.segments.size()) {
  // Sorts struts by length, then by their place in S, so that memory is read and written in order.
  std::stable_sort(graph_.struts.begin(), graph_.struts.end(), [](const Strut& one, const Strut& other) {
    return std::make_pair(one.segments.size(), std::max(one.begin, one.end)) <
           std::make_pair(other.segments.size(), std::max(other.begin, other.end));
  });
  for (std::size_t s = 0; s < graph_.struts.size();) {
    Batch batch{s, inner_.size(), 0, static_cast<int>(graph_.struts[s].segments.size())};
    while (s < graph_.struts.size() && batch.count < lane_width &&
           graph_.struts[s].segments.size() == at(batch.segments)) {
      for (int p = 0; p < batch.segments; ++p)
        home_[at(graph_.struts[s].segments[at(p)])] = {static_cast<int>(batches_.size()), batch.count, p};
      ++batch.count;
      ++s;
    }
    batches_.push_back(batch);
    inner_.resize(inner_.size() + at(batch.segments));
  }

  std::vector<std::pair<int, int>> ends;  // crossings that a strut or a link couples
  for (const Strut& strut : graph_.struts) ends.emplace_back(strut.begin, strut.end);
  for (const int k : graph_.links) {
    const Joint& joint = rod.joints[at(k)];
    ends.emplace_back(graph_.place[at(joint.a)], graph_.place[at(joint.b)]);
  }
  std::vector<std::pair<int, int>> couplings;
  for (const auto& [a, b] : ends)
    if (a >= 0 && b >= 0) couplings.emplace_back(a, b);
  matrix_ = BlockMatrix(static_cast<int>(graph_.crossings.size()), couplings);
  for (const auto& [a, b] : ends) {
    const bool both = a >= 0 && b >= 0;
    places_.push_back({a < 0 ? -1 : matrix_.diagonal(a), b < 0 ? -1 : matrix_.diagonal(b),
                       both ? matrix_.find(a, b) : -1, both ? matrix_.find(b, a) : -1});
  }
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[at(k)];
    if (graph_.place[at(joint.a)] >= 0 || graph_.place[at(joint.b)] >= 0) near_.push_back(k);
  }
}

const Strut& Condensation::strut(const Batch& batch, int lane) const {
  return graph_.struts[batch.first_strut + at(std::min(lane, batch.count - 1))];
}

bool Condensation::assemble(const Rod& rod, const Linearization& linearization, double dt) {
  for (const Segment& segment : rod.segments)
    if (!has_positive_mass(segment)) return false;
  rod_ = &rod;
  linearization_ = &linearization;
  for (std::size_t k = 0; k < rod.joints.size(); ++k)
    stiffness_[k] = load6(Vector6(rod.softness(k, 1 / (dt * dt)).cwiseInverse()).data());
  for (std::size_t s = 0; s < rod.segments.size(); ++s) inverse_mass_[s] = motion(rod.segments[s], broadcast(1));
  for (Block6& block : matrix_.blocks) block = Block6{};
  for (int c = 0; c < matrix_.block_rows(); ++c) {
    const Lane8 mass = mass_of(rod.segments[at(graph_.crossings[at(c)])]);
    Block6& diagonal = matrix_.blocks[at(matrix_.diagonal(c))];
    for (int i = 0; i < 6; ++i) diagonal.column[i] = mass * unit_lane[i];
  }
  LaneMask positive = Lane{} < 1;
  for (const Batch& batch : batches_) positive &= eliminate(batch);
  add_links();
  for (int lane = 0; lane < lane_width; ++lane)
    if (!positive[lane]) return false;
  return true;
}

LaneMask Condensation::eliminate(const Batch& batch) {
  const auto load = [&](int joint, LaneJoint& out) {
    for (int lane = 0; lane < lane_width; ++lane) {
      const Strut& of = strut(batch, lane);
      const int k = of.joints[at(joint)];
      if (k < 0) {  // no joint
        out.clear(lane);
        continue;
      }
      const bool b_is_before = joint > 0 ? rod_->joints[at(k)].b == of.segments[at(joint - 1)]
                                         : rod_->joints[at(k)].a == of.segments.front();
      out.set(lane, linearization_->joints[at(k)], b_is_before, stiffness_[at(k)]);
    }
  };
  LaneMask positive = Lane{} < 1;
  LaneBlock begin{}, s{};
  LaneVector6 to_begin[6];
  LaneJoint joint{};
  load(0, joint);
  add_square(joint.before, joint.c, begin);
  add_square(joint.after, joint.c, s);
  product(joint.after, joint.c, joint.before, to_begin);
  for (int p = 0; p < batch.segments; ++p) {
    Inner& inner = inner_[batch.first_inner + at(p)];
    for (int lane = 0; lane < lane_width; ++lane) {
      const Lane8 mass = mass_of(rod_->segments[at(strut(batch, lane).segments[at(p)])]);
      for (int i = 0; i < 6; ++i) s[i][i][lane] += mass[i];
    }
    load(p + 1, joint);
    add_square(joint.before, joint.c, s);
    LaneVector6 to_next[6];
    product(joint.before, joint.c, joint.after, to_next);
    LaneBlock next{};
    add_square(joint.after, joint.c, next);

    positive &= factorise(s, inner.factor);
    LaneVector6 across[6]{};  // the next segment's coupling to begin
#pragma GCC unroll 1
    for (int c = 0; c < 6; ++c) {
      forward(inner.factor, to_begin[c]);
      inner.to_begin[c] = divided(inner.factor, to_begin[c]);
      forward(inner.factor, to_next[c]);
      inner.to_next[c] = divided(inner.factor, to_next[c]);
    }
    LaneVector6 unused{};
    subtract_products(begin, unused, to_begin, inner.to_begin, LaneVector6{});
    subtract_products(next, unused, to_next, inner.to_next, LaneVector6{});
#pragma GCC unroll 1
    for (int c = 0; c < 6; ++c)
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
        for (int r = 0; r < 6; ++r) across[c][r] -= to_next[r][i] * inner.to_begin[c][i];
#pragma GCC unroll 1
    for (int c = 0; c < 6; ++c) {
      backward(inner.factor, inner.to_begin[c]);
      backward(inner.factor, inner.to_next[c]);
      to_begin[c] = across[c];
    }
    s = next;
  }
  for (int lane = 0; lane < batch.count; ++lane) add(places_[batch.first_strut + at(lane)], lane, begin, s, to_begin);
  return positive;
}

void Condensation::add(const Places& to, int lane, const LaneBlock& begin, const LaneBlock& end,
                       const LaneVector6 (&end_begin)[6]) {
  if (to.begin >= 0) add_symmetric(begin, lane, matrix_.blocks[at(to.begin)]);
  if (to.end >= 0) add_symmetric(end, lane, matrix_.blocks[at(to.end)]);
  if (to.end_begin < 0) return;
  add_columns(end_begin, lane, matrix_.blocks[at(to.end_begin)]);
  add_transposed(end_begin, lane, matrix_.blocks[at(to.begin_end)]);
}

void Condensation::add_links() {
  LaneJoint joint{};
  const int links = static_cast<int>(graph_.links.size());
  for (int first = 0; first < links; first += lane_width) {
    const int count = std::min(lane_width, links - first);
    for (int lane = 0; lane < count; ++lane) {
      const std::size_t k = at(graph_.links[at(first + lane)]);
      joint.set(lane, linearization_->joints[k], false, stiffness_[k]);
    }
    LaneBlock a{}, b{};
    LaneVector6 b_a[6];
    add_square(joint.before, joint.c, a);
    add_square(joint.after, joint.c, b);
    product(joint.after, joint.c, joint.before, b_a);
    for (int lane = 0; lane < count; ++lane) add(places_[graph_.struts.size() + at(first + lane)], lane, a, b, b_a);
  }
}

void Condensation::condense(const VectorX& r, VectorX& g) {
  std::fill(motion_.begin(), motion_.end(), Lane8{});
  for (std::size_t k = 0; k < rod_->joints.size(); ++k) {
    Lane8 on_a, on_b;
    impulses(linearization_->joints[k], stiffness_[k] * load6(r.data() + 6 * k), on_a, on_b);
    motion_[at(rod_->joints[k].a)] += on_a;
    motion_[at(rod_->joints[k].b)] += on_b;
  }
  for (const Batch& batch : batches_) condense(batch);
  g.resize(matrix_.unknowns());
  for (std::size_t c = 0; c < graph_.crossings.size(); ++c) store6(g.data() + 6 * c, motion_[at(graph_.crossings[c])]);
}

void Condensation::condense(const Batch& batch) {
  LaneVector6 begin{}, next{};
  for (int p = 0; p < batch.segments; ++p) {
    Inner& inner = inner_[batch.first_inner + at(p)];
    for (int lane = 0; lane < lane_width; ++lane) {
      const Lane8& f = motion_[at(strut(batch, lane).segments[at(p)])];
      for (int i = 0; i < 6; ++i) inner.f[i][lane] = next[i][lane] + f[i];
    }
    subtract_transposed(inner.to_begin, inner.f, begin);
    next = LaneVector6{};
    subtract_transposed(inner.to_next, inner.f, next);
  }
  for (int lane = 0; lane < batch.count; ++lane) {
    const Strut& of = strut(batch, lane);
    for (int i = 0; i < 6; ++i) {
      if (of.begin >= 0) motion_[at(graph_.crossings[at(of.begin)])][i] += begin[i][lane];
      if (of.end >= 0) motion_[at(graph_.crossings[at(of.end)])][i] += next[i][lane];
    }
  }
}

void Condensation::expand(const VectorX& r, const double* y, VectorX& d) {
  for (std::size_t s = 0; s < motion_.size(); ++s)
    if (rod_->segments[s].is_static) motion_[s] = Lane8{};
  for (std::size_t c = 0; c < graph_.crossings.size(); ++c) motion_[at(graph_.crossings[c])] = load6(y + 6 * c);
  for (const Batch& batch : batches_) expand(batch);
  d.resize(r.size());
  for (std::size_t k = 0; k < rod_->joints.size(); ++k) {
    const Joint& joint = rod_->joints[k];
    store6(d.data() + 6 * k,
           stiffness_[k] * (load6(r.data() + 6 * k) -
                            constraint_change(linearization_->joints[k], motion_[at(joint.a)], motion_[at(joint.b)])));
  }
}

void Condensation::expand(const Batch& batch) {
  LaneVector6 begin{}, next{};
  for (int lane = 0; lane < lane_width; ++lane) {
    const Strut& of = strut(batch, lane);
    for (int i = 0; i < 6; ++i) {
      if (of.begin >= 0) begin[i][lane] = motion_[at(graph_.crossings[at(of.begin)])][i];
      if (of.end >= 0) next[i][lane] = motion_[at(graph_.crossings[at(of.end)])][i];
    }
  }
  for (int p = batch.segments; p-- > 0;) {
    const Inner& inner = inner_[batch.first_inner + at(p)];
    LaneVector6 y = inner.f;
    forward(inner.factor, y);
    y = divided(inner.factor, y);
    backward(inner.factor, y);
    subtract_product(y, inner.to_begin, begin);
    subtract_product(y, inner.to_next, next);
    for (int lane = 0; lane < batch.count; ++lane) {
      Lane8& to = motion_[at(strut(batch, lane).segments[at(p)])];
      for (int i = 0; i < 6; ++i) to[i] = y[i][lane];
    }
    next = y;
  }
}

void Condensation::load(int segment, const Lane8 (&force)[6], std::vector<Lane8>& g) {
  g.assign(at(matrix_.unknowns()), Lane8{});
  loaded_ = home_[at(segment)];
  if (loaded_.batch < 0) {
    std::copy_n(force, 6, g.data() + 6 * graph_.place[at(segment)]);
    return;
  }
  const Batch& batch = batches_[at(loaded_.batch)];
  const Strut& of = strut(batch, loaded_.lane);
  loads_.resize(at(batch.segments - loaded_.segment));
  std::copy_n(force, 6, loads_.front().begin());
  std::array<Lane8, 6> begin{};
  for (std::size_t p = 0; p < loads_.size(); ++p) {
    const Inner& inner = inner_[batch.first_inner + at(loaded_.segment) + p];
    std::array<Lane8, 6> next{};
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r < 6; ++r) {
        begin[at(c)] -= inner.to_begin[c][r][loaded_.lane] * loads_[p][at(r)];
        next[at(c)] -= inner.to_next[c][r][loaded_.lane] * loads_[p][at(r)];
      }
    if (p + 1 < loads_.size())
      loads_[p + 1] = next;
    else if (of.end >= 0)
      std::copy_n(next.begin(), 6, g.data() + 6 * of.end);
  }
  if (of.begin >= 0)
    for (int r = 0; r < 6; ++r) g[at(6 * of.begin + r)] += begin[at(r)];
}

void Condensation::motion_of(int segment, const std::vector<Lane8>& y, Lane8 (&out)[6]) const {
  const Home& home = home_[at(segment)];
  const auto of_crossing = [&](int crossing, Lane8(&motion)[6]) {
    if (crossing < 0)
      std::fill_n(motion, 6, Lane8{});
    else
      std::copy_n(y.data() + 6 * crossing, 6, motion);
  };
  if (home.batch < 0) return of_crossing(graph_.place[at(segment)], out);
  const Batch& batch = batches_[at(home.batch)];
  const Strut& strut = this->strut(batch, home.lane);
  const bool loaded = loaded_.batch == home.batch && loaded_.lane == home.lane;
  Lane8 begin[6];
  of_crossing(strut.begin, begin);
  of_crossing(strut.end, out);
  for (int p = batch.segments; p-- > home.segment;) {
    const Inner& inner = inner_[batch.first_inner + at(p)];
    Lane8 motion[6]{};
    if (loaded && p >= loaded_.segment) {
      const auto l = [&](int row, int column) { return inner.factor.at(row, column)[home.lane]; };
      std::copy_n(loads_[at(p - loaded_.segment)].begin(), 6, motion);
      for (int i = 1; i < 6; ++i)
        for (int j = 0; j < i; ++j) motion[i] -= l(i, j) * motion[j];
      for (int i = 0; i < 6; ++i) motion[i] *= inner.factor.inverse_pivot[i][home.lane];
      for (int i = 4; i >= 0; --i)
        for (int j = i + 1; j < 6; ++j) motion[i] -= l(j, i) * motion[j];
    }
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r < 6; ++r)
        motion[r] -= inner.to_begin[c][r][home.lane] * begin[c] + inner.to_next[c][r][home.lane] * out[c];
    std::copy_n(motion, 6, out);
  }
}

double Condensation::residual_norm(const double* p) const {
  double sum = 0;
  const auto motion_of = [&](int segment) {
    const int place = graph_.place[at(segment)];
    return place < 0 ? Lane8{} : inverse_mass_[at(segment)] * load6(p + 6 * place);
  };
  for (const int k : near_) {
    const Joint& joint = rod_->joints[at(k)];
    const Lane8 change = constraint_change(linearization_->joints[at(k)], motion_of(joint.a), motion_of(joint.b));
    const Lane8 square = change * change;
    sum += ((square[0] + square[1]) + (square[2] + square[3])) + (square[4] + square[5]);
  }
  return std::sqrt(sum);
}

}  // namespace rodsweep
