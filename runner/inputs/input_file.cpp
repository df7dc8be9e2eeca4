#include "runner/inputs/input_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "runner/text/checksum.hpp"
#include "runner/text/job_error.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// The nearest file name with the same extension in the missing file's folder, as written in a job; empty if none.
std::string nearest_name(const MissingFile& file) {
  std::vector<std::string> stems;
  std::error_code error;
  const fs::path folder = file.path.has_parent_path() ? file.path.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == file.path.extension() && !entry->is_directory(error))
      stems.push_back(entry->path().stem());
  std::sort(stems.begin(), stems.end());
  const std::string near = nearest(file.path.stem().native(), stems);
  return near.empty() ? "" : fs::path(file.written).replace_filename(near + file.path.extension().native()).native();
}

}  // namespace

bool InputFile::is_used_as(FileKind kind) const {
  return std::any_of(uses.begin(), uses.end(), [&](const FileUse& use) { return use.kind == kind; });
}

std::string missing_file_text(const fs::path& job, const MissingFile& file) {
  const fs::path maker = job.parent_path() / file.path.stem().concat(".json");
  std::error_code error;
  std::string advice;
  if (fs::exists(maker, error))
    advice = fmt::format("; if {} makes it, run that job first", maker.native());
  else if (const std::string near = nearest_name(file); !near.empty())
    advice = fmt::format("; did you mean \"{}\"?", near);
  return job_error(job, file.key_path,
                   "\"{}\" is not allowed: {} was not found; the path is relative to the job file's folder{}",
                   file.written, file.path.native(), advice)
      .what();
}

InputFile input_file(const std::filesystem::path& job, const std::string& key_path, const std::string& text,
                     MissingFiles missing) {
  const std::filesystem::path path = job.parent_path() / text;
  const auto refuse = [&](const std::string& reason) {
    throw job_error(job, key_path, "\"{}\" is not allowed: {} {}; the path is relative to the job file's folder", text,
                    path.native(), reason);
  };
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (missing == MissingFiles::accepted) return {path, "", {}};
    throw JobError(missing_file_text(job, {key_path, text, path}));
  }
  if (std::filesystem::is_directory(path, error)) refuse("is a folder");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(fmt::format("cannot be read: {}", std::strerror(errno ? errno : EIO)));
  Checksum sum;
  std::array<char, 1 << 16> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0)
    sum.add(block.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad()) refuse(fmt::format("cannot be read: {}", std::strerror(errno ? errno : EIO)));
  return {path, fmt::format("{:016x}", sum.value()), {}};
}

std::string to_bytes(const InputFiles& files) {
  std::string bytes;
  for (const auto& [written, file] : files)
    for (const std::string& text : {written, file.path.native(), file.hash}) bytes += text + '\0';
  return bytes;
}

InputFiles from_bytes(const std::string& bytes) {
  std::vector<std::string> texts;
  for (std::size_t begin = 0, end = 0; (end = bytes.find('\0', begin)) != std::string::npos; begin = end + 1)
    texts.push_back(bytes.substr(begin, end - begin));
  InputFiles files;
  for (std::size_t i = 0; i + 2 < texts.size(); i += 3) files[texts[i]] = {texts[i + 1], texts[i + 2], {}};
  return files;
}

}  // namespace rodsweep
