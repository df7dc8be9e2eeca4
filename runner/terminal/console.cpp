#include "runner/terminal/console.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "solver/plugin/printable.hpp"

namespace rodsweep {

namespace {

std::string stderr_of_parent() { return fmt::format("/proc/{}/fd/2", getppid()); }

/// mpirun reads each rank's stderr through a pipe. If mpirun is the parent process, checks its stderr instead.
bool stderr_is_terminal() {
  if (isatty(STDERR_FILENO)) return true;
  if (std::getenv("OMPI_COMM_WORLD_RANK") == nullptr) return false;
  struct stat file {};
  if (stat(stderr_of_parent().c_str(), &file) != 0 || !S_ISCHR(file.st_mode)) return false;
  const unsigned device = major(file.st_rdev);
  return device == 4 || device == 5 || (device >= 136 && device <= 143);  // consoles, /dev/tty, pseudo terminals
}

bool set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

}  // namespace

Console::Console(bool speaks) : speaks_(speaks) {
  const char* type = std::getenv("TERM");
  live_ = speaks && stderr_is_terminal() && type != nullptr && std::string_view(type) != "dumb";
  colours_ = live_ && !set("NO_COLOR");
}

int Console::columns() const {
  winsize size{};
  if (!live_ || ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0) return size.ws_col;
  const int terminal = open(stderr_of_parent().c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0) return 0;
  ioctl(terminal, TIOCGWINSZ, &size);
  ::close(terminal);
  return size.ws_col;
}

void Console::result(std::string_view text) { raw_result(printable(text) + '\n'); }

void Console::raw_result(std::string_view text) {
  if (!speaks_ || failure_ != 0) return;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) failure_ = errno;
}

int Console::close() {
  if (std::fclose(stdout) != 0 && failure_ == 0) failure_ = errno;  // network file systems report errors here
  return failure_;
}

void Console::raw_error(std::string_view text) const {
  if (speaks_) std::fwrite(text.data(), 1, text.size(), stderr);
}

void Console::note(std::string_view text) { line("", "", text); }
void Console::warn(std::string_view text) { line("\x1b[33m", "warning: ", text); }
void Console::error(std::string_view text) { line("\x1b[31m", "error: ", text); }

void Console::line(std::string_view colour, std::string_view label, std::string_view text) {
  if (!speaks_) return;
  status("");
  const bool coloured = colours_ && !colour.empty();
  // One write per line: lines of several processes do not mix.
  const std::string line =
      fmt::format("{}rodsweep: {}{}{}\n", coloured ? colour : "", label, printable(text), coloured ? "\x1b[0m" : "");
  std::fwrite(line.data(), 1, line.size(), stderr);
}

void Console::status(std::string_view text) {
  if (!live_ || (text.empty() && !status_shown_)) return;
  const std::string line = fmt::format("\r\x1b[K{}", text);
  std::fwrite(line.data(), 1, line.size(), stderr);
  status_shown_ = !text.empty();
}

}  // namespace rodsweep
