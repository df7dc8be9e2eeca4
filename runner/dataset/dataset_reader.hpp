// Reads a finished data set one simulation at a time.
//
// Simulations are numbered from 0, ordered by sample, then by grid point, so that the first and the last ones cover
// all grid points. Failed simulations are left out. Throws FileError if the file is missing, foreign, damaged,
// incomplete or not a data set.
//
// With `ranks`, rank 0 reads and broadcasts. Then all calls are collective, in the same order on every rank, and an
// error is a CollectiveError on all ranks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "network/encoding/stored_simulation.hpp"
#include "runner/file/task_reader.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

class DatasetReader {
 public:
  /// Without `ranks`, this process reads alone and needs no MPI.
  explicit DatasetReader(const std::filesystem::path& path, std::optional<MPI_Comm> ranks = std::nullopt);

  std::int64_t size() const { return static_cast<std::int64_t>(tasks_.size()); }  ///< simulations
  Task task(std::int64_t simulation) const;  ///< has its sample and its row in the plan's parameters()
  const Plan& plan() const { return *plan_; }

  /// Verifies the checksum.
  StoredSimulation read(std::int64_t simulation) const;
  std::vector<StoredSimulation> read(std::int64_t first, std::int64_t count) const;

  /// A hash of the job's text and all checksums: sixteen hexadecimal digits.
  const std::string& hash() const { return hash_; }
  /// A text about failed simulations, which are left out; empty if none failed.
  const std::string& note() const { return note_; }

 private:
  void open();

  std::filesystem::path path_;
  std::optional<MPI_Comm> ranks_;
  std::optional<Plan> plan_;
  std::optional<TaskReader> reader_;  ///< only on the rank that reads
  std::vector<std::int64_t> tasks_;
  std::string hash_, note_;
};

}  // namespace rodsweep
