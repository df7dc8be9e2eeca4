#include "runner/file/common_place.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/mpi/mpi_session.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Open MPI's file layer (4.1) copies the path to buffers of 256 bytes, and aborts if they overflow.
void check_length(const fs::path& path) {
  constexpr std::size_t most = 230;
  if (path.native().size() > most)
    throw FileError(
        fmt::format("{}: the path has {} bytes; must be at most {} for MPI-IO: name a shorter path with -o FILE, for "
                    "example from its folder",
                    path.native(), path.native().size(), most));
}

/// Creates a file with a new name, which no host can have cached. Leaves `token` empty in a folder that is read-only, as
/// that of a file to resume may be: then the ranks look for that file.
void create_in_folder_of(const fs::path& path, std::optional<UnfinishedFile>& token) {
  try {
    token.emplace(path).create();
  } catch (const FileError&) {
    token.reset();
    if (!fs::exists(path)) throw;
  }
}

}  // namespace

void check_common_place(const fs::path& path, MPI_Comm comm) {
  int rank = 0;
  check_mpi(MPI_Comm_rank(comm, &rank), "MPI_Comm_rank");
  std::optional<UnfinishedFile> token;
  std::string name = path.filename().native(), failure;
  if (rank == 0) try {
      check_length(path);
      make_folder_of(path);
      create_in_folder_of(path, token);
      if (token) name = token->path().filename().native();
    } catch (const FileError& error) {
      failure = error.what();
    }
  failure = broadcast(std::move(failure), comm);
  if (!failure.empty()) throw FileError(failure);
  name = broadcast(std::move(name), comm);

  std::error_code error;
  const bool found = fs::exists(path.parent_path() / name, error);
  const std::vector<std::string> hosts = gather_distinct(found ? "" : host_name(), comm);
  if (hosts.empty()) return;
  throw FileError(
      fmt::format("{}: ranks on {} do not find there what rank 0 writes: name a file in a folder that all hosts share "
                  "with -o FILE; relative paths start at the current folder of each rank",
                  path.native(), fmt::join(hosts, ", ")));
}

void on_first_rank(MPI_Comm comm, const std::function<void()>& work) {
  int rank = 0;
  check_mpi(MPI_Comm_rank(comm, &rank), "MPI_Comm_rank");
  enum { fine, file_error, other_error };
  int outcome = fine;
  std::string text;
  if (rank == 0) {
    try {
      work();
    } catch (const FileError& error) {
      outcome = file_error, text = error.what();
    } catch (const std::exception& error) {
      outcome = other_error, text = error.what();
    }
  }
  outcome = broadcast(outcome, comm);
  if (outcome == fine) return;
  text = broadcast(std::move(text), comm);
  if (outcome == file_error) throw FileError(text);
  throw Hdf5Error(text);
}

}  // namespace rodsweep
