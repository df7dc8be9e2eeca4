#include "runner/dispatch/master.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "runner/dispatch/backoff.hpp"

namespace rodsweep {

namespace {

constexpr std::size_t failures_kept = 5;
constexpr int lost_before_alone = 2;

}  // namespace

Master::Master(Channel& channel, std::vector<PendingTask> tasks, Progress& progress, std::function<int()> signal)
    : channel_(&channel),
      progress_(&progress),
      signal_(std::move(signal)),
      pool_(std::move(tasks)),
      workers_(static_cast<std::size_t>(channel.size())),
      begin_(Progress::Clock::now()) {
  std::sort(pool_.begin(), pool_.end(), [](const PendingTask& a, const PendingTask& b) {
    return std::tuple(a.lost, -a.cost, a.batch, a.index) < std::tuple(b.lost, -b.cost, b.batch, b.index);
  });
  for (const PendingTask& task : pool_) pool_cost_ += task.cost;
  dispatch_.left = static_cast<std::int64_t>(pool_.size());
}

void Master::run() {
  Backoff backoff;
  for (;;) {
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
  if (dispatch_.signal == 0) hand_out();

  const auto now = Progress::Clock::now();
  progress_->show(now);
  if (in_flight_ > 0) return traffic ? Step::worked : Step::waited;

  progress_->clear();
  dispatch_.wall_s = std::chrono::duration<double>(now - begin_).count();
  for (int rank = 1; rank < channel_->size(); ++rank) channel_->send(rank, Finish{});
  return Step::finished;
}

bool Master::receive() {
  bool any = false;
  while (const auto envelope = channel_->probe()) {
    any = true;
    switch (envelope->tag) {
      case Tag::report: report(envelope->source, channel_->receive<Report>(*envelope)); break;
      case Tag::interrupted: stop(channel_->receive<Interrupted>(*envelope).signal); break;
      default: channel_->unexpected(*envelope);
    }
  }
  return any;
}

void Master::report(int rank, const Report& report) {
  auto& tasks = workers_[static_cast<std::size_t>(rank)].tasks;
  const auto task =
      std::find_if(tasks.begin(), tasks.end(), [&](const PendingTask& t) { return t.index == report.task; });
  if (task == tasks.end())
    throw ProtocolError(fmt::format("rank {} reports task {}, which it does not have", rank, report.task));
  const double cost = task->cost;
  tasks.erase(task);
  --in_flight_;
  dispatch_.busy_s += report.busy_s;
  if (report.outcome == TaskOutcome::pending) return;

  --dispatch_.left;
  ++dispatch_.finished.at(static_cast<std::size_t>(report.outcome));
  if (report.outcome != TaskOutcome::ok && dispatch_.failures.size() < failures_kept)
    dispatch_.failures.push_back({report.task, report.outcome, std::string(report.message())});
  progress_->finished(report.outcome, cost, report.busy_s);
}

void Master::stop(int signal) {
  if (dispatch_.signal != 0) return;
  dispatch_.signal = signal;
  for (int rank = 1; rank < channel_->size(); ++rank) channel_->send(rank, Stop{});
}

void Master::hand_out() {
  for (int rank = 1; rank < channel_->size() && next_ < pool_.size(); ++rank)
    if (workers_[static_cast<std::size_t>(rank)].tasks.empty() && !next_goes_alone()) assign(rank);
  for (int rank = 1; rank < channel_->size() && next_ < pool_.size(); ++rank)
    if (may_hold_another(workers_[static_cast<std::size_t>(rank)])) assign(rank);
  if (next_goes_alone() && in_flight_ == 0) assign(1);
}

bool Master::next_goes_alone() const { return next_ < pool_.size() && pool_[next_].lost >= lost_before_alone; }

bool Master::may_hold_another(const Worker& worker) const {
  constexpr double margin = 2;  // costs are estimates
  if (worker.tasks.size() != 1 || pool_[next_].batch >= 0 || pool_[next_].lost > 0) return false;
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
