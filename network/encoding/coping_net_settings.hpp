// The structure of a COPINGNet: everything except its weights.
#pragma once

#include "network/encoding/graph_encoding.hpp"

namespace rodsweep {

/// The part between the features and the corrections.
enum class Processor {
  factors,         ///< factors of the matrix, and a solve with them (network/processor/factor_sweeps.hpp)
  message_passing  ///< hops over the graph (network/processor/message_passing.hpp)
};

/// The couplings that the factors include: those of the forest of joints (network/processor/factor_sweeps.hpp), or all
/// (network/processor/coupled_factors.hpp).
enum class Couplings { tree, all };

/// The guess that the network corrects: none (zero), quadratic extrapolation in time, least squares of the last
/// `base_size` right-hand sides, or projection onto the last `base_size` solutions.
enum class BaseGuess { none, extrapolation, regression, subspace };

struct CopingNetSettings {
  Encoding encoding = Encoding::linear_system;
  Processor processor = Processor::factors;
  BaseGuess base = BaseGuess::regression;
  int base_size = 6;                      ///< regression, subspace
  int latent = 16;                        ///< width of hidden layers and states
  Couplings couplings = Couplings::tree;  ///< factors
  int steps = 6;                          ///< message_passing: hops
  int hidden_layers = 1;                  ///< message_passing: of every MLP
  bool globals = false;                   ///< message_passing: with a state of the whole graph
  bool best_length =
      true;  ///< scale the correction to the length that reduces the error most (network/training/energy_loss.hpp)
  bool moves =
      false;  ///< message_passing: also predict the segments' moves, for `end_to_end`; `state` predicts only moves
};

/// Whether the network corrects multipliers, and so makes a guess; `state` predicts moves of segments only.
inline bool is_guess(const CopingNetSettings& settings) { return settings.encoding != Encoding::state; }

/// Whether features are normalised by a training set's means and deviations.
inline bool has_scales(const CopingNetSettings& settings) {
  return is_of_graphs(settings.encoding) || settings.encoding == Encoding::state;
}

/// Whether the factors include all couplings.
inline bool has_all_couplings(const CopingNetSettings& settings) {
  return settings.processor == Processor::factors && settings.couplings == Couplings::all;
}

}  // namespace rodsweep
