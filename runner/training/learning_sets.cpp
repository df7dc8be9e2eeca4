#include "runner/training/learning_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "network/training/example_builder.hpp"
#include "network/training/threads.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/text/checksum.hpp"

namespace rodsweep {
namespace {

DatasetReader opened(const std::filesystem::path& path, const TrainingJob& training, const Job& job,
                     std::optional<MPI_Comm> ranks) {
  by_rank_0(ranks, [&] {
    std::error_code error;
    if (std::filesystem::exists(path, error)) return;
    throw job_error(job.path, "data",
                    "{} was not found: make the data set first, with `rodsweep run` and a job of kind \"dataset\"",
                    path.native());
  });
  DatasetReader set(path, ranks);
  if (set.size() <= training.validation_simulations) {
    throw job_error(job.path, "validation_simulations",
                    "{} is not allowed: {} holds {} simulations, and some must remain for training",
                    training.validation_simulations, path.native(), set.size());
  }
  if (training.training_simulations > set.size() - training.validation_simulations) {
    throw job_error(job.path, "training_simulations",
                    "{} is not allowed: {} holds {} simulations, and {} are for validation",
                    training.training_simulations, path.native(), set.size(), training.validation_simulations);
  }
  if (!is_guess(training.network)) {
    for (const Task& task : set.plan().tasks())
      if (set.plan().spec(task.index).time.integrator != Integrator::euler)
        throw job_error(job.path, "network.encoding",
                        "\"state\" is not allowed with {}, whose steps are \"bdf2\": it takes steps of Euler; must be "
                        "used with data of time.integrator \"euler\"",
                        path.native());
  }
  return set;
}

}  // namespace

LearningSets::LearningSets(const TrainingJob& training, const Job& job, std::optional<MPI_Comm> ranks) {
  for (const std::filesystem::path& path : training.data) sets_.push_back(opened(path, training, job, ranks));
  Checksum sum;
  for (const DatasetReader& set : sets_) {
    sum.add(set.hash().data(), set.hash().size());
    if (!set.note().empty()) note_ += (note_.empty() ? "" : "; ") + set.note();
    const std::int64_t left = set.size() - training.validation_simulations;
    const std::int64_t used = training.training_simulations > 0 ? training.training_simulations : left;
    for (std::int64_t i = 0; i < used; ++i) training_.push_back({&set, i});
  }
  hash_ = sets_.size() == 1 ? sets_.front().hash() : fmt::format("{:016x}", sum.value());
  for (std::int64_t i = training.validation_simulations; i > 0; --i)
    for (const DatasetReader& set : sets_) validation_.push_back({&set, set.size() - i});
}

std::string scene_of(const LearningSets::Simulation& simulation) {
  const TaskSpec spec = simulation.set->plan().spec(simulation.set->task(simulation.number).index);
  return std::visit([](const auto& scene) { return std::string(std::decay_t<decltype(scene)>::name); }, spec.scene);
}

std::int64_t systems_of(const LearningSets::Simulation& simulation) {
  return simulation.set->task(simulation.number).rows[Rows::system].count;
}

std::string paths_of(const std::vector<std::filesystem::path>& sets) {
  std::string text;
  for (const std::filesystem::path& path : sets) text += (text.empty() ? "" : ", ") + path.native();
  return text;
}

/// The examples of these simulations, in order; not normalised. Processes a few simulations at a time.
static std::vector<Example> examples_of(const TrainingJob& training,
                                        const std::vector<LearningSets::Simulation>& simulations, int threads,
                                        const Copies& copies = {}) {
  std::vector<Example> out;
  for (std::size_t begin = 0; begin < simulations.size(); begin += static_cast<std::size_t>(threads)) {
    std::vector<StoredSimulation> read_now;  // by one thread: HDF5 is not thread-safe
    for (std::size_t i = begin; i < std::min(begin + static_cast<std::size_t>(threads), simulations.size()); ++i)
      read_now.push_back(read(simulations[i]));
    std::vector<std::vector<Example>> examples(read_now.size());
    in_parallel(static_cast<int>(read_now.size()), threads, [&](int i, int) {
      add_examples(training.network, read_now[static_cast<std::size_t>(i)], examples[static_cast<std::size_t>(i)],
                   {copies.count, copies.noise, split_mix(copies.seed + begin + static_cast<std::size_t>(i))},
                   training.first_iterations_only);
    });
    for (std::vector<Example>& of : examples) std::move(of.begin(), of.end(), std::back_inserter(out));
  }
  return out;
}

TrainingData training_data(const TrainingJob& training, const LearningSets& sets, int threads) {
  TrainingData data;
  data.hash = sets.hash();
  data.note = sets.note();
  data.validation_simulations = static_cast<std::int64_t>(sets.validation().size());
  data.training_simulations = static_cast<std::int64_t>(sets.training().size());
  for (const LearningSets::Simulation& simulation : sets.validation())
    data.validation_scenes.push_back(scene_of(simulation));
  data.training = examples_of(training, sets.training(), threads, training.copies());
  data.validation = examples_of(training, sets.validation(), threads);
  if (data.training.size() < static_cast<std::size_t>(training.training.batch) || data.validation.empty()) {
    throw FileError("{} gives {} examples for training and {} for validation: too few for batches of {}",
                    paths_of(training.data), data.training.size(), data.validation.size(), training.training.batch);
  }
  data.scales = feature_scales(training.network, data.training);
  normalise(training.network, data.scales, data.training);
  normalise(training.network, data.scales, data.validation);
  return data;
}

std::vector<StoredSimulation> ratio_simulations(const TrainingJob& training, const LearningSets& sets, int part,
                                                int parts) {
  const auto all = static_cast<std::int64_t>(sets.validation().size());
  std::vector<StoredSimulation> out;
  for (std::int64_t i = 0; i < std::min(training.ratio_simulations, all); ++i) {
    StoredSimulation simulation = read(sets.validation()[static_cast<std::size_t>(i)]);
    if (i % parts == part) out.push_back(std::move(simulation));
  }
  return out;
}

}  // namespace rodsweep
