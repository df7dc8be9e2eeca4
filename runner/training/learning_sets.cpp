#include "runner/training/learning_sets.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "runner/mpi/mpi_session.hpp"
#include "runner/text/checksum.hpp"

namespace rodsweep {
namespace {

DatasetReader opened(const std::filesystem::path& path, const TrainingJob& training, const Job& job,
                     std::optional<MPI_Comm> ranks) {
  by_rank_0(ranks, [&] {
    std::error_code error;
    if (std::filesystem::exists(path, error)) return;
    throw job_error(
        job.path, "data",
        fmt::format("{} was not found: make the data set first, with `rodsweep run` and a job of kind \"dataset\"",
                    path.native()));
  });
  DatasetReader set(path, ranks);
  if (set.size() <= training.validation_simulations) {
    throw job_error(job.path, "validation_simulations",
                    fmt::format("{} is not allowed: {} holds {} simulations, and some must remain for training",
                                training.validation_simulations, path.native(), set.size()));
  }
  if (training.training_simulations > set.size() - training.validation_simulations) {
    throw job_error(
        job.path, "training_simulations",
        fmt::format("{} is not allowed: {} holds {} simulations, and {} are for validation",
                    training.training_simulations, path.native(), set.size(), training.validation_simulations));
  }
  if (!is_guess(training.network)) {
    for (const Task& task : set.plan().tasks())
      if (set.plan().spec(task.index).time.integrator != Integrator::euler)
        throw job_error(job.path, "network.encoding",
                        fmt::format("\"state\" is not allowed with {}, whose steps are \"bdf2\": it takes steps of "
                                    "Euler; must be used with data of time.integrator \"euler\"",
                                    path.native()));
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

}  // namespace rodsweep
