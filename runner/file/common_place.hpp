// Checks where ranks on several hosts are about to open one file. MPI-IO opens a file on all ranks at once: if one of
// them does not find it, the others wait for it forever.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>

namespace rodsweep {

/// Collective; makes the folder of `path`. All ranks throw the same FileError unless every rank finds there what rank 0
/// writes, and the path is short enough for MPI-IO.
void check_common_place(const std::filesystem::path& path, MPI_Comm comm);

/// Collective: runs `work` on rank 0. If it throws, every rank throws an error with the same text: FileError, or for any
/// other exception Hdf5Error.
void on_first_rank(MPI_Comm comm, const std::function<void()>& work);

}  // namespace rodsweep
