// What the nearest-neighbour guess learned: stored systems of unbranched rods, found again by their likeness.
//
// A system is known by a query: the state of its rod (network/guess/chain_profile.hpp) at `points` values of the arc
// length, and the rod's constants. Each quantity is shifted and divided by its deviation over the training set; the
// distance of two queries is the root of the sum, over the quantities, of the mean square difference of their
// components. The five of the state weigh the same (without velocities, or without the gaps, the neighbours are worse),
// the constants a tenth: the state shows already what they do. With `shape` alone, places and curvature, neighbours
// know no more than the paper's network. Systems are compared with those of the same Newton iteration only.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "network/encoding/normalisation.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/guess/chain_profile.hpp"

namespace rodsweep {

/// What neighbours are alike in.
enum class KnnInputs {
  all,   ///< of the state
  shape  ///< the places of the joints and the curvature: no gaps, no velocities
};

class KnnSet {
 public:
  static constexpr int points = 8;
  static constexpr int query_size = points * ChainProfile::state_size + ChainProfile::constant_count;
  using Query = std::array<float, query_size>;

  /// The systems nearest to a query, from the nearest on; as many as the vectors are long when they are passed in.
  struct Neighbours {
    std::vector<std::uint32_t> system;
    std::vector<float> distance;
  };
  /// The solution of one of them: [6, joints] at `arc`.
  struct Loads {
    const std::vector<float>& arc;
    Eigen::Map<const Tensor<float>> values;
  };

  explicit KnnSet(KnnInputs inputs = KnnInputs::all);
  ~KnnSet();

  /// Takes in a simulation, which is not needed afterwards. Throws SceneError where a rod branches.
  void add(const StoredSimulation& simulation);
  /// Normalises and indexes. To be called once, after the last simulation.
  void finish();

  /// Systems of a Newton iteration.
  int size(int newton) const;
  /// Before normalisation: the state, [state_size, joints], of a rod with this profile.
  static Query query(const ChainProfile& profile, const Tensor<float>& state);
  /// Finds out.system.size() neighbours, or fewer where there are fewer systems; returns how many. Allocates nothing.
  int nearest(int newton, const Query& query, Neighbours& out) const;
  Loads loads(int newton, std::uint32_t system) const;

 private:
  struct Iteration;
  KnnInputs inputs_;
  std::vector<std::unique_ptr<Iteration>> iterations_;  ///< by Newton iteration
  std::vector<std::vector<float>> arcs_;                ///< of every rod taken in
};

}  // namespace rodsweep
