#include "runner/file/provenance.hpp"

#include <H5public.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <mpi.h>
#include <petscversion.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "revision.hpp"

namespace rodsweep {
namespace {

/// "Open MPI v4.1.4": the library's version text up to the first comma or line end.
std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(text, &length);
  const std::string all(text, static_cast<std::size_t>(length));
  return all.substr(0, all.find_first_of(",\n"));
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("HDF5 {}.{}.{}", major, minor, release);
}

std::string eigen_version() {
#ifdef EIGEN_VERSION_STRING  // 5 and newer
  return EIGEN_VERSION_STRING;
#else
  return fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
#endif
}

/// "AVX-512 on Intel(R) Xeon(R) Gold 6248": the vector instructions of the build, and this machine's processor.
std::string processor() {
#if defined(__AVX512F__)
  const char* instructions = "AVX-512";
#elif defined(__AVX__)
  const char* instructions = "AVX";
#else
  const char* instructions = "no AVX";
#endif
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.compare(0, 10, "model name") == 0 && colon != std::string::npos)
      return fmt::format("{} on {:.80}", instructions, line.substr(colon + 2));
  }
  return instructions;
}

}  // namespace

std::string source_revision() { return built_revision; }

std::string library_versions() {
#ifdef __clang__
  const char* compiler = "clang++ " __clang_version__;
#else
  const char* compiler = "g++ " __VERSION__;
#endif
  return fmt::format("rodsweep {}; {}; PETSc {}.{}.{}; {}; Eigen {}; {}; {}", RODSWEEP_VERSION, mpi_version(),
                     PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR, hdf5_version(), eigen_version(),
                     compiler, processor());
}

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

std::int64_t seconds_of_utc(const std::string& text) {
  std::tm time{};
  return strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &time) != nullptr ? timegm(&time) : 0;
}

Provenance provenance_of_this_process(std::string user_command) {
  Provenance provenance;
  provenance.begin_utc = utc_now();
  provenance.host = host_name();
  provenance.user_command = std::move(user_command);
  provenance.revision = source_revision();
  provenance.versions = library_versions();
  const char* options = std::getenv("PETSC_OPTIONS");
  provenance.petsc_options = options != nullptr ? options : "";
  return provenance;
}

}  // namespace rodsweep
