// The initial guesses that jobs name, each a struct of its parameters. `name` is the guess in jobs.
//
// runner/specs/guess_keys.cpp binds the keys of jobs to the members, runner/measure/guesses.cpp makes the guess.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "network/guess/knn.hpp"
#include "solver/guess/oracle_guess.hpp"

namespace rodsweep {

/// A guess or a preconditioner of the user's in a job: a shared library (solver/plugin/plugin.h) or a file of Python
/// (runner/python/python_plugin.cpp).
struct PluginFile {
  std::filesystem::path library;
  std::string options;
};

struct PythonFile {
  std::filesystem::path file;
  std::string options;
  std::vector<std::filesystem::path> inputs{};  ///< other files that it reads
};

struct GuessSpec;

namespace guess {

struct Zero {
  static constexpr const char* name = "zero";
};

/// Through the last `terms` solutions.
struct Extrapolation {
  int terms;
};
struct Previous : Extrapolation {
  static constexpr const char* name = "previous";
  Previous() : Extrapolation{1} {}
};
struct Linear : Extrapolation {
  static constexpr const char* name = "linear";
  Linear() : Extrapolation{2} {}
};
struct Quadratic : Extrapolation {
  static constexpr const char* name = "quadratic";
  Quadratic() : Extrapolation{3} {}
};

struct Fischer {
  static constexpr const char* name = "fischer";
  int size = 10;  ///< of the subspace: solutions at most
};
struct Subspace {
  static constexpr const char* name = "subspace";
  int size = 10;
};
struct Deflation {
  static constexpr const char* name = "deflation";
  int size = 10;
};

struct Regression {
  static constexpr const char* name = "regression";
  int size = 6;  ///< systems at most
};

struct CopingNet {
  static constexpr const char* name = "copingnet";
  std::filesystem::path model;
  int corrections = 1;
  int lag_steps = 0;   ///< time steps that a prediction of factors serves; 0: one solve
  double stop_at = 0;  ///< no correction where ||r|| is at most this times ||b||
};

struct Knn {
  static constexpr const char* name = "knn";
  std::filesystem::path data;  ///< the data set
  int simulations = 0;         ///< of the data set, from the first; 0: all
  int neighbours = 3;
  KnnInputs inputs = KnnInputs::all;
};

struct Plugin : PluginFile {
  static constexpr const char* name = "plugin";
};
struct Python : PythonFile {
  static constexpr const char* name = "python";
};

struct Oracle {
  static constexpr const char* name = "oracle";
  double error = 0.1;  ///< A-norm of the error, relative to that of the solution
  OracleGuess::Error kind = OracleGuess::Error::white;
};

/// A guess that uses another one.
struct OfAnother {
  std::shared_ptr<const GuessSpec> guess;
};
struct Guarded : OfAnother {
  static constexpr const char* name = "guarded";
  double threshold = 1;  ///< of the natural norm of b - A x0, relative to that of b
};
struct Totals : OfAnother {
  static constexpr const char* name = "totals";
};
struct First : OfAnother {
  static constexpr const char* name = "first";
};
struct Ritz : OfAnother {
  static constexpr const char* name = "ritz";
  int size = 10;
  int collected = 20;  ///< residuals of a solve
  int lag_steps = 50;  ///< time steps that the same vectors serve; 0: one solve
};

}  // namespace guess

using GuessKind =
    std::variant<guess::Zero, guess::Previous, guess::Linear, guess::Quadratic, guess::Fischer, guess::Subspace,
                 guess::Deflation, guess::Regression, guess::CopingNet, guess::Knn, guess::Plugin, guess::Python,
                 guess::Oracle, guess::Guarded, guess::Totals, guess::First, guess::Ritz>;

struct GuessSpec {
  GuessKind kind;
  std::string label;  ///< in files and figures, unique within a job; of a guess that another one uses: empty
};

/// The guess that this one uses; null if it uses none.
inline const GuessSpec* used_by(const GuessSpec& spec) {
  return std::visit(
      [](const auto& kind) -> const GuessSpec* {
        if constexpr (std::is_base_of_v<guess::OfAnother, std::decay_t<decltype(kind)>>)
          return kind.guess.get();
        else
          return nullptr;
      },
      spec.kind);
}

/// The parameters of a guess of that kind, of the guess or of one that it uses; null if there are none.
template <class Kind>
const Kind* find_guess(const GuessSpec& spec) {
  for (const GuessSpec* at = &spec; at; at = used_by(*at))
    if (const auto* found = std::get_if<Kind>(&at->kind)) return found;
  return nullptr;
}

}  // namespace rodsweep
