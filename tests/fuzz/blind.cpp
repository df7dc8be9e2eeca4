// main() of a fuzzer where the compiler has no libFuzzer. NAME SECONDS CORPUS: all inputs that libFuzzer once found to
// reach new code, of a file with a line of hexadecimal digits for each, then random ones; or, of a folder of jobs,
// changed ones. The same inputs in every run, as many as the time allows; what an input that ends the process was, is
// left in the file that is named at the beginning.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/file_edits.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                                                     std::size_t most, unsigned seed);

namespace {

using Input = std::vector<std::uint8_t>;
constexpr std::size_t most_edits = 300, most_text = 20'000;

std::mt19937_64& random_bits() {
  static std::mt19937_64 generator(2021);
  return generator;
}

std::size_t below(std::size_t bound) { return random_bits()() % bound; }

Input contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Input(std::istreambuf_iterator<char>(file), {});
}

std::vector<Input> jobs_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Input> jobs;
  for (const auto& path : paths)
    if (Input input = contents(path); input.size() <= most_text) jobs.push_back(std::move(input));
  return jobs;
}

std::vector<Input> inputs_of(const std::filesystem::path& file) {
  std::vector<Input> inputs;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    Input& input = inputs.emplace_back(line.size() / 2);
    for (std::size_t k = 0; k < input.size(); ++k)
      input[k] = static_cast<std::uint8_t>(std::stoi(line.substr(2 * k, 2), nullptr, 16));
  }
  return inputs;
}

Input random_edits() {
  Input input(below(most_edits));
  std::generate(input.begin(), input.end(), [] { return static_cast<std::uint8_t>(below(256)); });
  return input;
}

Input changed(Input input) {
  const std::size_t size = input.size();
  input.resize(most_text);
  input.resize(LLVMFuzzerCustomMutator(input.data(), size, most_text, static_cast<unsigned>(random_bits()())));
  return input;
}

}  // namespace

/// What libFuzzer would do: here one byte is changed, taken away or doubled.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most) {
  if (size == 0) return 0;
  std::uint8_t* const at = data + below(size);
  std::uint8_t* const end = data + size;
  switch (below(3)) {
    case 0: *at = static_cast<std::uint8_t>(below(256)); return size;
    case 1: std::copy(at + 1, end, at); return size - 1;
    default:
      if (size == most) return size;
      std::copy_backward(at, end, end + 1);
      return size + 1;
  }
}

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: {} SECONDS CORPUS\n", argv[0]);
    return 2;
  }
  const std::chrono::duration<double> limit(std::stod(argv[1]));
  const bool of_jobs = std::filesystem::is_directory(argv[2]);
  const std::vector<Input> corpus = of_jobs ? jobs_of(argv[2]) : inputs_of(argv[2]);
  if (corpus.empty()) {
    fmt::print(stderr, "{}: no inputs in {}\n", argv[0], argv[2]);
    return 2;
  }
  const std::filesystem::path tried = rodsweep::fuzz::scratch_folder() / "input";
  fmt::print("every input is in {} while it is tried\n", tried.native());
  const auto try_one = [&tried](const Input& input) {
    std::ofstream(tried, std::ios::binary)
        .write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
    LLVMFuzzerTestOneInput(input.data(), input.size());
  };
  const auto begin = std::chrono::steady_clock::now();
  for (const Input& input : corpus) try_one(input);
  std::int64_t blind = 0;
  for (; std::chrono::steady_clock::now() - begin < limit; ++blind)
    try_one(of_jobs ? changed(corpus[below(corpus.size())]) : random_edits());
  fmt::print("{} inputs of the corpus and {} others, nothing found\n", corpus.size(), blind);
}
