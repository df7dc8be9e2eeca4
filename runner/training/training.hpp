// Trains a network on all ranks of a communicator. The result has the same bits for any number of ranks, and after any
// interruptions.
//
// Each epoch ends with the mean loss over the validation examples; every `ratio_every_epochs`, also with the CG ratio
// over validation simulations. Keeps the model of the epoch with the least validation loss. Needs PETSc.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "network/processor/model.hpp"
#include "network/training/trainer.hpp"
#include "runner/training/learning_sets.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {

/// Exchanges gradients between the ranks of a training, in shard_exchange.cpp. There is no master: each rank computes
/// its shards of a step and receives the others. Every rank sums in the order of shards, so that all ranks get the same
/// bits, as does a single rank.
class ShardExchange {
 public:
  /// Collective. `size`: number of values in a shard.
  ShardExchange(MPI_Comm comm, int shards, std::size_t size);

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  bool is_mine(std::int64_t part) const {
    return part % ranks_ == rank_;
  }  ///< for shards and any other distributed work

  using Compute = std::function<void(const std::vector<Trainer::Shard>& own)>;

  /// Collective: computes this rank's shards and gathers all. Returns whether any rank was given `stop`.
  bool gather(const Compute& compute, bool stop);
  /// All shards of the last gather(), in order.
  const std::vector<const float*>& shards() const { return shards_; }

  /// Collective sum. Each entry is set on one rank and zero on the others.
  void share(std::vector<double>& values) const;

 private:
  std::size_t first_of(int rank) const { return static_cast<std::size_t>(first_[static_cast<std::size_t>(rank)]); }

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1, count_;
  std::size_t size_;
  std::vector<int> first_, length_;  ///< each rank's part of `numbers_`: stop flag, then its shards
  std::vector<float> numbers_;
  std::vector<const float*> shards_;
};

class Training {
 public:
  /// All arguments must outlive this; `simulations` are this rank's part. Collective, like step() and end().
  Training(const Job& job, const TrainingJob& settings, const TrainingData& data,
           std::vector<StoredSimulation> simulations, int threads, MPI_Comm comm);

  /// Resumes a training with the same settings.
  void restore(const ModelCard& card, const Model& kept, const Checkpoint& checkpoint);
  Checkpoint checkpoint() const;

  /// One step of the optimiser; the last one of an epoch also ends it. Returns whether `stop` is true on any rank.
  bool step(bool stop);
  bool at_epoch_begin() const { return trainer_.step() % trainer_.steps_per_epoch() == 0; }
  bool ended() const { return card_.ending != Ending::none; }
  /// Measures the CG ratio of the best model and of its base guess.
  void end();

  const Trainer& trainer() const { return trainer_; }
  /// The metadata of the best model, without the runs.
  const ModelCard& card() const { return card_; }
  /// The model of the best epoch; the initial model until the first epoch ends.
  const Model& kept() const { return *kept_; }

 private:
  void end_epoch();
  double validation_loss();
  using SimulationRatios = std::vector<ValidationRatio::Ratios>;
  SimulationRatios ratios(const ValidationRatio::MakeGuess& make_guess) const;
  SimulationRatios ratios(const std::shared_ptr<const Model>& model) const;
  /// Mean over all simulations, or over one scene type; NaN if nothing was measured.
  ValidationRatio::Ratios mean(const SimulationRatios& ratios, const std::string& scene = "") const;
  void diverge(const char* loss);

  const TrainingJob& settings_;
  const TrainingData& data_;
  std::shared_ptr<Model> model_, kept_;  ///< current; of the best epoch
  Trainer trainer_;
  ShardExchange exchange_;
  ValidationRatio ratio_;
  ModelCard card_;
  double epoch_loss_ = 0, epoch_seconds_ = 0, epoch_processor_seconds_ = 0;
};

}  // namespace rodsweep
