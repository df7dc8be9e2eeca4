#include "network/guess/knn.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

namespace rodsweep {
namespace {

constexpr float constant_weight = 0.1F;
constexpr int sampled_size = KnnSet::points * ChainProfile::state_size;

const std::vector<float>& sampled_arc() {
  static const std::vector<float> arc = [] {
    std::vector<float> out;
    for (int i = 0; i < KnnSet::points; ++i) out.push_back(static_cast<float>(i) / (KnnSet::points - 1));
    return out;
  }();
  return arc;
}

/// A query's two parts: [state_size, points] and [constant_count, 1].
template <class Query>
auto sampled(Query& query) {
  using Matrix = std::conditional_t<std::is_const_v<Query>, const Tensor<float>, Tensor<float>>;
  return Eigen::Map<Matrix>(query.data(), ChainProfile::state_size, KnnSet::points);
}
template <class Query>
auto constants(Query& query) {
  using Matrix = std::conditional_t<std::is_const_v<Query>, const Tensor<float>, Tensor<float>>;
  return Eigen::Map<Matrix>(query.data() + sampled_size, ChainProfile::constant_count, 1);
}

}  // namespace

/// The systems of one Newton iteration, with the interface that nanoflann requires.
struct KnnSet::Iteration {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Adaptor<float, Iteration>, Iteration, query_size,
                                                   std::uint32_t>;
  std::vector<Query> queries;
  std::vector<std::size_t> rod;
  std::vector<std::size_t> first_load;  ///< of each system
  std::vector<float> loads;
  Normalisation of_state, of_constants;
  std::unique_ptr<Tree> tree;

  std::size_t kdtree_get_point_count() const { return queries.size(); }
  float kdtree_get_pt(std::size_t system, std::size_t feature) const { return queries[system][feature]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

  void normalise(Query& query) const {
    of_state.apply(sampled(query));
    of_constants.apply(constants(query));
  }
};

KnnSet::KnnSet(KnnInputs inputs) : inputs_(inputs) {}
KnnSet::~KnnSet() = default;

void KnnSet::add(const StoredSimulation& simulation) {
  Replay replay(simulation);
  std::vector<ChainProfile> profiles;
  const std::size_t first_rod = arcs_.size();
  for (const Rod& rod : replay.scene().rods) {
    profiles.emplace_back(rod, replay.scene().gravity_m_s2);
    arcs_.push_back(profiles.back().arc());
  }
  Tensor<float> state, loads;
  replay.run([&](const StoredSystem& stored, const Rod& rod, const LinearSystem& system) {
    const auto r = static_cast<std::size_t>(stored.at.rod), j = static_cast<std::size_t>(stored.at.newton);
    state.resize(ChainProfile::state_size, rod.joint_count());
    loads.resize(6, rod.joint_count());
    profiles[r].state(rod, system, rod.constraint_dt, state);
    profiles[r].loads(stored.solution, rod.constraint_dt, loads);
    while (iterations_.size() <= j) iterations_.push_back(std::make_unique<Iteration>());
    Iteration& of = *iterations_[j];
    of.queries.push_back(query(profiles[r], state));
    of.rod.push_back(first_rod + r);
    of.first_load.push_back(of.loads.size());
    of.loads.insert(of.loads.end(), loads.data(), loads.data() + loads.size());
  });
}

void KnnSet::finish() {
  for (const std::unique_ptr<Iteration>& of : iterations_) {
    if (of->queries.empty()) continue;
    FeatureStatistics state(ChainProfile::state_groups()), constant({1, 1});
    for (const Query& query : of->queries) {
      state.accumulate(sampled(query));
      constant.accumulate(constants(query));
    }
    of->of_state = state.normalisation();
    of->of_constants = constant.normalisation();
    Eigen::Index first = 0;
    for (const int size : ChainProfile::state_groups()) {  // so that sums over components and points are means
      of->of_state.deviation.segment(first, size) *= std::sqrt(static_cast<float>(size * points));
      first += size;
    }
    if (inputs_ == KnnInputs::shape)
      of->of_state.deviation.tail(ChainProfile::state_size - ChainProfile::shape_size) =
          std::numeric_limits<float>::infinity();  // ignores the other features
    of->of_constants.deviation /= constant_weight;
    for (Query& query : of->queries) of->normalise(query);
    of->tree = std::make_unique<Iteration::Tree>(query_size, *of, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  }
}

int KnnSet::size(int newton) const {
  const auto j = static_cast<std::size_t>(newton);
  return j < iterations_.size() ? static_cast<int>(iterations_[j]->queries.size()) : 0;
}

KnnSet::Query KnnSet::query(const ChainProfile& profile, const Tensor<float>& state) {
  Query out{};
  add_resampled(profile.arc(), state, sampled_arc(), 1, sampled(out));
  std::copy(profile.constants().begin(), profile.constants().end(), out.begin() + sampled_size);
  return out;
}

int KnnSet::nearest(int newton, const Query& query, Neighbours& out) const {
  if (size(newton) == 0) return 0;
  const Iteration& of = *iterations_[static_cast<std::size_t>(newton)];
  Query normalised = query;
  of.normalise(normalised);
  const std::size_t found =
      of.tree->knnSearch(normalised.data(), out.system.size(), out.system.data(), out.distance.data());
  for (std::size_t i = 0; i < found; ++i) out.distance[i] = std::sqrt(out.distance[i]);
  return static_cast<int>(found);
}

KnnSet::Loads KnnSet::loads(int newton, std::uint32_t system) const {
  const Iteration& of = *iterations_[static_cast<std::size_t>(newton)];
  const std::vector<float>& arc = arcs_[of.rod[system]];
  return {arc, {&of.loads[of.first_load[system]], 6, static_cast<Eigen::Index>(arc.size())}};
}

}  // namespace rodsweep
