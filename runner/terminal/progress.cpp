#include "runner/terminal/progress.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "runner/terminal/formats.hpp"

namespace rodsweep {
namespace {

constexpr double recent = 100;  // tasks

double seconds(Progress::Clock::duration span) { return std::chrono::duration<double>(span).count(); }

using namespace std::chrono_literals;

constexpr auto bar_pause = 100ms;
constexpr auto first_log_pause = 5s;
constexpr auto longest_log_pause = 300s;

std::string bar(double fraction) {
  constexpr int width = 24;
  const int filled = std::clamp(static_cast<int>(fraction * width), 0, width);
  return fmt::format("[{}{}]", std::string(filled, '#'), std::string(width - filled, '.'));
}

}  // namespace

Progress::Progress(Console& console, const Work& work, Clock::time_point now)
    : line_(console, now), work_(work), begin_(now) {}

void Progress::finished(TaskOutcome outcome, double cost, double busy_s) {
  ++done_;
  if (outcome != TaskOutcome::ok) ++failed_;
  done_cost_ += cost;
  busy_s_ += busy_s;
  if (cost > 0) pace_ += (busy_s / cost - pace_) / std::min(static_cast<double>(done_), recent);
}

void Progress::uncount(TaskOutcome outcome, double cost, double busy_s) {
  --done_;
  if (outcome != TaskOutcome::ok) --failed_;
  done_cost_ -= cost;
  busy_s_ -= busy_s;
}

std::optional<double> Progress::seconds_left(Clock::time_point now) const {
  if (done_ == 0 || done_cost_ <= 0) return std::nullopt;
  const double whole = busy_s_ + pace_ * (work_.cost - done_cost_);
  const double left = whole / work_.workers - seconds(now - begin_);
  if (left <= 0) return std::nullopt;  // the last tasks take longer than estimated
  return left;
}

std::string Progress::text(Clock::time_point now) const {
  const std::int64_t done = work_.done_before + done_, failed = work_.failed_before + failed_;
  std::string text =
      fmt::format("{} of {} tasks ({} %)", done, work_.total, 100 * done / std::max<std::int64_t>(work_.total, 1));
  if (failed > 0) text += fmt::format(", {} failed", failed);
  const double elapsed = seconds(now - begin_);
  if (done_ > 0 && elapsed > 0) {
    const double rate = static_cast<double>(done_) / elapsed;
    text += rate >= 1 ? fmt::format(", {:.3g}/s", rate) : fmt::format(", {:.3g}/min", 60 * rate);
  }
  if (const auto left = seconds_left(now)) text += fmt::format(", {} left", duration_text(*left));
  return text;
}

void Progress::show(Clock::time_point now) {
  if (!line_.due(now)) return;
  const auto done = static_cast<double>(work_.done_before + done_);
  line_.show(now, done / static_cast<double>(std::max<std::int64_t>(work_.total, 1)), text(now));
}

std::string progress_line(double fraction, const std::string& text, int columns) {
  std::string line = bar(fraction) + " " + text;
  const auto most = static_cast<std::size_t>(std::max(columns, 1) - 1);  // terminals wrap after the last column
  if (columns == 0 || line.size() <= most) return line;
  return text.substr(0, most);
}

ProgressLine::ProgressLine(Console& console, Clock::time_point now) : console_(&console), pause_(first_log_pause) {
  if (console.live()) pause_ = bar_pause;
  next_ = now + pause_;
}

void ProgressLine::show(Clock::time_point now, double fraction, const std::string& text) {
  if (console_->live()) {
    console_->status(progress_line(fraction, text, console_->columns()));
  } else {
    console_->note(text);
    pause_ = std::min<Clock::duration>(pause_ + pause_ / 2, longest_log_pause);
  }
  next_ = now + pause_;
}

void ProgressLine::clear() { console_->status(""); }

}  // namespace rodsweep
