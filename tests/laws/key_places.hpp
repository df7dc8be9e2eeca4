// Every key of every kind of job, from the tables of keys, with a job in which it can be given; and values that its row
// allows. For laws about keys: a new row is among them by being in its table.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/runner/file_examples.hpp"

namespace rodsweep::laws {

/// A folder for the job file, with files of every kind. The first names have spaces, the second ones are in a folder.
class Inputs {
 public:
  Inputs();
  /// Of this kind, as written in a job.
  const std::vector<std::string>& of(FileKind kind) const { return names_.at(kind); }
  const std::map<FileKind, std::vector<std::string>>& all() const { return names_; }
  std::filesystem::path job() const { return folder_ / "job.json"; }

 private:
  TemporaryFolder folder_;
  std::map<FileKind, std::vector<std::string>> names_;
};
const Inputs& inputs();

struct KeyPlace {
  Json job;             ///< valid, but for a file that is not suitable
  std::string pointer;  ///< of the key in the job
  Key key;
  std::vector<std::string> sweepable;  ///< pointers of the objects around it that may be swept
  bool is_tag = false;                 ///< it decides which keys the object around it has

  std::string path() const;  ///< "guesses[1].oracle.error"
  Json with(Json value) const;
};

/// Every key: those of a scene in each scene that has them, those that all scenes have in bending rods; those of `solve`
/// with each method; those of all guesses, of data sets and of trainings.
void visit_keys(const std::function<void(const KeyPlace&)>& visit);

/// A sweep of each scene, by its type.
std::map<std::string, Json> jobs_by_scene();

/// Values that the row allows. Others of its keys may not allow them.
std::vector<Json> candidates(const Key& key);

/// The job as `validate` and `plan` read it.
Job read(const Json& job);

/// What validate and plan say; "" if they accept the job.
std::string objection(const Json& job);

/// The first candidates that are accepted, at most `count`.
std::vector<Json> accepted(const KeyPlace& at, std::size_t count);

}  // namespace rodsweep::laws
