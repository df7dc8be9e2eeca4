#include "network/training/trainer.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "network/training/mse_loss.hpp"
#include "network/training/threads.hpp"
#include "solver/numbers/counter_random.hpp"

namespace rodsweep {
namespace {

// A longer gradient, relative to the usual one, would move all weights by several times the rate: enough to kill a
// network of small factors, which then never recovers.
constexpr double largest_spike = 3;

/// Element `index`, from 1, of a seed's random sequence. It gives the same permutations on every machine.
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t index) {
  return split_mix(seed + (index - 1) * split_mix_increment);
}

}  // namespace

Trainer::Trainer(CopingNet<float>& net, const std::vector<Example>& examples, const TrainingSettings& settings,
                 int threads)
    : net_(net),
      examples_(examples),
      settings_(settings),
      order_(examples.size()),
      adam_(net.parameters().values().size(), {0.9, 0.999, 1e-8, settings.weight_decay}),
      sum_(net.parameters().zeros()) {
  const EnergyLoss<float> energy(settings.loss == LossKind::in_the_loop ? settings.cg_steps : 0,
                                 net.settings().best_length);
  for (int i = 0; i < threads; ++i)
    workspaces_.push_back(
        {energy, CorrectionLoss<float>(settings.cg_steps), net.parameters().zeros(), {}, {}, {}, {}, {}, {}, {}});
  if (settings.shards < 1 || settings.batch % settings.shards != 0)
    throw std::invalid_argument("Trainer: a batch of " + std::to_string(settings.batch) + " cannot be divided into " +
                                std::to_string(settings.shards) + " equal shards");
  steps_per_epoch_ = static_cast<std::int64_t>(examples.size()) / settings.batch;
  if (steps_per_epoch_ == 0)
    throw std::invalid_argument("Trainer: " + std::to_string(examples.size()) +
                                " examples are less than one batch of " + std::to_string(settings.batch));
  count_entries();
}

void Trainer::count_entries() {
  double edges = 0, nodes = 0;
  for (const Example& example : examples_) {
    edges += static_cast<double>(example.edge_target.size());
    nodes += static_cast<double>(example.node_target.size());
  }
  edge_entries_ = edges / static_cast<double>(examples_.size());
  node_entries_ = nodes / static_cast<double>(examples_.size());
}

void Trainer::shuffle(std::int64_t epoch) {
  if (epoch == shuffled_epoch_) return;
  std::iota(order_.begin(), order_.end(), 0u);
  const std::uint64_t key = random_bits(settings_.seed, static_cast<std::uint64_t>(epoch) + 1);
  for (std::size_t i = order_.size() - 1; i > 0; --i)  // Fisher and Yates
    std::swap(order_[i], order_[random_bits(key, i) % (i + 1)]);
  shuffled_epoch_ = epoch;
}

void Trainer::compute(const std::vector<Shard>& shards) {
  shuffle(step_ / steps_per_epoch_);
  const auto size = static_cast<std::size_t>(settings_.batch / settings_.shards);
  const std::size_t begin =
      static_cast<std::size_t>(step_ % steps_per_epoch_) * static_cast<std::size_t>(settings_.batch);
  in_parallel(static_cast<int>(shards.size()), static_cast<int>(workspaces_.size()), [&](int item, int thread) {
    const Shard& shard = shards[static_cast<std::size_t>(item)];
    Workspace& with = workspaces_[static_cast<std::size_t>(thread)];
    const std::size_t first = begin + static_cast<std::size_t>(shard.number) * size;
    std::vector<const Example*> chosen;
    for (std::size_t i = first; i < first + size; ++i) chosen.push_back(&examples_[order_[i]]);
    AlignedVector<float>& gradient = with.gradient.values();
    std::fill(gradient.begin(), gradient.end(), 0.F);
    shard.out[0] = static_cast<float>(evaluate(chosen, with, true));
    std::copy(gradient.begin(), gradient.end(), shard.out + 1);
  });
}

double Trainer::update(const std::vector<const float*>& shards) {
  AlignedVector<float>& sum = sum_.values();
  std::fill(sum.begin(), sum.end(), 0.F);
  double loss = 0, square = 0;
  for (const float* shard : shards) {
    loss += static_cast<double>(shard[0]);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += shard[1 + i];
  }
  for (const float g : sum) square += static_cast<double>(g) * static_cast<double>(g);
  const double mean = 1.0 / settings_.batch, norm = mean * std::sqrt(square);
  const double most = std::min(settings_.clip, largest_spike * adam_.usual_norm());
  const auto factor = static_cast<float>(norm > most ? mean * most / norm : mean);
  for (float& g : sum) g *= factor;

  const double done = static_cast<double>(step_ + 1) / static_cast<double>(steps());
  rate_ = settings_.rate * (done < settings_.warm_up
                                ? done / settings_.warm_up
                                : 0.5 * (1 + std::cos(pi * (done - settings_.warm_up) / (1 - settings_.warm_up))));
  adam_.step(rate_, sum, net_.parameters().values());
  ++step_;
  return loss * mean;
}

std::vector<double> Trainer::losses(const std::vector<Example>& examples,
                                    const std::function<bool(int batch)>& wanted) {
  const auto batch = static_cast<std::size_t>(settings_.batch);
  std::vector<double> sums((examples.size() + batch - 1) / batch);
  in_parallel(static_cast<int>(sums.size()), static_cast<int>(workspaces_.size()), [&](int item, int thread) {
    if (!wanted(item)) return;
    const std::size_t first = static_cast<std::size_t>(item) * batch;
    std::vector<const Example*> chosen;
    for (std::size_t i = first; i < std::min(first + batch, examples.size()); ++i) chosen.push_back(&examples[i]);
    sums[static_cast<std::size_t>(item)] = evaluate(chosen, workspaces_[static_cast<std::size_t>(thread)], false);
  });
  return sums;
}

/// The sum of losses. With `with_gradient` adds to the workspace's gradient.
double Trainer::evaluate(const std::vector<const Example*>& examples, Workspace& with, bool with_gradient) const {
  const Batch<float> batch = make_batch<float>(examples);
  if (settings_.loss == LossKind::in_the_loop && has_all_couplings(net_.settings())) {
    net_.coupled().predict(net_.parameters(), batch.systems, with.tape.coupled);
    const double left =
        with.corrections(batch.systems, with.tape.coupled.factors, with_gradient ? &with.d_factors : nullptr);
    if (with_gradient)
      net_.coupled().learn(net_.parameters(), batch.systems, with.tape.coupled, with.d_factors, with.gradient);
    return left;
  }
  const bool moves = net_.settings().moves;
  net_.forward(batch.topology, batch.nodes, batch.edges, with.tape, with.y, moves ? &with.y_nodes : nullptr,
               &batch.systems);
  double loss = 0;
  if (settings_.loss == LossKind::mse) {
    if (is_guess(net_.settings()))
      loss = mse_loss<float>(with.y, batch.edge_target, edge_entries_, with_gradient ? &with.dy : nullptr);
    if (moves)
      loss += mse_loss<float>(with.y_nodes, batch.node_target, node_entries_, with_gradient ? &with.dy_nodes : nullptr);
  } else {
    if (moves && with_gradient) with.dy_nodes.setZero(6, batch.nodes.cols());
    with.d = batch.unit.cwiseProduct(with.y);
    loss = with.energy(batch.systems, with.d, with_gradient ? &with.dy : nullptr);
    if (with_gradient) with.dy.array() *= batch.unit.array();
  }
  if (with_gradient)
    net_.backward(batch.topology, batch.nodes, batch.edges, with.tape, with.dy, moves ? &with.dy_nodes : nullptr,
                  with.gradient, &batch.systems);
  return loss;
}

Trainer::State Trainer::state() const { return {step_, adam_.mean(), adam_.square()}; }

void Trainer::restore(const State& state) {
  step_ = state.step;
  adam_.restore(state.step, state.mean, state.square);
}

}  // namespace rodsweep
