// The program's output: results on stdout, progress and warnings on stderr. Only one rank prints.
// close() returns the first error on stdout; errors on stderr are ignored. Text other than raw is made printable().
// Between rank and terminal, mpirun has a pipe; Open MPI 5 passes on whole lines only. So a rank writes its messages to
// the terminal of its mpirun itself. Respects NO_COLOR and TERM=dumb.
#pragma once

#include <cstdio>
#include <memory>
#include <string_view>

namespace rodsweep {

class Console {
 public:
  explicit Console(bool speaks);

  void result(std::string_view text);           ///< a line on stdout
  void raw_result(std::string_view text);       ///< unchanged, on stdout
  void raw_error(std::string_view text) const;  ///< unchanged, on stderr
  void note(std::string_view text);             ///< "rodsweep: text" on stderr
  void warn(std::string_view text);             ///< "rodsweep: warning: text"
  void error(std::string_view text);            ///< "rodsweep: error: text"
  void status(std::string_view text);  ///< replaces the status line at the bottom of a live terminal; "" removes it

  bool live() const { return live_; }  ///< stderr is a terminal, so status() has an effect
  int columns() const;                 ///< the terminal's width; 0: not known

  /// Closes stdout. Returns 0 or the errno of the first failed write; later results were not written.
  int close();

 private:
  void line(std::string_view colour, std::string_view label, std::string_view text);

  bool speaks_, live_, colours_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> messages_{stderr, [](std::FILE*) { return 0; }};
  bool status_shown_ = false;
  int failure_ = 0;  ///< errno of the first failed write to stdout
};

}  // namespace rodsweep
