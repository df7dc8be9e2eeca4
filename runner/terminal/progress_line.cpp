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
