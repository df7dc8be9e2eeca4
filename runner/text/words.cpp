#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({replace, d[i - 1][j] + 1, d[i][j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t longest = 64;  // bounds the table above
  if (word.empty() || word.size() > longest) return {};
  const std::string typed = lower_case(std::string(word));
  const std::size_t limit = std::max<std::size_t>(1, typed.size() / 3);
  std::string best, containing;
  std::size_t best_distance = limit + 1;
  for (const std::string& candidate : known) {
    const std::string target = lower_case(candidate);
    const std::size_t d = distance(typed, target);
    if (d < best_distance) {
      best_distance = d;
      best = candidate;
    }
    if (typed.size() >= 4 && target.find(typed) != std::string::npos && containing.empty()) containing = candidate;
  }
  return best.empty() ? containing : best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  const bool renamed = word == "pod" && std::find(known.begin(), known.end(), "subspace") != known.end();
  const std::string near = renamed ? "subspace" : nearest(word, known);
  return near.empty() ? "" : "; did you mean \"" + near + "\"?";
}

}  // namespace rodsweep
