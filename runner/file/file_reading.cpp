#include "runner/file/file_reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "runner/file/layout.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/job/job.hpp"
#include "runner/text/checksum.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

bool has_hdf5_signature(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string start(8, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return start == "\x89HDF\r\n\x1a\n";
}

}  // namespace

FileError damaged_error(const fs::path& path, const std::string& reason) {
  return FileError("{} is damaged or incomplete: {}. Use a copy, or create it again", path.native(), reason);
}

std::string damage_text(const std::exception& failure) {
  const bool told = dynamic_cast<const Hdf5Error*>(&failure) != nullptr ||
                    dynamic_cast<const Damage*>(&failure) != nullptr ||
                    dynamic_cast<const JobError*>(&failure) != nullptr;
  return told ? failure.what() : "its contents are inconsistent";
}

hdf5::File open_own(const fs::path& path, const char* what) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    const std::string left = unfinished_text(path);
    throw FileError("{}: file not found{}{}", path.native(), left.empty() ? "" : "; ", left);
  }
  if (!fs::is_regular_file(status)) throw FileError("{} is not a file", path.native());
  if (!std::ifstream(path)) throw FileError("{} cannot be read: no permission", path.native());
  if (!has_hdf5_signature(path)) throw FileError("{} is not an HDF5 file", path.native());
  return reading(path, [&] {
    hdf5::File file = hdf5::open_file(path, H5F_ACC_RDONLY);
    if (!hdf5::has_attribute(file.id(), "/", "program") ||
        hdf5::read_text_attribute(file.id(), "/", "program") != "rodsweep")
      throw FileError("{} is an HDF5 file, but does not hold rodsweep {}", path.native(), what);
    return file;
  });
}

std::string kind_of(const hdf5::File& file) {
  const bool tells = hdf5::has_attribute(file.id(), "/", "kind");
  return tells ? hdf5::read_text_attribute(file.id(), "/", "kind") : "sweep";
}

void check_version(const hdf5::File& file, const fs::path& path, int known) {
  const int version = hdf5::read_int_attribute(file.id(), "/", "schema_version");
  if (version == known) return;
  throw FileError(
      "{} has schema version {}, but this rodsweep reads only version {}: use the revision that wrote it "
      "(/runs/revision in the file)",
      path.native(), version, known);
}

hdf5::File open_results(const fs::path& path) {
  hdf5::File file = open_own(path, "results");
  reading(path, [&] {
    if (kind_of(file) == "model")
      throw FileError("{} holds a trained model, not results of simulations; `rodsweep info` shows it", path.native());
    if (kind_of(file) == "systems")
      throw FileError("{} holds linear systems, not results: read it with rodsweep.systems() in Python", path.native());
    check_version(file, path, schema_version);
  });
  return file;
}

std::string job_checksum(const std::string& text) {
  Checksum sum;
  sum.add(text.data(), text.size());
  return fmt::format("{:016x}", sum.value());
}

std::string stored_job_text(const hdf5::File& file, const fs::path& path) {
  std::string text = hdf5::read_all<std::string>(file.id(), "/job/text").at(0);
  if (hdf5::has_attribute(file.id(), "/job", "text_checksum") &&
      hdf5::read_text_attribute(file.id(), "/job", "text_checksum") != job_checksum(text))
    throw damaged_error(path, "its job does not match its checksum (/job/text)");
  return text;
}

std::vector<std::uint8_t> read_states(const hdf5::File& file, const fs::path& path) {
  std::vector<std::uint8_t> states = hdf5::read_all<std::uint8_t>(file.id(), "/tasks/state");
  const auto odd = std::find_if(states.begin(), states.end(), [](std::uint8_t state) { return state > 1; });
  if (odd != states.end()) {
    throw FileError(
        "{} is damaged: /tasks/state of task {} is {}; must be 0 or 1. Run its job with --resume to verify all tasks "
        "and repeat damaged ones",
        path.native(), odd - states.begin(), *odd);
  }
  return states;
}

}  // namespace rodsweep
