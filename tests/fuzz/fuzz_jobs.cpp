// Fuzzes the reader of jobs: raw bytes, and the shipped jobs with random changes (tests/runner/job_mutations.hpp).
#include <fmt/format.h>

#include <cstring>

#include "tests/runner/job_mutations.hpp"

using namespace rodsweep;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  const Json job = seed % 4 == 0 ? Json() : Json::parse(data, data + size, nullptr, false);
  if (!job.is_object()) return LLVMFuzzerMutate(data, size, most);
  std::mt19937_64 random(seed);
  const std::string text = mutated(job, random).dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size), refusal = verdict(text, "job.json");
  if (refusal.empty() || (refusal.rfind("job.json: ", 0) == 0 && inside_word(refusal, text).empty())) return 0;
  fmt::print(stderr, "not for users: {}\n", refusal);
  std::abort();
}
