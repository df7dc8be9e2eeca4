// Where the program speaks: results on stdout, progress and warnings on stderr. One rank speaks, the others are silent.
// Knows whether a person watches stderr, also through mpirun, which puts a pipe between the rank and the terminal;
// honours NO_COLOR and TERM=dumb.
#pragma once

#include <string_view>

namespace rodsweep {

class Console {
 public:
  explicit Console(bool speaks);

  void result(std::string_view text) const;      ///< a line on stdout
  void raw_result(std::string_view text) const;  ///< as it is, on stdout
  void raw_error(std::string_view text) const;   ///< as it is, on stderr
  void note(std::string_view text);              ///< "rodsweep: text" on stderr
  void warn(std::string_view text);              ///< "rodsweep: warning: text"
  void error(std::string_view text);             ///< "rodsweep: error: text"
  void status(std::string_view text);  ///< replaces the status line at the bottom of a live terminal; "" removes it

  bool live() const { return live_; }  ///< stderr is a terminal: status() is of use

 private:
  void line(std::string_view colour, std::string_view label, std::string_view text);

  bool speaks_, live_, colours_;
  bool status_shown_ = false;
};

}  // namespace rodsweep
