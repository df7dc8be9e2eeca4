#include "runner/command/kept_hosts.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/terminal/child_process.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds time_to_answer{10};
constexpr std::chrono::milliseconds look_pause{20};

struct Asked {
  std::string line, host;
  std::unique_ptr<ChildProcess> question;
};

/// `ssh HOST true`, or with another agent, whose first word may be a path with options behind it.
std::vector<std::string> question_to(const std::string& host) {
  const char* agent = std::getenv("OMPI_MCA_plm_rsh_agent");
  std::istringstream words(agent != nullptr ? agent : "ssh -o BatchMode=yes -o ConnectTimeout=8");
  std::vector<std::string> question;
  for (std::string word; words >> word;) question.push_back(word);
  question.push_back(host);
  question.emplace_back("true");
  return question;
}

}  // namespace

fs::path answering_hosts(const fs::path& hosts, const fs::path& results, Console& console) {
  std::ifstream file(hosts);
  if (!file) throw FileError(fmt::format("{} cannot be read: --hosts wants a file with a host a line", hosts.native()));
  std::vector<Asked> asked;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string host;
    if (!(words >> host) || host[0] == '#') continue;
    asked.push_back({line, host, std::make_unique<ChildProcess>(question_to(host))});
  }
  const auto begin = Clock::now();
  const auto waits = [&] {
    bool any = false;
    for (const Asked& one : asked) any = one.question->runs() || any;
    return any;
  };
  while (waits() && Clock::now() - begin < time_to_answer) std::this_thread::sleep_for(look_pause);

  std::string answering;
  bool all = true;
  for (const Asked& one : asked) {
    if (one.question->runs())
      one.question->kill_group();
    else if (exit_code_of(one.question->status()) == 0) {
      answering += one.line + '\n';
      continue;
    }
    all = false;
    console.warn(fmt::format("{} does not answer: this start does without it", one.host));
  }
  if (all) return hosts;
  if (answering.empty()) {
    console.warn(fmt::format("none of the hosts of {} answers", hosts.native()));
    return {};
  }
  fs::path path = results;
  path += ".hosts";
  std::ofstream some(path);
  if (some << answering << std::flush) return path;
  console.warn(fmt::format("{} cannot be written, be the disk full", path.native()));
  return {};
}

}  // namespace rodsweep
