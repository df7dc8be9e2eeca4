// A finished data set, read simulation by simulation: what of it is in memory is the caller's choice.
//
// Simulations are numbered from 0 in the order of their samples, within a sample of their grid points, so that the
// first and the last ones have something of every grid point; those that failed are left out. Throws FileError for a
// file that is missing, foreign, damaged, not a data set or not complete.
//
// Of ranks that read a data set together one reads, and the others get what it read: then all calls are collective, in
// the same order on every rank, and what goes wrong is a CollectiveError on all of them.
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
  /// Without ranks this process reads alone, and needs no MPI.
  explicit DatasetReader(const std::filesystem::path& path, std::optional<MPI_Comm> ranks = std::nullopt);

  std::int64_t size() const { return static_cast<std::int64_t>(tasks_.size()); }  ///< simulations
  Task task(std::int64_t simulation) const;  ///< its sample, and its row in the plan's parameters()
  const Plan& plan() const { return *plan_; }

  /// Compared with its checksum.
  StoredSimulation read(std::int64_t simulation) const;
  std::vector<StoredSimulation> read(std::int64_t first, std::int64_t count) const;

  /// Sixteen hexadecimal digits over the job's text and all checksums: the same for the same data.
  const std::string& hash() const { return hash_; }
  /// Which simulations failed and are left out; empty: none.
  const std::string& note() const { return note_; }

 private:
  void open();

  std::filesystem::path path_;
  std::optional<MPI_Comm> ranks_;
  std::optional<Plan> plan_;
  std::optional<TaskReader> reader_;  ///< of the rank that reads
  std::vector<std::int64_t> tasks_;
  std::string hash_, note_;
};

}  // namespace rodsweep
