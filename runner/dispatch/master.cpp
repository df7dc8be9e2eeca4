#include "runner/dispatch/master.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rodsweep {

namespace {

constexpr std::size_t failures_kept = 5;

auto order(const PendingTask& task) { return std::tuple(task.crashes, -task.cost, task.index); }
bool comes_first(const PendingTask& a, const PendingTask& b) { return order(a) < order(b); }

}  // namespace

Master::Master(Channel& channel, std::vector<PendingTask> tasks, Progress& progress, std::function<int()> signal,
               const Timeouts& timeouts, Callbacks callbacks, TimeSource now)
    : channel_(&channel),
      progress_(&progress),
      signal_(std::move(signal)),
      timeouts_(timeouts),
      callbacks_(std::move(callbacks)),
      now_(now),
      pool_(std::move(tasks)),
      workers_(static_cast<std::size_t>(channel.size())),
      runs_only_one_(timeouts.time_left.count() <= 0),
      begin_(now()),
      stepped_(begin_) {
  for (Worker& worker : workers_) worker.heard = begin_;
  std::sort(pool_.begin(), pool_.end(), comes_first);
  if (runs_only_one_ && !pool_.empty()) {
    const auto cheapest = std::min_element(pool_.begin(), pool_.end(), [](const PendingTask& a, const PendingTask& b) {
      return std::tuple(a.crashes, a.cost) < std::tuple(b.crashes, b.cost);
    });
    std::rotate(pool_.begin(), cheapest, cheapest + 1);
  }
  for (const PendingTask& task : pool_) pool_cost_ += task.cost;
  dispatch_.left = static_cast<std::int64_t>(pool_.size());
}

void Master::run(const std::function<void()>& now_and_then) {
  Backoff backoff;
  for (;;) {
    if (now_and_then) now_and_then();
    switch (step()) {
      case Step::worked: backoff.reset(); break;
      case Step::waited: backoff.wait(); break;
      case Step::finished: return;
    }
  }
}

Master::Step Master::step() {
  const bool traffic = receive();
  if (const int signal = signal_(); signal != 0) stop(signal);
  find_lost();
  if (is_late()) stop(0);
  if (!stopping_) assign_tasks();

  const TimePoint now = now_();
  progress_->show(now);
  const bool waits = next_ < pool_.size() && !stopping_ && any_worker_left();
  if (in_flight_ > 0 || waits) return traffic ? Step::worked : Step::waited;

  progress_->clear();
  dispatch_.late = dispatch_.left > 0 && stopping_ && dispatch_.signal == 0;
  dispatch_.wall_s = std::chrono::duration<double>(now - begin_).count();
  dispatch_.ranks_lost =
      std::any_of(workers_.begin() + 1, workers_.end(), [](const Worker& worker) { return worker.lost; });
  for (int rank = 1; rank < channel_->size(); ++rank)
    if (worker(rank).reachable()) channel_->send(rank, Finish{dispatch_.ranks_lost});
  return Step::finished;
}

void Master::wait_until_gone() {
  const TimePoint begin = now_();
  const auto here = [](const Worker& worker) { return !worker.lost && !worker.gone; };
  Backoff backoff;
  while (std::any_of(workers_.begin() + 1, workers_.end(), here) && now_() - begin < timeouts_.drain) {
    if (receive()) backoff.reset();
    backoff.wait();
  }
  for (int rank = 1; rank < channel_->size(); ++rank)
    if (here(worker(rank))) lose(rank);
}

bool Master::receive() {
  bool any = false;
  while (const auto envelope = channel_->probe()) {
    any = true;
    Worker& sender = worker(envelope->source);
    sender.heard = now_();
    if (sender.lost && !std::exchange(sender.heard_again, true) && stopping_) channel_->send(envelope->source, Stop{});
    switch (envelope->tag) {
      case Tag::report:
        if (const auto said = channel_->receive<Report>(*envelope); !sender.lost) report(envelope->source, said);
        break;
      case Tag::alive:
        sender.saved = channel_->receive<Alive>(*envelope).saved;
        remove_saved(sender);
        break;
      case Tag::gone: channel_->receive<Gone>(*envelope), sender.gone = true; break;
      case Tag::interrupted: stop(channel_->receive<Interrupted>(*envelope).signal); break;
      default: channel_->unexpected(*envelope);
    }
  }
  return any;
}

void Master::report(int rank, const Report& report) {
  Worker& sender = worker(rank);
  const auto had = std::find_if(sender.tasks.begin(), sender.tasks.end(),
                                [&](const PendingTask& task) { return task.index == report.task; });
  if (had == sender.tasks.end())
    throw ProtocolError("rank {} reports task {}, which is not assigned to it", rank, report.task);
  const PendingTask task = *had;
  sender.tasks.erase(had);
  --in_flight_;
  if (report.outcome == TaskOutcome::pending) {
    dispatch_.busy_s += report.busy_s;
    return;
  }
  count(task, report);
  sender.unsaved.push_back({task, report});
  remove_saved(sender);
}

void Master::remove_saved(Worker& worker) {
  for (; worker.removed < worker.saved && !worker.unsaved.empty(); ++worker.removed) worker.unsaved.pop_front();
}

void Master::count(const PendingTask& task, const Report& report) {
  dispatch_.busy_s += report.busy_s;
  --dispatch_.left;
  ++dispatch_.finished.at(static_cast<std::size_t>(report.outcome));
  if (report.outcome != TaskOutcome::ok && dispatch_.failures.size() < failures_kept)
    dispatch_.failures.push_back({task.index, report.outcome, std::string(report.message())});
  if (report.outcome == TaskOutcome::ok && !report.message().empty()) warn(task.index, report.message());
  progress_->finished(report.outcome, task.cost, report.busy_s);
}

/// Keeps a warning unless an earlier task had the same.
void Master::warn(std::int64_t task, std::string_view text) {
  auto& warnings = dispatch_.warnings;
  const bool known = std::any_of(warnings.begin(), warnings.end(), [&](const auto& w) { return w.message == text; });
  if (!known && warnings.size() < failures_kept) warnings.push_back({task, TaskOutcome::ok, std::string(text)});
}

void Master::uncount(const PendingTask& task, const Report& report) {
  ++dispatch_.left;
  --dispatch_.finished.at(static_cast<std::size_t>(report.outcome));
  for (auto* kept : {&dispatch_.failures, &dispatch_.warnings})
    kept->erase(std::remove_if(kept->begin(), kept->end(),
                               [&](const Dispatch::Failure& one) { return one.task == task.index; }),
                kept->end());
  progress_->uncount(report.outcome, task.cost, report.busy_s);
}

void Master::find_lost() {
  const TimePoint now = now_();
  if (now - std::exchange(stepped_, now) > timeouts_.silence / 2)  // the master was suspended
    for (Worker& worker : workers_) worker.heard = now;
  const bool drained = stopping_ && now - stopped_ > timeouts_.drain;
  for (int rank = 1; rank < channel_->size(); ++rank) {
    const Worker& one = worker(rank);
    if (!one.lost && (now - one.heard > timeouts_.silence || (drained && !one.tasks.empty()))) lose(rank);
  }
}

void Master::lose(int rank) {
  Worker& lost = worker(rank);
  lost.lost = true;
  if (callbacks_.lost) callbacks_.lost(rank);
  const std::vector<PendingTask> tasks = std::exchange(lost.tasks, {});
  in_flight_ -= static_cast<std::int64_t>(tasks.size());
  for (const PendingTask& task : tasks) put_back(task, &task == &tasks.front());
  for (const Finished& one : std::exchange(lost.unsaved, {})) {
    uncount(one.task, one.report);
    put_back(one.task, false);
  }
}

void Master::put_back(PendingTask task, bool crashed) {
  if (crashed) ++task.crashes;
  if (task.crashes >= timeouts_.max_crashes && !stopping_ && callbacks_.crashed) {
    count(task, Report(task.index, TaskOutcome::crashed, 0, callbacks_.crashed(task.index, task.crashes)));
    return;
  }
  const auto begin = pool_.begin() + static_cast<std::ptrdiff_t>(next_);
  pool_.insert(std::upper_bound(begin, pool_.end(), task, comes_first), task);
  pool_cost_ += task.cost;
}

void Master::stop(int signal) {
  if (std::exchange(stopping_, true)) return;
  dispatch_.signal = signal;
  stopped_ = now_();
  if (signal != 0 && callbacks_.stopping) callbacks_.stopping(signal);
  for (int rank = 1; rank < channel_->size(); ++rank)
    if (worker(rank).reachable()) channel_->send(rank, Stop{});
}

void Master::assign_tasks() {
  for (int rank = 1; rank < channel_->size() && has_next(); ++rank)
    if (is_idle(rank) && !next_runs_alone()) assign(rank);
  for (int rank = 1; rank < channel_->size() && has_next(); ++rank)
    if (may_hold_another(worker(rank))) assign(rank);
  for (int rank = 1; rank < channel_->size() && in_flight_ == 0 && has_next() && next_runs_alone(); ++rank)
    if (is_idle(rank)) assign(rank);
}

bool Master::has_next() const { return next_ < pool_.size() && !(runs_only_one_ && next_ > 0); }

bool Master::is_late() const {
  if (next_ == 0) return false;  // nothing was tried
  const Timeouts::Seconds ran = now_() - begin_;
  return runs_only_one_ ? in_flight_ == 0 || ran > timeouts_.time_limit : ran > timeouts_.time_left;
}

bool Master::is_idle(int rank) const {
  const Worker& worker = workers_[static_cast<std::size_t>(rank)];
  return !worker.lost && worker.tasks.empty();
}

bool Master::any_worker_left() const {
  return std::any_of(workers_.begin() + 1, workers_.end(), [](const Worker& worker) { return !worker.lost; });
}

bool Master::next_runs_alone() const {
  return next_ < pool_.size() && pool_[next_].crashes >= std::max(timeouts_.max_crashes - 1, 1);
}

bool Master::may_hold_another(const Worker& worker) const {
  constexpr double margin = 2;  // costs are estimates
  if (worker.tasks.size() != 1 || pool_[next_].crashes > 0) return false;
  const double second = pool_[next_].cost;
  const auto workers = static_cast<double>(channel_->size() - 1);
  return margin * workers * (worker.tasks.front().cost + second) <= pool_cost_ - second;
}

void Master::assign(int rank) {
  const PendingTask& task = pool_[next_++];
  pool_cost_ -= task.cost;
  worker(rank).tasks.push_back(task);
  ++in_flight_;
  channel_->send(rank, Assign{task.index});
}

}  // namespace rodsweep
