// The training set of the nearest-neighbour guess: stored systems of unbranched rods, searched by similarity.
//
// A query describes a system: the state of its rod (network/guess/chain_profile.hpp) at `points` values of the arc
// length, and the rod's constants. Each quantity is shifted and divided by its deviation over the training set; the
// distance of two queries is the root of the sum, over the quantities, of the mean square difference of their
// components. The five quantities of the state have equal weights (without velocities or gaps the neighbours are
// worse), the constants have a tenth, because the state already shows their effect. `shape` compares positions and
// curvature only, the inputs of the paper's network. Systems are compared with those of the same Newton iteration only.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "network/encoding/normalisation.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/guess/chain_profile.hpp"

namespace rodsweep {

/// The quantities that are compared.
enum class KnnInputs {
  all,   ///< the whole state
  shape  ///< the joints' positions and the curvature; no gaps or velocities
};

class KnnSet {
 public:
  static constexpr int points = 8;
  static constexpr int query_size = points * ChainProfile::state_size + ChainProfile::constant_count;
  using Query = std::array<float, query_size>;

  /// The systems nearest to a query, nearest first. On entry the size of the vectors is the number requested.
  struct Neighbours {
    std::vector<std::uint32_t> system;
    std::vector<float> distance;
  };
  /// The solution of a system: [6, joints] at `arc`.
  struct Loads {
    const std::vector<float>& arc;
    Eigen::Map<const Tensor<float>> values;
  };

  explicit KnnSet(KnnInputs inputs = KnnInputs::all);
  ~KnnSet();

  /// Adds a simulation, which is not needed afterwards. Throws SceneError if a rod is not a chain.
  void add(const StoredSimulation& simulation);
  /// Normalises and indexes. Call once, after the last simulation.
  void finish();

  /// Number of systems of a Newton iteration.
  int size(int newton) const;
  /// The query, before normalisation, for the state [state_size, joints] of a rod with this profile.
  static Query query(const ChainProfile& profile, const Tensor<float>& state);
  /// Finds out.system.size() neighbours, or fewer if there are fewer systems; returns their number. Allocates nothing.
  int nearest(int newton, const Query& query, Neighbours& out) const;
  Loads loads(int newton, std::uint32_t system) const;

 private:
  struct Iteration;
  KnnInputs inputs_;
  std::vector<std::unique_ptr<Iteration>> iterations_;  ///< by Newton iteration
  std::vector<std::vector<float>> arcs_;                ///< of every added rod
};

}  // namespace rodsweep
