#include "runner/inputs/skeleton_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <sstream>
#include <utility>

#include "runner/inputs/parsed_file.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

constexpr std::array<const char*, 7> columns{"id", "type", "x", "y", "z", "radius", "parent"};
constexpr int soma = 1;  // the type of a cell's body

struct Line {
  int number = 0;
  std::int64_t id = 0, type = 0, parent = 0;
  Vector3 position{0, 0, 0};
  double radius = 0;
  int above = -1;             ///< index of the parent's line; -1: a root
  std::vector<int> children;  ///< indices
};

class Reader {
 public:
  Reader(const std::string& text, const std::filesystem::path& file) : text_(text), file_(file) {}

  SkeletonFile read() {
    read_lines();
    link();
    for (int root = 0; root < static_cast<int>(lines_.size()); ++root)
      if (at(root).above < 0) drop_points_of_soma(root);
    const std::vector<int> order = parents_first();
    mend_radii(order);
    return trees(order);
  }

 private:
  /// A thing that is assumed, and the lines for which it is.
  struct Assumed {
    std::string what;
    int count = 0, first = 0;
  };

  Line& at(int index) { return lines_[static_cast<std::size_t>(index)]; }

  void read_lines() {
    std::istringstream in(with_line_feeds(text_));
    int number = 0;
    for (std::string line; std::getline(in, line);) {
      ++number;
      line.erase(std::min(line.find('#'), line.size()));
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream parts(line);
      std::vector<std::string> words;
      for (std::string word; parts >> word;) words.push_back(word);
      if (!words.empty()) add(words, number);
    }
    if (lines_.size() < 2) refuse(number, fmt::format("{} nodes; must be at least 2", lines_.size()));
  }

  void add(const std::vector<std::string>& words, int number) {
    if (words.size() < columns.size())
      refuse(number, fmt::format("{} values; must be the 7 of SWC: id type x y z radius parent", words.size()));
    if (words.size() > columns.size()) assume("columns after the 7 of SWC are ignored", number);
    Line line;
    line.number = number;
    line.id = integer(words, 0, number);
    line.type = integer(words, 1, number);
    for (int i = 0; i < 3; ++i) line.position[i] = real(words, 2 + static_cast<std::size_t>(i), number);
    line.radius = real(words, 5, number);
    line.parent = integer(words, 6, number);
    if (line.id < 0) refuse(number, fmt::format("id is {}; must be at least 0", line.id));
    if (line.radius < 0) refuse(number, fmt::format("radius is {}; must be at least 0", words[5]));
    const auto [other, is_new] = by_id_.emplace(line.id, static_cast<int>(lines_.size()));
    if (!is_new)
      refuse(number, fmt::format("id is {}, as in line {}; must be another", line.id, at(other->second).number));
    lines_.push_back(std::move(line));
  }

  void link() {
    for (int i = 0; i < static_cast<int>(lines_.size()); ++i) {
      Line& line = at(i);
      if (line.parent < 0) continue;
      const auto found = by_id_.find(line.parent);
      if (found == by_id_.end() || found->second == i)
        refuse(line.number, fmt::format("parent is {}; must be the id of another line, or -1 for a root", line.parent));
      line.above = found->second;
      at(line.above).children.push_back(i);
    }
  }

  /// Two ends of the soma's diameter, which are no branches.
  void drop_points_of_soma(int root) {
    std::vector<int> points;
    for (const int child : at(root).children)
      if (at(root).type == soma && at(child).type == soma && at(child).children.empty()) points.push_back(child);
    if (points.size() != 2) return;
    assume("a soma of three points is its centre", at(points.front()).number);
    for (const int point : points) dropped_.push_back(point);
    auto& children = at(root).children;
    children.erase(std::remove_if(children.begin(), children.end(),
                                  [&](int child) { return child == points[0] || child == points[1]; }),
                   children.end());
  }

  /// The order of the file, except that a node follows its parent.
  std::vector<int> parents_first() {
    std::vector<int> order;
    std::vector<bool> placed(lines_.size(), false);
    for (int i = 0; i < static_cast<int>(lines_.size()); ++i) {
      if (at(i).above >= 0 && !placed[static_cast<std::size_t>(at(i).above)]) continue;
      if (std::find(dropped_.begin(), dropped_.end(), i) != dropped_.end()) continue;
      std::vector<int> next{i};  // it, and the descendants above it in the file
      while (!next.empty()) {
        const int node = next.back();
        next.pop_back();
        order.push_back(node);
        placed[static_cast<std::size_t>(node)] = true;
        const auto& children = at(node).children;
        for (auto child = children.rbegin(); child != children.rend(); ++child)
          if (*child < i) next.push_back(*child);
      }
    }
    for (const Line& line : lines_) {
      const auto index = static_cast<std::size_t>(&line - lines_.data());
      if (placed[index] || std::find(dropped_.begin(), dropped_.end(), static_cast<int>(index)) != dropped_.end())
        continue;
      refuse(line.number,
             fmt::format("parent is {}, below which this node is: a loop; one of its nodes must have the parent -1",
                         line.parent));
    }
    return order;
  }

  void mend_radii(const std::vector<int>& order) {
    for (const int node : order) {
      Line& line = at(node);
      if (line.radius > 0) continue;
      if (line.above >= 0) {
        line.radius = at(line.above).radius;
      } else {
        for (const int child : line.children)
          if (line.radius == 0) line.radius = at(child).radius;
      }
      if (line.radius == 0) refuse(line.number, "radius is 0, as those around; must be positive");
      assume("a radius of 0 is that of the node below", line.number);
    }
  }

  SkeletonFile trees(const std::vector<int>& order) {
    SkeletonFile out;
    std::vector<int> tree(lines_.size()), node(lines_.size());
    for (const int i : order) {
      const auto k = static_cast<std::size_t>(i);
      const Line& line = at(i);
      if (line.above < 0) {
        tree[k] = static_cast<int>(out.trees.size());
        out.trees.push_back({{-1, line.position, line.radius}});
        roots_.push_back(line.number);
        continue;
      }
      const auto above = static_cast<std::size_t>(line.above);
      tree[k] = tree[above];
      Skeleton& own = out.trees[static_cast<std::size_t>(tree[k])];
      if (own[static_cast<std::size_t>(node[above])].position_m == line.position) {
        assume("a node at the place of its parent is left out", line.number);
        node[k] = node[above];
        continue;
      }
      node[k] = static_cast<int>(own.size());
      own.push_back({node[above], line.position, line.radius});
    }
    for (std::size_t t = 0; t < out.trees.size(); ++t)
      if (out.trees[t].size() < 2) assume("a root without branches is left out", roots_[t]);
    out.trees.erase(
        std::remove_if(out.trees.begin(), out.trees.end(), [](const Skeleton& one) { return one.size() < 2; }),
        out.trees.end());
    if (out.trees.empty()) refuse(lines_.back().number, "no node is away from its root; must be a tree");
    for (const Assumed& assumed : assumed_)
      out.warnings.push_back(assumed.count == 1 ? fmt::format("{}:{}: {}", file_.native(), assumed.first, assumed.what)
                                                : fmt::format("{}: {} (in {} lines; first: {})", file_.native(),
                                                              assumed.what, assumed.count, assumed.first));
    return out;
  }

  void assume(const std::string& what, int line) {
    const auto found =
        std::find_if(assumed_.begin(), assumed_.end(), [&](const Assumed& one) { return one.what == what; });
    if (found == assumed_.end())
      assumed_.push_back({what, 1, line});
    else
      ++found->count;
  }

  double real(const std::vector<std::string>& words, std::size_t column, int line,
              const char* bound = "a finite number") const {
    const auto value = number_in<double>(words[column]);
    if (!value || !std::isfinite(*value))
      refuse(line, fmt::format("{} is \"{}\"; must be {}", columns[column], shortened(words[column]), bound));
    return *value;
  }

  /// Also "1.0", which some tools write.
  std::int64_t integer(const std::vector<std::string>& words, std::size_t column, int line) const {
    constexpr double most_exact = 9007199254740992;  // 2^53
    if (const auto value = number_in<std::int64_t>(words[column])) return *value;
    const double number = real(words, column, line, "an integer");
    if (number != std::floor(number) || std::abs(number) > most_exact)
      refuse(line, fmt::format("{} is \"{}\"; must be an integer", columns[column], shortened(words[column])));
    return static_cast<std::int64_t>(number);
  }

  [[noreturn]] void refuse(int line, const std::string& text) const {
    throw SkeletonError("{}:{}: {}", file_.native(), line, text);
  }

  const std::string& text_;
  const std::filesystem::path& file_;
  std::vector<Line> lines_;
  std::map<std::int64_t, int> by_id_;
  std::vector<int> dropped_, roots_;
  std::vector<Assumed> assumed_;
};

}  // namespace

SkeletonFile parse_skeleton(const std::string& text, const std::filesystem::path& file) {
  return Reader(text, file).read();
}

const SkeletonFile& shared_skeleton(const std::filesystem::path& file, const std::string& hash) {
  return parsed_once<SkeletonError>(file, hash, parse_skeleton);
}

}  // namespace rodsweep
