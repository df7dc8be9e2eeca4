#include "runner/specs/solve_keys.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "runner/keys/key_table.hpp"
#include "runner/keys/sweep_words.hpp"
#include "runner/specs/plugin_keys.hpp"

namespace rodsweep {

static GuessKind read_guess(const KeyValue& at);

// Found by KeyTable among its overloads.
static void read_value(const KeyValue& at, std::shared_ptr<const GuessSpec>& guess) {
  guess = std::make_shared<const GuessSpec>(GuessSpec{read_guess(at), ""});
}

namespace {

/// The keys of Fischer, Subspace and Deflation.
template <class Guess>
KeyTable<Guess> subspace_keys() {
  return KeyTable<Guess>().optional(
      integer_key("size", "maximum dimension of the subspace; each dimension costs a product with A").from(1, 200),
      &Guess::size);
}

KeyTable<guess::Regression> regression_keys() {
  return KeyTable<guess::Regression>().optional(
      integer_key("size", "maximum number of systems in the regression").from(1, 200), &guess::Regression::size);
}

KeyTable<guess::CopingNet> copingnet_keys() {
  using guess::CopingNet;
  return KeyTable<CopingNet>()
      .required(file_key("model", FileKind::model, "model file of a train job"), &CopingNet::model)
      .optional(
          integer_key(
              "corrections",
              "models with factors: number of successive corrections; each after the first costs a product with A")
              .from(1, 100)
              .labelled_if_changed(),
          &CopingNet::corrections)
      .optional(
          integer_key("lag_steps",
                      "models with factors: number of time steps that use the same predicted factors; 0: one solve")
              .from(0, 1000000)
              .labelled_if_changed("lag"),
          &CopingNet::lag_steps)
      .optional(number_key("stop_at", "models with factors: corrections stop at this residual, relative to ||b||")
                    .from(0, 1)
                    .labelled_if_changed("to"),
                &CopingNet::stop_at);
}

KeyTable<guess::Knn> knn_keys() {
  using guess::Knn;
  return KeyTable<Knn>()
      .optional(integer_key("k", "number of neighbours").from(1, 1000).also_called({"neighbours"}), &Knn::neighbours)
      .required(file_key("data", FileKind::data_set, "data set: the file of a job of kind \"dataset\"").unlabelled(),
                &Knn::data)
      .optional(integer_key("simulations", "number of simulations of the data set to use, from the first; 0: all")
                    .from(0, 1000000)
                    .unlabelled(),
                &Knn::simulations)
      .optional(choice_key("inputs",
                           "features that define similarity. all: shape, joint gaps and velocities; shape: the inputs "
                           "of the paper's network")
                    .labelled_if_changed(""),
                Words<KnnInputs>{{"all", KnnInputs::all}, {"shape", KnnInputs::shape}}, &Knn::inputs);
}

KeyTable<guess::Oracle> oracle_keys() {
  using guess::Oracle;
  using Error = OracleGuess::Error;
  return KeyTable<Oracle>()
      .optional(number_key("error", "A-norm of the error, relative to that of the solution").from(0, 1e6),
                &Oracle::error)
      .optional(choice_key("errors", "white: independent in every entry; smooth: in the modes that CG finds last"),
                Words<Error>{{"white", Error::white}, {"smooth", Error::smooth}}, &Oracle::kind);
}

KeyTable<guess::Guarded> guarded_keys() {
  using guess::Guarded;
  return KeyTable<Guarded>()
      .required(guess_key("guess", "the guarded guess"), &Guarded::guess)
      .required(
          number_key("threshold", "the guess is used if the natural norm of b - A x0 is below this times that of b")
              .positive(1e6),
          &Guarded::threshold);
}

/// The keys of Totals and First.
template <class Guess>
KeyTable<Guess> keys_of_another(const char* help) {
  return KeyTable<Guess>().required(guess_key("guess", help), &Guess::guess);
}

KeyTable<guess::Ritz> ritz_keys() {
  using guess::Ritz;
  return KeyTable<Ritz>()
      .required(guess_key("guess", "the guess to which the part in the span of the Ritz vectors is added"),
                &Ritz::guess)
      .optional(integer_key("size", "number of Ritz vectors; each costs a product with A").from(1, 200), &Ritz::size)
      .optional(integer_key("collected", "residuals of a solve that the next Ritz vectors are combined from")
                    .from(1, 200)
                    .labelled_if_changed(),
                &Ritz::collected)
      .optional(integer_key("lag_steps", "time steps that use the same Ritz vectors; 0: one solve")
                    .from(0, 1000000)
                    .labelled_if_changed("lag"),
                &Ritz::lag_steps);
}

/// A kind of guess: its key with its parameters' keys, and how these are read.
struct Kind {
  Key key;
  std::function<GuessKind(const KeyValue& parameters)> read;
};

template <class Guess>
Kind kind(const char* help, const KeyTable<Guess>& table = {}) {
  return {object_key(Guess::name, help, table.keys()), [table](const KeyValue& parameters) {
            Guess guess;
            table.fill(guess, parameters);
            return GuessKind(guess);
          }};
}

/// In the order in which help texts and the schema list them.
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds{
      kind<guess::Zero>("no guess: the denominator of every ratio"),
      kind<guess::Previous>("the solution of the same Newton iteration in the last step"),
      kind<guess::Linear>("linear extrapolation in time"),
      kind<guess::Quadratic>("quadratic extrapolation in time"),
      kind<guess::Fischer>(
          "best approximation in the span of the last solutions; restarts with one solution after `size`",
          subspace_keys<guess::Fischer>()),
      kind<guess::Subspace>("best approximation in the span of the last `size` solutions",
                            subspace_keys<guess::Subspace>()),
      kind<guess::Deflation>(
          "as subspace; CG also projects the last `size` solutions out of all residuals (deflated CG)",
          subspace_keys<guess::Deflation>()),
      kind<guess::Regression>("combination of the last `size` solutions, with the coefficients that fit their "
                              "right-hand sides to b: no product with A",
                              regression_keys()),
      kind<guess::CopingNet>("learned guess: a network corrects the base guess that it was trained with",
                             copingnet_keys()),
      kind<guess::Knn>("the solutions of the most similar systems of a data set, resampled by arc length and averaged",
                       knn_keys()),
      kind<guess::Plugin>("a guess from a shared library of yours", plugin_keys<guess::Plugin>()),
      kind<guess::Python>("a guess from a Python file of yours", python_keys<guess::Python>(FileKind::python_guess)),
      kind<guess::Oracle>("the exact solution plus a random error", oracle_keys()),
      kind<guess::Guarded>("another guess, used only if its residual is small", guarded_keys()),
      kind<guess::Totals>("another guess; its history of first Newton iterations holds the sum of a step's increments "
                          "(for closed loops)",
                          keys_of_another<guess::Totals>("the guess that uses these sums")),
      kind<guess::First>("another guess at the first Newton iteration of a step, zero at the others: for networks "
                         "trained only on first iterations",
                         keys_of_another<guess::First>("the guess for first Newton iterations")),
      kind<guess::Ritz>("another guess; CG also projects the approximate eigenvectors that it would find last, "
                        "recycled from earlier solves, out of all residuals (deflated CG)",
                        ritz_keys()),
  };
  return kinds;
}

}  // namespace

static GuessKind read_guess(const KeyValue& at) {
  const std::string& name = at.text();
  const auto found =
      std::find_if(kinds().begin(), kinds().end(), [&](const Kind& kind) { return kind.key.name == name; });
  if (found == kinds().end()) throw std::logic_error("no guess is called " + name);
  return found->read(at.of(name));
}

const std::vector<Key>& guess_keys() {
  static const std::vector<Key> keys = [] {
    std::vector<Key> objects;
    for (const Kind& kind : kinds()) objects.push_back(kind.key);
    return objects;
  }();
  return keys;
}

const Key& guess_label_key() {
  static const Key key = text_key("label", "name of the guess in files and figures")
                             .at_most(60)
                             .of_form(Key::Text::line)
                             .unswept("a label names the same guess in all tasks");
  return key;
}

std::vector<std::string> guess_labels(const nlohmann::ordered_json& guesses) {
  std::vector<std::string> labels;
  for (const auto& guess : guesses) labels.push_back(guess_label(guess));
  return labels;
}

std::vector<GuessSpec> guess_specs(const Point& point, const std::vector<std::string>& labels, const JobFiles& job) {
  std::vector<GuessSpec> guesses;
  for (const std::string& label : labels)
    guesses.push_back({read_guess({point, job, element("guesses", guesses.size())}), label});
  return guesses;
}

}  // namespace rodsweep
