// The files that a user's module of Python opens to read. Their contents are part of the tasks' identity only if the job
// names them among the guess's "inputs": the user is told of the others. Python's audit events report opened files; those
// that libraries open by themselves, as h5py does, are not seen. Not counted: Python's own files and packages, files of
// the system, and files that the process wrote.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rodsweep {

/// Call once, before the interpreter starts.
void watch_opened_files();

/// While it exists, opened files are those of a module, given by the path of its file.
class Watching {
 public:
  explicit Watching(const std::string& module);
  ~Watching();
  Watching(const Watching&) = delete;
  Watching& operator=(const Watching&) = delete;

 private:
  const std::string* before_;
};

/// The number of files that were opened so far by all modules. Fast, for every call.
std::size_t opened_files();

/// Warns once of each file that the module opened and that is not among the inputs.
void warn_of_unnamed(const std::string& module, const std::vector<std::string>& inputs);

}  // namespace rodsweep
