#include "runner/dispatch/master.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "runner/dispatch/backoff.hpp"

namespace rodsweep {

namespace {

constexpr std::size_t failures_kept = 5;

auto order(const PendingTask& task) { return std::tuple(task.lost, -task.cost, task.batch, task.index); }
bool comes_first(const PendingTask& a, const PendingTask& b) { return order(a) < order(b); }

}  // namespace

Master::Master(Channel& channel, std::vector<PendingTask> tasks, Progress& progress, std::function<int()> signal,
               const Patience& patience, Notices notices)
    : channel_(&channel),
      progress_(&progress),
      signal_(std::move(signal)),
      patience_(patience),
      notices_(std::move(notices)),
      pool_(std::move(tasks)),
      workers_(static_cast<std::size_t>(channel.size())),
      begin_(Clock::now()),
      stepped_(begin_),
      last_heard_(begin_) {
  for (Worker& worker : workers_) worker.heard = begin_;
  std::sort(pool_.begin(), pool_.end(), comes_first);
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
  look_for_lost();
  if (patience_.time.is_over(Clock::now() - begin_)) stop(0);
  if (!stopping_) hand_out();

  const auto now = Clock::now();
  progress_->show(now);
  const bool waits =
      next_ < pool_.size() && !stopping_ && !nothing_fits_ && (any_left() || now - last_heard_ < patience_.silence);
  if (in_flight_ > 0 || waits) return traffic ? Step::worked : Step::waited;

  progress_->clear();
  dispatch_.late = dispatch_.left > 0 && (nothing_fits_ || (stopping_ && dispatch_.signal == 0));
  if (dispatch_.left > 0) look_for_too_long();
  dispatch_.wall_s = std::chrono::duration<double>(now - begin_).count();
  dispatch_.apart = std::any_of(workers_.begin() + 1, workers_.end(), [](const Worker& worker) { return worker.lost; });
  for (int rank = 1; rank < channel_->size(); ++rank)
    if (!workers_[static_cast<std::size_t>(rank)].lost) channel_->send(rank, Finish{dispatch_.apart});
  return Step::finished;
}

void Master::wait_until_gone() {
  const auto begin = Clock::now();
  const auto here = [](const Worker& worker) { return !worker.lost && !worker.gone; };
  Backoff backoff;
  while (std::any_of(workers_.begin() + 1, workers_.end(), here) && Clock::now() - begin < patience_.drain) {
    if (receive()) backoff.reset();
    backoff.wait();
  }
  for (int rank = 1; rank < channel_->size(); ++rank)
    if (here(workers_[static_cast<std::size_t>(rank)])) lose(rank);
}

bool Master::receive() {
  bool any = false;
  while (const auto envelope = channel_->probe()) {
    any = true;
    Worker& worker = workers_[static_cast<std::size_t>(envelope->source)];
    worker.heard = last_heard_ = Clock::now();
    if (worker.lost && !std::exchange(worker.told, true))
      stopping_ ? channel_->send(envelope->source, Stop{}) : channel_->send(envelope->source, Drop{});
    switch (envelope->tag) {
      case Tag::report: report(envelope->source, channel_->receive<Report>(*envelope)); break;
      case Tag::alive:
        worker.kept = channel_->receive<Alive>(*envelope).kept;
        forget_kept(worker);
        break;
      case Tag::dropped:
        channel_->receive<Dropped>(*envelope);
        worker.lost = worker.told = false;
        if (notices_.found_again) notices_.found_again(envelope->source);
        break;
      case Tag::gone: channel_->receive<Gone>(*envelope), worker.gone = true; break;
      case Tag::interrupted: stop(channel_->receive<Interrupted>(*envelope).signal); break;
      default: channel_->unexpected(*envelope);
    }
  }
  return any;
}

void Master::report(int rank, const Report& report) {
  Worker& worker = workers_[static_cast<std::size_t>(rank)];
  const bool finished = report.outcome != TaskOutcome::pending;
  const auto is_it = [&](const PendingTask& task) { return task.index == report.task; };
  const auto had = std::find_if(worker.tasks.begin(), worker.tasks.end(), is_it);
  const bool has_it = had != worker.tasks.end();
  if (!has_it && !worker.lost)
    throw ProtocolError(fmt::format("rank {} reports task {}, which it does not have", rank, report.task));
  PendingTask task;
  if (has_it) {
    task = *had;
    worker.tasks.erase(had);
    --in_flight_;
  }
  if (!finished) {
    dispatch_.busy_s += report.busy_s;
    patience_.time.learn_part(task.cost, report.share, TimeBudget::Seconds(report.busy_s));
    task.tried_s = std::max(task.tried_s, report.busy_s);
    if (has_it) given_up_.push_back(task);
    return;
  }
  bool counted = has_it;
  if (!has_it) {  // finished after all: unless somebody has it by now, nobody else needs to
    const auto waits = std::find_if(pool_.begin() + static_cast<std::ptrdiff_t>(next_), pool_.end(), is_it);
    counted = waits != pool_.end();
    if (counted) {
      task = *waits;
      pool_.erase(waits);
      pool_cost_ -= task.cost;
    }
  }
  if (counted) count(task, report);
  worker.unkept.push_back({task, report, counted});
  forget_kept(worker);
}

void Master::forget_kept(Worker& worker) {
  for (; worker.forgotten < worker.kept && !worker.unkept.empty(); ++worker.forgotten) worker.unkept.pop_front();
}

void Master::count(const PendingTask& task, const Report& report) {
  dispatch_.busy_s += report.busy_s;
  patience_.time.learn(task.cost, TimeBudget::Seconds(report.busy_s));
  nothing_fits_ = false;
  --dispatch_.left;
  ++dispatch_.finished.at(static_cast<std::size_t>(report.outcome));
  if (report.outcome != TaskOutcome::ok && dispatch_.failures.size() < failures_kept)
    dispatch_.failures.push_back({task.index, report.outcome, std::string(report.message())});
  progress_->finished(report.outcome, task.cost, report.busy_s);
}

void Master::take_back(const PendingTask& task, const Report& report) {
  ++dispatch_.left;
  --dispatch_.finished.at(static_cast<std::size_t>(report.outcome));
  auto& failures = dispatch_.failures;
  failures.erase(std::remove_if(failures.begin(), failures.end(),
                                [&](const Dispatch::Failure& failure) { return failure.task == task.index; }),
                 failures.end());
  progress_->taken_back(report.outcome, task.cost, report.busy_s);
}

void Master::look_for_lost() {
  const auto now = Clock::now();
  if (now - std::exchange(stepped_, now) > patience_.silence / 2)  // the master was away itself
    for (Worker& worker : workers_) worker.heard = now;
  const bool drained = stopping_ && now - stopped_ > patience_.drain;
  for (int rank = 1; rank < channel_->size(); ++rank) {
    const Worker& worker = workers_[static_cast<std::size_t>(rank)];
    if (!worker.lost && (now - worker.heard > patience_.silence || (drained && !worker.tasks.empty()))) lose(rank);
  }
}

void Master::lose(int rank) {
  Worker& worker = workers_[static_cast<std::size_t>(rank)];
  worker.lost = true;
  if (notices_.lost) notices_.lost(rank);
  const std::vector<PendingTask> tasks = std::exchange(worker.tasks, {});
  in_flight_ -= static_cast<std::int64_t>(tasks.size());
  for (const PendingTask& task : tasks) put_back(task, task.batch >= 0 || &task == &tasks.front());
  worker.forgotten += static_cast<std::int64_t>(worker.unkept.size());
  for (const Finished& one : std::exchange(worker.unkept, {})) {
    if (!one.counted) continue;
    take_back(one.task, one.report);
    put_back(one.task, false);
  }
}

void Master::put_back(PendingTask task, bool begun) {
  if (begun) ++task.lost, task.batch = -1;
  if (task.lost >= patience_.attempts && !stopping_ && notices_.give_up) {
    count(task, Report(task.index, TaskOutcome::crashed, 0, notices_.give_up(task.index, task.lost)));
    return;
  }
  const auto begin = pool_.begin() + static_cast<std::ptrdiff_t>(next_);
  pool_.insert(std::upper_bound(begin, pool_.end(), task, comes_first), task);
  pool_cost_ += task.cost;
}

void Master::stop(int signal) {
  if (std::exchange(stopping_, true)) return;
  dispatch_.signal = signal;
  stopped_ = Clock::now();
  if (signal != 0 && notices_.stopping) notices_.stopping(signal);
  for (int rank = 1; rank < channel_->size(); ++rank)
    if (!workers_[static_cast<std::size_t>(rank)].lost) channel_->send(rank, Stop{});
}

void Master::hand_out() {
  for (int rank = 1; rank < channel_->size() && next_fits(); ++rank)
    if (is_idle(rank) && !next_goes_alone()) assign(rank);
  for (int rank = 1; rank < channel_->size() && next_fits(); ++rank)
    if (may_hold_another(workers_[static_cast<std::size_t>(rank)])) assign(rank);
  for (int rank = 1; rank < channel_->size() && in_flight_ == 0 && next_fits() && next_goes_alone(); ++rank)
    if (is_idle(rank)) assign(rank);
}

bool Master::next_fits() {
  if (next_ >= pool_.size() || nothing_fits_) return false;
  const TimeBudget::Seconds since_begin = Clock::now() - begin_;
  const auto first = pool_.begin() + static_cast<std::ptrdiff_t>(next_);
  const auto fits =
      std::find_if(first, pool_.end(), [&](const PendingTask& task) { return patience_.time.fits(task, since_begin); });
  nothing_fits_ = fits == pool_.end();
  if (!nothing_fits_) std::rotate(first, fits, fits + 1);
  return !nothing_fits_;
}

void Master::look_for_too_long() {
  const TimeBudget& time = patience_.time;
  std::vector<PendingTask> left(pool_.begin() + static_cast<std::ptrdiff_t>(next_), pool_.end());
  left.insert(left.end(), given_up_.begin(), given_up_.end());
  if (left.empty() ||
      std::any_of(left.begin(), left.end(), [&](const PendingTask& task) { return time.ever_fits(task); }))
    return;
  dispatch_.too_long = *std::max_element(left.begin(), left.end(), [&](const PendingTask& a, const PendingTask& b) {
    return time.expected(a) < time.expected(b);
  });
  dispatch_.too_long_s = time.expected(*dispatch_.too_long).count();
}

bool Master::is_idle(int rank) const {
  const Worker& worker = workers_[static_cast<std::size_t>(rank)];
  return !worker.lost && worker.tasks.empty();
}

bool Master::any_left() const {
  return std::any_of(workers_.begin() + 1, workers_.end(), [](const Worker& worker) { return !worker.lost; });
}

bool Master::next_goes_alone() const {
  const int lost_before = std::max(patience_.attempts - 1, 1);
  return next_ < pool_.size() && pool_[next_].lost >= lost_before;
}

bool Master::may_hold_another(const Worker& worker) const {
  constexpr double margin = 2;  // costs are estimates
  if (worker.tasks.size() != 1 || pool_[next_].batch >= 0 || pool_[next_].lost > 0) return false;
  const TimeBudget::Seconds begins = Clock::now() - begin_ + patience_.time.expected(worker.tasks.front());
  if (!patience_.time.fits(pool_[next_], begins)) return false;
  const double second = pool_[next_].cost;
  const auto workers = static_cast<double>(channel_->size() - 1);
  return margin * workers * (worker.tasks.front().cost + second) <= pool_cost_ - second;
}

void Master::assign(int rank) {
  const PendingTask first = pool_[next_];
  Assign assign;
  do {
    const PendingTask& task = pool_[next_++];
    pool_cost_ -= task.cost;
    workers_[static_cast<std::size_t>(rank)].tasks.push_back(task);
    ++in_flight_;
    assign.add(task.index);
  } while (first.batch >= 0 && assign.count < Assign::most && next_ < pool_.size() &&
           pool_[next_].batch == first.batch && pool_[next_].cost == first.cost);
  channel_->send(rank, assign);
}

}  // namespace rodsweep
