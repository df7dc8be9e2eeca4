// Trains a COPINGNet on examples. Mini-batches have a fixed number of shards, whose gradients are summed in a fixed
// order. Therefore any distribution of the shards over processes gives the same bits.
//
// Threads share the shards of a step, and the batches of losses(). All read the same examples.
//
// Step t of an epoch takes the next `batch` examples of a permutation that depends on (seed, epoch) alone; its shards
// are equal parts of it. Adam's rate rises linearly over the first `warm_up` of all steps, then falls along a cosine to
// zero. The gradient's norm is clipped, to `clip` and to three times its usual size.
#pragma once

#include <cstdint>
#include <functional>

#include "network/processor/coping_net.hpp"
#include "network/training/adam.hpp"
#include "network/training/correction_loss.hpp"
#include "network/training/energy_loss.hpp"
#include "network/training/example.hpp"

namespace rodsweep {

enum class LossKind {
  mse,         ///< mean square of the outputs' errors
  energy,      ///< energy norm of the guess's error
  in_the_loop  ///< the same after `cg_steps` steps of CG, or corrections with factors of all couplings
};

struct TrainingSettings {
  LossKind loss = LossKind::energy;
  int cg_steps = 4;  ///< in_the_loop
  int epochs = 40;
  int batch = 32;  ///< examples per step
  int shards = 4;  ///< per step; a divisor of `batch`
  double rate = 2e-3;
  double warm_up = 0.02;  ///< fraction of all steps
  double weight_decay = 0;
  double clip = 1;  ///< largest norm of the mean gradient
  std::uint64_t seed = 0;
};

class Trainer {
 public:
  /// `net` and `examples` must outlive the trainer. Throws std::invalid_argument for inconsistent settings.
  Trainer(CopingNet<float>& net, const std::vector<Example>& examples, const TrainingSettings& settings,
          int threads = 1);

  std::int64_t steps_per_epoch() const { return steps_per_epoch_; }
  std::int64_t steps() const { return steps_per_epoch_ * settings_.epochs; }
  std::int64_t step() const { return step_; }  ///< steps taken

  /// The contributions of shards to the next step: a loss, then its gradient. `out` has shard_size() entries.
  struct Shard {
    int number;
    float* out;
  };
  std::size_t shard_size() const { return 1 + net_.parameters().values().size(); }
  void compute(const std::vector<Shard>& shards);
  /// Takes the step from the contributions of all shards in order; returns its mean loss.
  double update(const std::vector<const float*>& shards);

  double rate() const { return rate_; }  ///< of the last step

  /// Sums of the losses of consecutive batches of examples, without gradients; 0 unless wanted(batch).
  std::vector<double> losses(const std::vector<Example>& examples, const std::function<bool(int batch)>& wanted);

  /// The state of the trainer: with it and the parameters, training continues exactly.
  struct State {
    std::int64_t step = 0;
    AlignedVector<float> mean, square;
  };
  State state() const;
  void restore(const State& state);

 private:
  /// The buffers of a thread.
  struct Workspace {
    EnergyLoss<float> energy;
    CorrectionLoss<float> corrections;
    Parameters<float> gradient;
    CopingNet<float>::Tape tape;
    Tensor<float> y, y_nodes, d, dy, dy_nodes, d_factors;
  };
  double evaluate(const std::vector<const Example*>& examples, Workspace& with, bool with_gradient) const;
  void shuffle(std::int64_t epoch);
  void count_entries();

  CopingNet<float>& net_;
  const std::vector<Example>& examples_;
  TrainingSettings settings_;
  std::int64_t steps_per_epoch_ = 0, step_ = 0, shuffled_epoch_ = -1;
  double rate_ = 0;
  double edge_entries_ = 0, node_entries_ = 0;  ///< mean number of outputs per example, for the mse
  std::vector<std::uint32_t> order_;
  Adam adam_;
  Parameters<float> sum_;  ///< of the shards' gradients
  std::vector<Workspace> workspaces_;
};

}  // namespace rodsweep
