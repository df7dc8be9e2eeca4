// Where the program speaks: results on stdout, progress and warnings on stderr. One rank speaks, the others are silent.
// What does not reach stdout is remembered, and told by close(); nobody can be told what does not reach stderr.
// Knows whether a person watches stderr, also through mpirun, which puts a pipe between the rank and the terminal;
// honours NO_COLOR and TERM=dumb.
#pragma once

#include <string_view>

namespace rodsweep {

class Console {
 public:
  explicit Console(bool speaks);

  void result(std::string_view text);           ///< a line on stdout
  void raw_result(std::string_view text);       ///< as it is, on stdout
  void raw_error(std::string_view text) const;  ///< as it is, on stderr
  void note(std::string_view text);             ///< "rodsweep: text" on stderr
  void warn(std::string_view text);             ///< "rodsweep: warning: text"
  void error(std::string_view text);            ///< "rodsweep: error: text"
  void status(std::string_view text);  ///< replaces the status line at the bottom of a live terminal; "" removes it

  bool live() const { return live_; }  ///< stderr is a terminal: status() is of use

  /// Closes stdout, for good. 0, or the errno of the first write that failed; nothing was written there after it.
  int close();

 private:
  void line(std::string_view colour, std::string_view label, std::string_view text);

  bool speaks_, live_, colours_;
  bool status_shown_ = false;
  int failure_ = 0;  ///< errno of a write to stdout
};

}  // namespace rodsweep
