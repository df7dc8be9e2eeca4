// HDF5 files with something wrong in them, made by HDF5 itself: what is fuzzed is our reading, not libhdf5's, which is
// known to crash on some files whose bytes were changed (the program reads in a copy of itself for that). The input of
// the fuzzer is a list of edits: values of datasets, their shapes and types, attributes, what is missing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rodsweep::fuzz {

/// A file that is copied, and whose copies are edited.
class Original {
 public:
  explicit Original(const std::filesystem::path& path);

  /// Makes `path` a copy with the edits that the bytes describe; the same for the same bytes.
  void edited(const std::filesystem::path& path, const std::uint8_t* bytes, std::size_t size) const;

 private:
  std::vector<char> contents_;
  std::vector<std::string> objects_;  ///< paths of groups and datasets, sorted
};

/// Does work(), which may refuse `file` (FileError, JobError) with a message that is for users, but for what is of the
/// input. Whatever else leaves it is reported and ends the process.
void expect_plain(const std::filesystem::path& file, std::string_view input, const std::function<void()>& work);

/// A folder for the process, in memory where there is such a place.
std::filesystem::path scratch_folder();

}  // namespace rodsweep::fuzz
