// What a COPINGNet is made of, apart from its weights.
#pragma once

#include "network/encoding/graph_encoding.hpp"

namespace rodsweep {

/// The part between the features and the corrections.
enum class Processor {
  sweeps,          ///< two recurrent passes over the tree (network/processor/sweeps.hpp)
  factors,         ///< factors of the matrix, and a solve with them (network/processor/factor_sweeps.hpp)
  message_passing  ///< hops over the graph (network/processor/message_passing.hpp)
};

/// What carries the sweeps' states from joint to joint.
enum class Recurrence {
  gated,  ///< gated recurrent units (network/layers/gru.hpp)
  linear  ///< in the state (network/layers/linear_recurrence.hpp): cheaper
};

/// Which couplings of the matrix factors have: those of the forest of joints (network/processor/factor_sweeps.hpp), or
/// all (network/processor/coupled_factors.hpp).
enum class Couplings { tree, all };

/// The guess that the network corrects: none (zero), quadratic extrapolation in time, least squares of the last
/// `base_size` right-hand sides, or projection onto the last `base_size` solutions.
enum class BaseGuess { none, extrapolation, regression, subspace };

struct CopingNetSettings {
  Encoding encoding = Encoding::system;
  Processor processor = Processor::sweeps;
  BaseGuess base = BaseGuess::subspace;
  int base_size = 10;                         ///< regression, subspace
  int latent = 32;                            ///< width of hidden layers and states
  Recurrence recurrence = Recurrence::gated;  ///< sweeps
  Couplings couplings = Couplings::tree;      ///< factors
  int steps = 6;                              ///< message_passing: hops
  int hidden_layers = 1;                      ///< message_passing: of every MLP
  bool globals = false;                       ///< message_passing: with a state of the whole graph
  bool best_length =
      true;            ///< the correction is scaled to what lowers the error most (network/training/energy_loss.hpp)
  bool moves = false;  ///< message_passing: also predicts the segments' moves, for `end_to_end`; of `state` alone
};

/// Whether there are corrections of multipliers, and so a guess; a simulator's network answers for segments alone.
inline bool is_guess(const CopingNetSettings& settings) { return settings.encoding != Encoding::state; }

/// Whether features have means and deviations of a training set.
inline bool has_scales(const CopingNetSettings& settings) {
  return is_of_graphs(settings.encoding) || settings.encoding == Encoding::state;
}

/// Whether there are factors of all couplings.
inline bool has_all_couplings(const CopingNetSettings& settings) {
  return settings.processor == Processor::factors && settings.couplings == Couplings::all;
}

}  // namespace rodsweep
