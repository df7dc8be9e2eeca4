#include "runner/job/skeleton_file.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "runner/text/shortened.hpp"

namespace rodsweep {
namespace {

constexpr std::array<const char*, 7> columns{"id", "type", "x", "y", "z", "radius", "parent"};

class Reader {
 public:
  Reader(const std::string& text, const std::filesystem::path& file) : in_(text), file_(file) {}

  Skeleton read() {
    std::string line;
    while (std::getline(in_, line)) {
      ++line_;
      const std::vector<std::string> words = words_of(line.substr(0, line.find('#')));
      if (words.empty()) continue;
      if (words.size() != columns.size())
        refuse(fmt::format("{} values; must be the 7 of SWC: id type x y z radius parent", words.size()));
      add(words);
    }
    if (skeleton_.size() < 2) refuse(fmt::format("{} nodes; must be at least 2", skeleton_.size()));
    if (const auto wrong = fault(skeleton_)) {
      line_ = lines_[static_cast<std::size_t>(wrong->node)];
      refuse(wrong->text);
    }
    return std::move(skeleton_);
  }

 private:
  static std::vector<std::string> words_of(const std::string& line) {
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    return words;
  }

  void add(const std::vector<std::string>& words) {
    const int id = number<int>(words, 0), parent = number<int>(words, 6);
    number<int>(words, 1);
    if (id < 0) refuse(fmt::format("id is {}; must be at least 0", id));
    if (const auto [other, is_new] = nodes_.emplace(id, static_cast<int>(skeleton_.size())); !is_new)
      refuse(
          fmt::format("id is {}, as in line {}; must be another", id, lines_[static_cast<std::size_t>(other->second)]));
    SkeletonNode node;
    if (!skeleton_.empty()) {
      const auto found = nodes_.find(parent);
      if (found == nodes_.end() || parent == id)
        refuse(fmt::format("parent is {}; must be the id of a line above, or -1 for the first node only", parent));
      node.parent = found->second;
    } else if (parent != -1) {
      refuse(fmt::format("parent is {}; must be -1 for the first node", parent));
    }
    for (int i = 0; i < 3; ++i) node.position_m[i] = number<double>(words, 2 + static_cast<std::size_t>(i));
    node.radius_m = number<double>(words, 5);
    skeleton_.push_back(node);
    lines_.push_back(line_);
  }

  template <class T>
  T number(const std::vector<std::string>& words, std::size_t column) const {
    const std::string& word = words[column];
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(static_cast<double>(value)))
      refuse(fmt::format("{} is \"{}\"; must be {}", columns[column], shortened(word),
                         std::is_integral_v<T> ? "an integer" : "a finite number"));
    return value;
  }

  [[noreturn]] void refuse(const std::string& text) const {
    throw SkeletonError(fmt::format("{}:{}: {}", file_.native(), line_, text));
  }

  std::istringstream in_;
  const std::filesystem::path& file_;
  int line_ = 0;
  Skeleton skeleton_;
  std::vector<int> lines_;    ///< of each node
  std::map<int, int> nodes_;  ///< by id
};

}  // namespace

Skeleton parse_skeleton(const std::string& text, const std::filesystem::path& file) {
  return Reader(text, file).read();
}

std::shared_ptr<const Skeleton> shared_skeleton(const std::filesystem::path& file, const std::string& hash) {
  static std::map<std::pair<std::filesystem::path, std::string>, std::shared_ptr<const Skeleton>> skeletons;
  std::shared_ptr<const Skeleton>& skeleton = skeletons[{file, hash}];
  if (skeleton) return skeleton;
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (in) text << in.rdbuf();
  if (!in) throw SkeletonError(file.native() + ": cannot be read");
  return skeleton = std::make_shared<const Skeleton>(parse_skeleton(text.str(), file));
}

}  // namespace rodsweep
