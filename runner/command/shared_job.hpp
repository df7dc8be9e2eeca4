// The job that all ranks of a run work on.
#pragma once

#include <filesystem>

#include "runner/job/job.hpp"
#include "runner/mpi/mpi_session.hpp"

namespace rodsweep {

/// Collective. Rank 0 reads the job and its text travels, so that every rank has the same one, wherever its own copy of
/// the file stands. Throws CollectiveError, the same on every rank.
Job read_job_everywhere(const std::filesystem::path& path, const MpiSession& mpi);

}  // namespace rodsweep
