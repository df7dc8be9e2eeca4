#include "runner/dispatch/worker.hpp"

#include <utility>

namespace rodsweep {

namespace {

constexpr int master = 0;
constexpr std::chrono::milliseconds look_pause{5};

}  // namespace

Worker::Worker(Channel& channel, TaskBody body, std::function<int()> signal, std::function<void()> while_running,
               Heartbeat heartbeat, TimeSource now)
    : channel_(&channel),
      body_(std::move(body)),
      signal_(std::move(signal)),
      while_running_(std::move(while_running)),
      heartbeat_(std::move(heartbeat)),
      now_(now) {}

bool Worker::run() {
  Backoff backoff;
  for (;;) {
    switch (step()) {
      case Step::worked: backoff.reset(); break;
      case Step::waited: backoff.wait(); break;
      case Step::finished: return ranks_lost_;
    }
  }
}

Worker::Step Worker::step() {
  const bool traffic = receive();
  heed_signal();
  beat();
  if (stopping_) give_back();
  if (!hand_.empty()) {
    const std::int64_t task = hand_.front();
    hand_.pop_front();
    run(task);
    return Step::worked;
  }
  if (while_running_) while_running_();
  if (dismissed_) return Step::finished;
  return traffic ? Step::worked : Step::waited;
}

void Worker::give_back() {
  for (const std::int64_t task : std::exchange(hand_, {}))
    channel_->send(master, Report(task, TaskOutcome::pending, 0, ""));
}

bool Worker::receive() {
  bool any = false;
  while (const auto envelope = channel_->probe()) {
    any = true;
    switch (envelope->tag) {
      case Tag::assign: hand_.push_back(channel_->receive<Assign>(*envelope).task); break;
      case Tag::stop: channel_->receive<Stop>(*envelope), stopping_ = true; break;
      case Tag::finish:  // during a task: the master declared this rank lost and reassigned its tasks
        ranks_lost_ = channel_->receive<Finish>(*envelope).ranks_lost;
        dismissed_ = stopping_ = true;
        break;
      default: channel_->unexpected(*envelope);
    }
  }
  return any;
}

void Worker::heed_signal() {
  const int signal = signal_();
  if (signal == 0 || told_) return;
  channel_->send(master, Interrupted{signal});
  told_ = stopping_ = true;
}

void Worker::beat() {
  const TimePoint now = now_();
  if (dismissed_ || now - beat_ < heartbeat_.interval) return;
  beat_ = now;
  channel_->send(master, Alive{heartbeat_.saved()});
}

void Worker::run(std::int64_t task) {
  const TimePoint begin = now_();
  looked_ = begin;
  const TaskResult result = body_(task, [this] { return stop_requested(); });
  const std::chrono::duration<double> busy = now_() - begin;
  channel_->send(master, Report(task, result.outcome, busy.count(), result.message));
}

bool Worker::stop_requested() {
  if (stopping_) return true;
  heed_signal();
  if (const TimePoint now = now_(); now - looked_ >= look_pause) {
    looked_ = now;
    if (while_running_) while_running_();
    receive();
    beat();
  }
  return stopping_;
}

}  // namespace rodsweep
