#include "runner/training/training.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "network/guess/base_guess.hpp"
#include "network/guess/coping_net_guess.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

namespace {

ModelCard new_card(const Job& job, const TrainingJob& settings, const TrainingData& data) {
  ModelCard card;
  card.name = job.name;
  card.job_text = job.text;
  std::vector<std::filesystem::path> paths;
  for (const std::filesystem::path& path : settings.data)
    paths.push_back(std::filesystem::absolute(path).lexically_normal());
  card.data_path = paths_of(paths);
  card.data_hash = data.hash;
  card.training_simulations = data.training_simulations;
  card.validation_simulations = data.validation_simulations;
  card.training_examples = static_cast<std::int64_t>(data.training.size());
  card.validation_examples = static_cast<std::int64_t>(data.validation.size());
  card.planned_epochs = settings.training.epochs;
  card.ratio_simulations = std::min(settings.ratio_simulations, data.validation_simulations);
  return card;
}

}  // namespace

Training::Training(const Job& job, const TrainingJob& settings, const TrainingData& data,
                   std::vector<StoredSimulation> simulations, int threads, MPI_Comm comm)
    : settings_(settings),
      data_(data),
      model_(std::make_shared<Model>(Model{CopingNet<float>(settings.network, settings.training.seed), data.scales})),
      kept_(std::make_shared<Model>(*model_)),
      trainer_(model_->net, data.training, settings.training, threads),
      exchange_(comm, settings.training.shards, trainer_.shard_size()),
      ratio_(std::move(simulations)),
      card_(new_card(job, settings, data)) {}

void Training::restore(const ModelCard& card, const Model& kept, const Checkpoint& checkpoint) {
  *kept_ = kept;
  model_->net.parameters().values() = checkpoint.weights;
  trainer_.restore(checkpoint.optimiser);
  card_.epochs = card.epochs;
  card_.best_epoch = card.best_epoch;
  epoch_loss_ = checkpoint.epoch_loss;
  epoch_seconds_ = checkpoint.epoch_seconds;
  epoch_processor_seconds_ = checkpoint.epoch_processor_seconds;
}

Checkpoint Training::checkpoint() const {
  return {model_->net.parameters().values(), trainer_.state(), epoch_loss_, epoch_seconds_, epoch_processor_seconds_};
}

bool Training::step(bool stop) {
  const Stopwatch watch;
  const ProcessorStopwatch processor_watch;
  const bool stops = exchange_.gather([&](const std::vector<Trainer::Shard>& own) { trainer_.compute(own); }, stop);
  const double loss = trainer_.update(exchange_.shards());
  epoch_loss_ += loss;
  if (!std::isfinite(loss)) {
    diverge("training");
  } else if (at_epoch_begin()) {
    end_epoch();
  }
  epoch_seconds_ += watch.seconds();
  epoch_processor_seconds_ += exchange_.ranks() * processor_watch.seconds();
  if (at_epoch_begin() && card_.ending != Ending::diverged) {
    card_.epochs.back().seconds = std::exchange(epoch_seconds_, 0);
    card_.epochs.back().processor_seconds = std::exchange(epoch_processor_seconds_, 0);
  }
  return stops;
}

void Training::end_epoch() {
  Epoch epoch;
  epoch.training_loss = std::exchange(epoch_loss_, 0) / static_cast<double>(trainer_.steps_per_epoch());
  epoch.validation_loss = validation_loss();
  epoch.rate = trainer_.rate();
  if (!std::isfinite(epoch.validation_loss)) {
    diverge("validation");
    return;
  }
  const auto number = static_cast<std::int64_t>(card_.epochs.size()) + 1;
  if (is_guess(settings_.network) && settings_.ratio_every_epochs > 0 && number % settings_.ratio_every_epochs == 0)
    epoch.cg_ratio = mean(ratios(model_));
  if (card_.best_epoch == 0 || epoch.validation_loss < best_epoch(card_).validation_loss) {
    card_.best_epoch = number;
    kept_->net.parameters().values() = model_->net.parameters().values();
  }
  card_.epochs.push_back(epoch);
  if (number == settings_.training.epochs)
    card_.ending = Ending::complete;
  else if (settings_.patience_epochs > 0 && number - card_.best_epoch >= settings_.patience_epochs)
    card_.ending = Ending::early;
}

void Training::diverge(const char* loss) {
  card_.ending = Ending::diverged;
  card_.message =
      fmt::format("the {} loss is not finite in epoch {}: try a lower training.rate", loss, card_.epochs.size() + 1);
}

/// Batches are distributed over the ranks; their losses are summed in order.
double Training::validation_loss() {
  std::vector<double> sums = trainer_.losses(data_.validation, [&](int batch) { return exchange_.is_mine(batch); });
  exchange_.share(sums);
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum / static_cast<double>(data_.validation.size());
}

Training::SimulationRatios Training::ratios(const ValidationRatio::MakeGuess& make_guess) const {
  constexpr std::size_t columns = ValidationRatio::tolerance_count;
  SimulationRatios out(static_cast<std::size_t>(card_.ratio_simulations));
  std::vector<double> shared(out.size() * columns);
  for (std::size_t own = 0; own < ratio_.simulations(); ++own) {
    const ValidationRatio::Ratios of = ratio_.measure(own, make_guess);
    const std::size_t simulation =
        own * static_cast<std::size_t>(exchange_.ranks()) + static_cast<std::size_t>(exchange_.rank());
    std::copy(of.begin(), of.end(), shared.begin() + static_cast<std::ptrdiff_t>(simulation * columns));
  }
  exchange_.share(shared);
  for (std::size_t i = 0; i < out.size(); ++i)
    std::copy_n(shared.begin() + static_cast<std::ptrdiff_t>(i * columns), columns, out[i].begin());
  return out;
}

Training::SimulationRatios Training::ratios(const std::shared_ptr<const Model>& model) const {
  return ratios([&](const Scene& scene, const StoredSimulation& simulation) {
    return std::make_unique<CopingNetGuess>(model, scene, simulation.newton_iterations);
  });
}

ValidationRatio::Ratios Training::mean(const SimulationRatios& ratios, const std::string& scene) const {
  ValidationRatio::Ratios mean{};
  for (std::size_t t = 0; t < mean.size(); ++t) {
    double sum = 0;
    int measured = 0;
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      if (std::isnan(ratios[i][t]) || !(scene.empty() || data_.validation_scenes[i] == scene)) continue;
      sum += ratios[i][t];
      ++measured;
    }
    mean[t] = sum / measured;
  }
  return mean;
}

void Training::end() {
  if (!is_guess(settings_.network)) return;
  const SimulationRatios of_model = ratios(kept_);
  const SimulationRatios of_base = ratios([&](const Scene& scene, const StoredSimulation& simulation) {
    return base_guess(settings_.network, scene, simulation.newton_iterations);
  });
  card_.cg_ratio = mean(of_model);
  card_.base_cg_ratio = mean(of_base);
  const auto first = data_.validation_scenes.begin();
  const std::set<std::string> scenes(first, first + static_cast<std::ptrdiff_t>(of_model.size()));
  card_.scenes.clear();
  if (scenes.size() < 2) return;
  for (const std::string& scene : scenes) card_.scenes.push_back({scene, mean(of_model, scene), mean(of_base, scene)});
}

}  // namespace rodsweep
