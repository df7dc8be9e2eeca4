#include "runner/command/keep_command.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <functional>
#include <thread>
#include <utility>

#include "runner/command/kept_hosts.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/file_lock.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/runs.hpp"
#include "runner/job/job.hpp"
#include "runner/terminal/child_process.hpp"
#include "runner/terminal/text.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Seconds look_pause{0.1}, longest_pause{300}, time_to_end{15}, time_to_leave{5};
constexpr Seconds longest_lock{300};
constexpr int no_start = 1 << 8;   // as wait() gives the exit code 1
constexpr double slow_begin = 10;  // a start may wait for hosts or read data before it shows any sign, and a training
                                   // shows none while it measures CG ratios
constexpr Seconds time_to_stop{100};  // a sweep gives its workers a minute, batch systems often two

/// What the results say of the starts so far.
struct Story {
  std::size_t starts = 0;
  std::string begun;              ///< when the last of them began
  std::optional<ExitCode> ended;  ///< how the last one ended, if by itself
  std::int64_t done = 0;          ///< tasks, or steps of a training

  bool goes_on_from(const Story& before) const { return starts > before.starts || begun != before.begun; }
};

template <class Starts>
Story story_of(const Starts& starts, std::int64_t done) {
  if (starts.empty()) return {0, "", std::nullopt, done};
  const auto& last = starts.back();
  Story story{starts.size(), last.provenance.begin_utc, std::nullopt, done};
  if (!last.end_utc.empty()) story.ended = static_cast<ExitCode>(last.exit_code);
  return story;
}

Story read_story(const fs::path& file, bool training) {
  if (!fs::exists(file)) return {};
  if (!training) {
    const FileSummary sweep = inspect(file);
    return story_of(sweep.runs, sweep.done);
  }
  const StoredModel stored = read_training(file);
  return story_of(stored.card.starts, stored.checkpoint ? stored.checkpoint->optimiser.step : 0);
}

/// Since when a file shows no sign of life, judged by this host's clock alone: when its time was last seen to change.
class SignsOfLife {
 public:
  explicit SignsOfLife(fs::path file) : file_(std::move(file)) {}

  Seconds silence() {
    struct stat now {};
    const bool there = ::stat(file_.c_str(), &now) == 0;
    const auto time = std::pair(now.st_mtim.tv_sec, now.st_mtim.tv_nsec);
    if (there && time != time_) time_ = time, seen_ = Clock::now();
    return Clock::now() - seen_;
  }

 private:
  fs::path file_;
  std::pair<time_t, long> time_{};
  Clock::time_point seen_ = Clock::now();
};

void end(ChildProcess& start) {
  start.signal(SIGTERM);  // mpirun ends all its ranks, also those that are stopped or on other hosts
  start.signal(SIGCONT);  // and a training may be stopped itself
  const auto begin = Clock::now();
  while (start.runs() && Clock::now() - begin < time_to_end) std::this_thread::sleep_for(look_pause);
  if (start.runs()) start.kill_group();
}

/// Sees one start to its end.
class Keeper {
 public:
  Keeper(const KeepOptions& options, fs::path file, bool training, Console& console)
      : options_(&options), file_(std::move(file)), training_(training), console_(&console) {}

  ExitCode run() {
    Seconds pause{options_->pause_s};
    int vain = 0;
    bool any_begun = false;
    for (Story before = read_story(file_, training_);;) {
      if (!wait_for_lock()) return ExitCode::stopped;
      const int status = start(before, any_begun);
      const Story after = story_after(before);
      const bool begun = after.goes_on_from(before);
      any_begun = any_begun || begun;
      if (begun && after.ended && !is_lost(*after.ended)) return *after.ended;
      // A start that never began may be refused for good, or find the one before still dying.
      if (!any_begun && exit_code_of(status) == static_cast<int>(ExitCode::user_error)) return ExitCode::user_error;
      if (stop_.received() != 0) return ExitCode::stopped;
      if (options_->run.time_limit_s && passed().count() >= *options_->run.time_limit_s) {
        console_->warn("the time limit is over, and so is this: the same again goes on");
        return ExitCode::stopped;
      }

      if (after.done > before.done) vain = 0, pause = Seconds(options_->pause_s);
      if (++vain >= options_->vain_starts) {
        console_->error(
            fmt::format("{} starts in a row got nothing done, the last one ended with {}; see what they said, "
                        "and type the same again to go on",
                        vain, status_text(status)));
        return ExitCode::user_error;
      }
      console_->warn(fmt::format("the start ended with {}, {} done; the next one comes in {}", status_text(status),
                                 counted(after.done, training_ ? "step" : "task"), duration_text(pause.count())));
      if (!wait(pause)) return ExitCode::stopped;
      before = after;
      pause = std::min(2 * pause, longest_pause);
    }
  }

 private:
  /// That before, where nothing more can be read, be it that the disk does not answer.
  Story story_after(const Story& before) const {
    try {
      return read_story(file_, training_);
    } catch (const std::exception& failure) {
      console_->warn(failure.what());
      return before;
    }
  }

  /// Stopped by whom? A signal that this did not send comes from a host that shuts down, or from mpirun, which lost
  /// ranks.
  bool is_lost(ExitCode ended) const {
    const bool told = stop_.received() != 0 || options_->run.time_limit_s;
    return ended == ExitCode::lost || (ended == ExitCode::stopped && (hung_ || !told));
  }

  bool has_begun(const Story& before, Story& now) const {
    if (training_ || !fs::exists(file_)) return false;
    try {
      now = story_of(read_runs(open_results(file_)), 0);
    } catch (const std::exception&) {  // after the start it is read once more
      return false;
    }
    return now.goes_on_from(before);
  }

  /// The exit status of one start, as wait() gives it.
  int start(const Story& before, bool any_begun) {
    const std::vector<std::string> command = words(any_begun);
    if (command.empty()) return no_start;
    ChildProcess child(command);
    SignsOfLife signs(file_);
    std::optional<Clock::time_point> told, ended;
    auto looked = Clock::now();
    bool begun = false;
    hung_ = false;
    while (child.runs()) {
      std::this_thread::sleep_for(look_pause);
      if (stop_.received() != 0 && !told) {
        child.signal(SIGUSR1);
        told = Clock::now();
      }
      if (told && Clock::now() - *told > time_to_stop) end(child);
      if (Clock::now() - looked > time_to_leave / 5) {  // a lost rank may keep mpirun from leaving
        looked = Clock::now();
        Story now;
        begun = has_begun(before, now);
        if (!ended && begun && now.ended) ended = looked;
        if (ended && looked - *ended > time_to_leave) end(child);
      }
      const Seconds patience(begun ? options_->silence_s : slow_begin * options_->silence_s);
      if (patience.count() > 0 && signs.silence() > patience) {
        console_->warn(fmt::format("{} shows no sign of life since {}: this start is ended", file_.native(),
                                   duration_text(patience.count())));
        hung_ = true;
        end(child);
      }
    }
    return child.status();
  }

  /// Of the next start; empty: there can be none now. What fails from the first start on is not tried again in every
  /// one: neither a task that runs out of time nor one that ends its worker would ever be given up.
  std::vector<std::string> words(bool any_begun) const {
    std::vector<std::string> words = options_->command;
    if (any_begun) words.erase(std::remove(words.begin(), words.end(), "--retry-failed"), words.end());
    if (!options_->run.resume) words.emplace_back("--resume");
    if (options_->run.time_limit_s)
      words.insert(words.end(), {"--time-passed", fmt::format("{:.0f}", passed().count())});
    if (options_->hosts) {
      const fs::path answering = answering_hosts(*options_->hosts, file_, *console_);
      if (answering.empty()) return {};
      for (std::string& word : words)
        if (word == "{hosts}") word = answering.native();
    }
    return words;
  }

  Seconds passed() const { return Clock::now() - begin_; }

  /// What is left of a start, on a host that was cut off or under a batch system that gave it up, may write for a
  /// while.
  bool wait_for_lock() const {
    const auto is_free = [&] { return !FileLock::is_held(file_).value_or(false); };
    if (is_free()) return true;
    console_->warn(fmt::format("{} is being written by another run: its end is waited for, up to {}", file_.native(),
                               duration_text(longest_lock.count())));
    return wait(longest_lock, is_free);
  }

  /// False: told to stop.
  bool wait(
      Seconds pause, const std::function<bool()>& is_over = [] { return false; }) const {
    for (const auto begin = Clock::now(); Clock::now() - begin < pause && !is_over();) {
      if (stop_.received() != 0) return false;
      std::this_thread::sleep_for(look_pause);
    }
    return true;
  }

  const KeepOptions* options_;
  fs::path file_;
  bool training_;
  Console* console_;
  Clock::time_point begin_ = Clock::now();
  StopSignal stop_;
  bool hung_ = false;  ///< the last start, which was ended for it
};

}  // namespace

std::vector<std::string> run_words(const std::vector<std::string>& command) {
  for (std::size_t i = 1; i < command.size(); ++i)
    if (command[i] == "run" && fs::path(command[i - 1]).filename() == "rodsweep")
      return {command.begin() + static_cast<std::ptrdiff_t>(i) - 1, command.end()};
  return {};
}

ExitCode execute(const KeepOptions& options, Console& console) {
  const Job job = read_job(options.run.job);
  const bool training = is_training(job);
  if (!training) setenv("OMPI_MCA_orte_enable_recovery", "1", 0);
  for (const auto& [name, value] : {std::pair("time", "20"), {"intvl", "5"}, {"probes", "4"}})
    setenv(fmt::format("OMPI_MCA_oob_tcp_keepalive_{}", name).c_str(), value, 0);
  return Keeper(options, output_of(options.run, job.name), training, console).run();
}

}  // namespace rodsweep
