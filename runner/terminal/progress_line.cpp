#include "runner/terminal/progress_line.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodsweep {

namespace {

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

ProgressLine::ProgressLine(Console& console, Clock::time_point now) : console_(&console), pause_(first_log_pause) {
  if (console.live()) pause_ = bar_pause;
  next_ = now + pause_;
}

void ProgressLine::show(Clock::time_point now, double fraction, const std::string& text) {
  if (console_->live()) {
    console_->status(bar(fraction) + " " + text);
  } else {
    console_->note(text);
    pause_ = std::min<Clock::duration>(pause_ + pause_ / 2, longest_log_pause);
  }
  next_ = now + pause_;
}

void ProgressLine::clear() { console_->status(""); }

}  // namespace rodsweep
