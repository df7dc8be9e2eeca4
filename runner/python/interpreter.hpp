// The embedded interpreter of Python: its start, what it takes from outside the job, and the end of a call.
#pragma once

#include <Python.h>

#include <string>

namespace rodsweep {

/// Prints a warning as the program does. One of several ranks prints it: all meet the same.
void warn(const std::string& text);

/// Starts the interpreter, once in a process.
void start_python();

// A call whose result is no longer wanted is ended as Ctrl-C ends a program of Python: by a signal to the interpreter's
// thread, which also ends sleeping and waiting. By default this signal does nothing.

void begin_call() noexcept;      ///< the result of the call that follows is wanted
void interrupt_call() noexcept;  ///< called by any thread
/// The class of the exception that ends the call; `except Exception` does not catch it.
PyObject* interrupted();

/// User's code may change the folder. It finds itself there again in its next call; the program stays in its own.
class Visit {
 public:
  /// `folder`: where the code is, "" in the program's folder.
  explicit Visit(std::string& folder);
  ~Visit();
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

  /// Call once, before the interpreter starts.
  static void begin();

 private:
  std::string& folder_;
};

}  // namespace rodsweep
