#include "runner/job/input_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "runner/job/checksum.hpp"
#include "runner/job/job.hpp"

namespace rodsweep {

InputFile input_file(const std::filesystem::path& job, const std::string& key_path, const std::string& text,
                     MissingFiles missing) {
  const std::filesystem::path path = job.parent_path() / text;
  const auto refuse = [&](const std::string& reason) {
    throw job_error(job, key_path,
                    fmt::format("\"{}\" is not allowed: {} {}; the path is relative to the job file's folder", text,
                                path.native(), reason));
  };
  std::error_code error;
  if (!std::filesystem::exists(path, error) && missing == MissingFiles::accepted) return {key_path, path, ""};
  const std::filesystem::path maker = job.parent_path() / path.stem().concat(".json");
  if (!std::filesystem::exists(path, error) && std::filesystem::exists(maker, error))
    refuse(fmt::format("is not there; does {} make it? Then run that first", maker.native()));
  if (std::filesystem::is_directory(path, error)) refuse("is a folder");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(fmt::format("cannot be read: {}", std::strerror(errno ? errno : EIO)));
  Checksum sum;
  std::array<char, 1 << 16> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0)
    sum.add(block.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad()) refuse(fmt::format("cannot be read: {}", std::strerror(errno ? errno : EIO)));
  return {key_path, path, fmt::format("{:016x}", sum.value())};
}

}  // namespace rodsweep
