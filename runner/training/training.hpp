// Trains a network epoch by epoch on all ranks of a communicator: the same bits on any number of them, and the same
// whether it went through or was interrupted and restored.
//
// An epoch ends with the mean loss over the validation examples and, every so many epochs, with the CG ratio over
// validation simulations. The model kept is that of the epoch with the least validation loss. Needs PETSc.
#pragma once

#include <memory>

#include "network/processor/model.hpp"
#include "network/training/trainer.hpp"
#include "runner/training/checkpoint.hpp"
#include "runner/training/model_card.hpp"
#include "runner/training/shard_exchange.hpp"
#include "runner/training/training_data.hpp"

namespace rodsweep {

class Training {
 public:
  /// All arguments must outlive this; `simulations` are this rank's part. Collective, like step() and end().
  Training(const Job& job, const TrainingJob& settings, const TrainingData& data,
           std::vector<StoredSimulation> simulations, int threads, MPI_Comm comm);

  /// Goes on from where a training with these settings was left.
  void restore(const ModelCard& card, const Model& kept, const Checkpoint& checkpoint);
  Checkpoint checkpoint() const;

  /// One step of the optimiser, and the end of the epoch if it was its last. Returns whether any rank wants to stop.
  bool step(bool stop);
  bool at_epoch_begin() const { return trainer_.step() % trainer_.steps_per_epoch() == 0; }
  bool ended() const { return card_.ending != Ending::none; }
  /// Measures the CG ratio of the model kept and of its base guess.
  void end();

  const Trainer& trainer() const { return trainer_; }
  /// All that is known of the model kept, but for the starts.
  const ModelCard& card() const { return card_; }
  /// The model of the best epoch; before the first has ended, as it was at the start.
  const Model& kept() const { return *kept_; }

 private:
  void end_epoch();
  double validation_loss();
  using SimulationRatios = std::vector<ValidationRatio::Ratios>;
  SimulationRatios ratios(const ValidationRatio::MakeGuess& make_guess) const;
  SimulationRatios ratios(const std::shared_ptr<const Model>& model) const;
  /// Over all simulations, or those of one type of scene; NaN where nothing was measured.
  ValidationRatio::Ratios mean(const SimulationRatios& ratios, const std::string& scene = "") const;
  void diverge(const char* loss);

  const TrainingJob& settings_;
  const TrainingData& data_;
  std::shared_ptr<Model> model_, kept_;  ///< as it is now, and of the best epoch
  Trainer trainer_;
  ShardExchange exchange_;
  ValidationRatio ratio_;
  ModelCard card_;
  double epoch_loss_ = 0, epoch_seconds_ = 0;
};

}  // namespace rodsweep
