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

bool is_terminal(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) != 0 || !S_ISCHR(file.st_mode)) return false;
  const unsigned device = major(file.st_rdev);
  return device == 4 || device == 5 || (device >= 136 && device <= 143);  // consoles, /dev/tty, pseudo terminals
}

/// The terminal where mpirun, the parent process, shows what the rank writes to stderr; null: there is none.
std::FILE* terminal_of_mpirun() {
  if (isatty(STDERR_FILENO) || std::getenv("OMPI_COMM_WORLD_RANK") == nullptr) return nullptr;
  const std::string path = fmt::format("/proc/{}/fd/2", getppid());
  const int terminal = is_terminal(path) ? open(path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC) : -1;
  std::FILE* const file = terminal < 0 ? nullptr : fdopen(terminal, "w");
  if (file != nullptr) std::setvbuf(file, nullptr, _IONBF, 0);
  return file;
}

bool set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

}  // namespace

Console::Console(bool speaks) : speaks_(speaks) {
  if (speaks)
    if (std::FILE* const terminal = terminal_of_mpirun()) messages_ = {terminal, std::fclose};
  const char* type = std::getenv("TERM");
  live_ = speaks && isatty(fileno(messages_.get())) && type != nullptr && std::string_view(type) != "dumb";
  colours_ = live_ && !set("NO_COLOR");
}

int Console::columns() const {
  winsize size{};
  if (live_) ioctl(fileno(messages_.get()), TIOCGWINSZ, &size);
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
  if (speaks_) std::fwrite(text.data(), 1, text.size(), messages_.get());
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
  std::fwrite(line.data(), 1, line.size(), messages_.get());
}

void Console::status(std::string_view text) {
  if (!live_ || (text.empty() && !status_shown_)) return;
  const std::string line = fmt::format("\r\x1b[K{}", text);
  std::fwrite(line.data(), 1, line.size(), messages_.get());
  status_shown_ = !text.empty();
}

}  // namespace rodsweep
