// A training run: reads the data set, trains the network, and saves the model and checkpoints to a file. An interrupted
// training resumes from that file. There is no master: all ranks train; rank 0 also reads the data sets and writes the
// file.
#include "runner/command/run_command.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "network/training/threads.hpp"
#include "runner/command/training_summary.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/file_error.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/job/job.hpp"
#include "runner/specs/training_job.hpp"
#include "runner/terminal/progress.hpp"
#include "runner/training/training.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

constexpr double most_of_time_for_saving = 0.02, longest_unsaved_s = 30;

ExitCode exit_code_of(Ending ending) {
  switch (ending) {
    case Ending::none: return ExitCode::stopped;
    case Ending::diverged: return ExitCode::diverged;
    default: return ExitCode::ok;
  }
}

void check_same_job(const Job& job, const std::string& earlier_text, const fs::path& path) {
  Job now = job, earlier = parse_job(earlier_text, path);
  for (Job* each : {&now, &earlier}) each->values.erase("data");  // compared by its hash
  const auto found = first_difference(now, earlier);
  if (!found) return;
  const char* reason = found->key == "training.epochs"
                           ? " (the learning rate falls over all epochs, so another number begins anew)"
                           : "";
  throw FileError("{} cannot be continued with {}: {} was {} and is {}{}; name another file with -o FILE",
                  path.native(), job.path.native(), found->key, found->before, found->now, reason);
}

/// The training to resume; none if the file does not exist. Throws FileError if the file exists without --resume, or if
/// it belongs to another job.
std::optional<StoredModel> earlier_training(const RunOptions& options, const Job& job, const fs::path& path) {
  if (!options.resume) refuse_existing(path, resume_advice);
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return std::nullopt;
  StoredModel earlier = read_training(path);
  check_same_job(job, earlier.card.job_text, path);
  if (earlier.card.ending == Ending::none && !earlier.checkpoint)
    throw FileError("{} holds an unfinished training without a checkpoint", path.native());
  return earlier;
}

/// A running training, on this rank.
class TrainingRun {
 public:
  TrainingRun(const RunOptions& options, const Job& job, const fs::path& path, const MpiSession& mpi, Console& console)
      : options_(options),
        job_(job),
        path_(path),
        training_job_(training_job(job.values, job.path)),
        mpi_(mpi),
        console_(console),
        where_(placement(mpi.world(), RankRoles::all_work)),
        threads_(std::min({where_.threads, available_threads(), shards_of_a_rank()})) {}

  void prepare(const std::optional<StoredModel>& earlier);
  ExitCode run(const StopSignal& signal);

 private:
  void advise();
  int shards_of_a_rank() const { return (training_job_.training.shards + mpi_.size() - 1) / mpi_.size(); }
  void show_progress();
  void report(const StopSignal& signal);
  void save();
  bool save_is_due() const;
  bool writes() const { return mpi_.rank() == 0; }

  const RunOptions& options_;
  const Job& job_;
  const fs::path& path_;
  const TrainingJob training_job_;
  const MpiSession& mpi_;
  Console& console_;
  const Placement where_;
  const int threads_;  ///< of this rank
  TrainingData data_;
  std::optional<Training> training_;
  std::optional<ModelFile> file_;
  std::optional<ProgressLine> progress_;
  std::vector<RunRow> runs_;
  Stopwatch since_begin_, since_save_;  ///< since the first step; since the last save
  double save_s_ = 0;                   ///< duration of the last save
  std::int64_t first_step_ = 0;
};

/// Collective: reads the data, and creates the file or resumes from it.
void TrainingRun::prepare(const std::optional<StoredModel>& earlier) {
  console_.note(fmt::format("reading {}", paths_of(training_job_.data)));
  std::vector<StoredSimulation> simulations;
  collectively(mpi_.world(), [&] {
    const LearningSets sets(training_job_, job_, mpi_.world());
    if (earlier && earlier->card.data_hash != sets.hash())
      throw FileError("{} cannot be continued: {} is not the data set of its earlier runs", path_.native(),
                      paths_of(training_job_.data));
    data_ = training_data(training_job_, sets, threads_);
    simulations = ratio_simulations(training_job_, sets, mpi_.rank(), mpi_.size());
  });
  collectively(mpi_.world(),
               [&] { training_.emplace(job_, training_job_, data_, std::move(simulations), threads_, mpi_.world()); });
  if (earlier) {
    runs_ = earlier->card.runs;
    training_->restore(earlier->card, *earlier->model, *earlier->checkpoint);
  }
  first_step_ = training_->trainer().step();

  runs_.push_back({provenance_of(options_, mpi_, where_), "", -1});
  collectively(mpi_.world(), [&] {
    if (!writes()) return;
    file_.emplace(path_, earlier.has_value());
    save();
  });
  advise();
}

void TrainingRun::advise() {
  if (!data_.note.empty()) console_.warn(data_.note);
  const int shards = training_job_.training.shards;
  if (where_.oversubscribed) {
    console_.warn(fmt::format("{} ranks share {} cores and wait for each other: use at most one rank per core",
                              mpi_.size(), where_.cores));
  } else if (mpi_.size() > shards) {
    console_.note(fmt::format("a step has {} shards (training.shards): {} of {} ranks are idle", shards,
                              mpi_.size() - shards, mpi_.size()));
  } else if (const int working = mpi_.size() * threads_; working < std::min(where_.cores, shards)) {
    console_.note(
        fmt::format("{} of {} cores are used: check OMP_NUM_THREADS and mpirun --bind-to", working, where_.cores));
  }
  const Trainer& trainer = training_->trainer();
  const ModelCard& card = training_->card();
  console_.note(fmt::format("{}: {} parameters, {} examples from {} simulations, {} steps in each of {} epochs{}",
                            card.name, trainer.shard_size() - 1, card.training_examples, card.training_simulations,
                            trainer.steps_per_epoch(), card.planned_epochs,
                            first_step_ > 0 ? fmt::format("; continued after step {}", first_step_) : ""));
}

ExitCode TrainingRun::run(const StopSignal& signal) {
  progress_.emplace(console_, ProgressLine::Clock::now());
  since_begin_ = Stopwatch();
  bool stops = false;
  while (!stops && !training_->ended()) {
    stops = training_->step(signal.received() != 0);
    show_progress();
    if (writes() && save_is_due()) save();
  }
  progress_->clear();
  if (training_->ended() && training_->card().best_epoch > 0) training_->end();
  const ExitCode code = exit_code_of(training_->card().ending);
  if (!writes()) return code;
  runs_.back().end_utc = utc_now();
  runs_.back().exit_code = static_cast<int>(code);
  save();
  report(signal);
  return code;
}

void TrainingRun::report(const StopSignal& signal) {
  const std::string summary = training_summary(training_->card(), path_);
  if (training_->ended()) {
    console_.result(summary + "\nnext: " + script_line("loss.py", path_));
    return;
  }
  console_.result(summary);
  console_.note(stopped_text(signal.received(), options_, mpi_.size()));
}

void TrainingRun::show_progress() {
  const auto now = ProgressLine::Clock::now();
  if (!progress_->due(now)) return;
  const Trainer& trainer = training_->trainer();
  const auto done = static_cast<double>(trainer.step() - first_step_);
  const auto left = static_cast<double>(trainer.steps() - trainer.step());
  progress_->show(now, static_cast<double>(trainer.step()) / static_cast<double>(trainer.steps()),
                  progress_text(training_->card(), since_begin_.seconds() / done * left));
}

/// True after an epoch, unless saving takes too much of the time (a slow disk), and every longest_unsaved_s.
bool TrainingRun::save_is_due() const {
  const double unsaved_s = since_save_.seconds();
  if (training_->ended()) return false;  // run() saves it after the final measurements
  return unsaved_s > longest_unsaved_s ||
         (training_->at_epoch_begin() && save_s_ < most_of_time_for_saving * unsaved_s);
}

/// Saves the current state, with a checkpoint unless the training has ended.
void TrainingRun::save() {
  const Stopwatch watch;
  ModelCard card = training_->card();
  card.runs = runs_;
  std::optional<Checkpoint> checkpoint;
  if (!training_->ended()) checkpoint = training_->checkpoint();
  file_->save(card, training_->kept(), checkpoint);
  save_s_ = watch.seconds();
  since_save_ = Stopwatch();
}

}  // namespace

ExitCode run_training(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console) {
  const StopSignal signal;  // from here until the file is closed, a signal only requests a stop
  const fs::path path = collectively(mpi.world(), [&] { return output_of(options, job.name); });
  if (const std::string left = unfinished_text(path); !left.empty()) console.warn(left);
  const auto earlier = collectively(mpi.world(), [&] {
    if (options.extend) throw job_error(job.path, "kind", "a training cannot extend results: remove --extend");
    if (options.task_time_limit_s || options.time_limit_s || options.memory_limit_gb || options.shard)
      throw job_error(job.path, "kind",
                      "a training has no tasks: remove --shard, --time-limit, --task-time-limit and --memory-limit-gb");
    return earlier_training(options, job, path);
  });
  if (earlier && earlier->card.ending != Ending::none) {
    console.note("the training has already ended");
    console.result(training_summary(earlier->card, path));
    return exit_code_of(earlier->card.ending);
  }
  TrainingRun run(options, job, path, mpi, console);
  run.prepare(earlier);
  return run.run(signal);
}

}  // namespace rodsweep
