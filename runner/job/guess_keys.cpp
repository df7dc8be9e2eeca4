#include "runner/job/guess_keys.hpp"

#include "runner/job/key_table.hpp"
#include "runner/job/sweep.hpp"

namespace rodsweep {
namespace {

using Guess = GuessSpec;

struct Kind {
  Guess::Kind kind;
  const char* name;
  const char* help;
  KeyTable<Guess> parameters;
};

KeyTable<Guess> subspace_keys() {
  KeyTable<Guess> table;
  table.optional(integer_key("size", "most solutions that span the subspace; each costs a product with A").from(1, 200),
                 &Guess::size);
  return table;
}

KeyTable<Guess> regression_keys() {
  KeyTable<Guess> table;
  table.optional(integer_key("size", "most systems to regress on").from(1, 200), &Guess::window);
  return table;
}

KeyTable<Guess> copingnet_keys() {
  KeyTable<Guess> table;
  table.required(file_key("model", "model file of a train job"), &Guess::model);
  table.optional(integer_key("corrections",
                             "models with factors: solves with them, each of what is left; every further one costs a "
                             "product with A")
                     .from(1, 100)
                     .labelled_if_changed(),
                 &Guess::corrections);
  table.optional(integer_key("lag_steps",
                             "models with factors: so many time steps a prediction of them serves; 0: the solve that "
                             "it was made for")
                     .from(0, 1000000)
                     .labelled_if_changed("lag"),
                 &Guess::factor_lag_steps);
  table.optional(
      number_key("stop_at", "models with factors: no correction once the residual is at most this, relative to ||b||")
          .from(0, 1)
          .labelled_if_changed("to"),
      &Guess::stop_at);
  return table;
}

KeyTable<Guess> knn_keys() {
  KeyTable<Guess> table;
  table.optional(integer_key("k", "how many").from(1, 1000).also_called({"neighbours"}), &Guess::neighbours);
  table.required(file_key("data", "data set: the file of a job of kind \"dataset\"").unlabelled(), &Guess::data);
  table.optional(integer_key("simulations", "the first so many simulations of the data set, or fewer; 0: all")
                     .from(0, 1000000)
                     .unlabelled(),
                 &Guess::simulations);
  table.optional(choice_key("inputs",
                            "what neighbours are alike in. all: shape, gaps of the joints and velocities; shape: what "
                            "the paper's network knows")
                     .labelled_if_changed(""),
                 Words<KnnInputs>{{"all", KnnInputs::all}, {"shape", KnnInputs::shape}}, &Guess::knn_inputs);
  return table;
}

KeyTable<Guess> oracle_keys() {
  using Error = OracleGuess::Error;
  KeyTable<Guess> table;
  table.optional(number_key("error", "A-norm of the error relative to the solution's").from(0, 1e6), &Guess::error);
  table.optional(choice_key("errors", "white: independent in every entry; smooth: of the modes that CG finds last"),
                 Words<Error>{{"white", Error::white}, {"smooth", Error::smooth}}, &Guess::error_kind);
  return table;
}

KeyTable<Guess> guarded_keys() {
  KeyTable<Guess> table;
  table.unbound(guess_key("guess", "the guess that is guarded"));
  table.required(number_key("threshold", "the guess is used where the natural norm of b - A x0 is below this times b's")
                     .above(0)
                     .at_most(1e6),
                 &Guess::threshold);
  return table;
}

KeyTable<Guess> totals_keys() {
  KeyTable<Guess> table;
  table.unbound(guess_key("guess", "the guess that hears of whole steps"));
  return table;
}

KeyTable<Guess> first_keys() {
  KeyTable<Guess> table;
  table.unbound(guess_key("guess", "the guess for first Newton iterations"));
  return table;
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds{
      {Guess::Kind::zero, "zero", "no guess: the denominator of every ratio", {}},
      {Guess::Kind::previous, "previous", "the solution of the same Newton iteration of the last step", {}},
      {Guess::Kind::linear, "linear", "linear extrapolation in time", {}},
      {Guess::Kind::quadratic, "quadratic", "quadratic extrapolation in time", {}},
      {Guess::Kind::fischer, "fischer",
       "best approximation within the last solutions, collected until there are `size`, then from one again",
       subspace_keys()},
      {Guess::Kind::subspace, "subspace", "best approximation within the last `size` solutions", subspace_keys()},
      {Guess::Kind::deflation, "deflation",
       "as subspace, and the last `size` solutions are projected out of all of CG's residuals too (deflated CG)",
       subspace_keys()},
      {Guess::Kind::regression, "regression",
       "the last `size` solutions combined as their right-hand sides make up today's: no product with A",
       regression_keys()},
      {Guess::Kind::copingnet, "copingnet",
       "a learned guess: a network's correction of the guess that it was trained with", copingnet_keys()},
      {Guess::Kind::knn, "knn",
       "the solutions of the most similar systems of a data set, resampled by arc length and averaged", knn_keys()},
      {Guess::Kind::oracle, "oracle", "the exact solution plus a random error", oracle_keys()},
      {Guess::Kind::guarded, "guarded", "another guess, used only where its residual is small", guarded_keys()},
      {Guess::Kind::totals, "totals",
       "another guess, that hears what a step's increments add up to in place of the first one: for closed loops",
       totals_keys()},
      {Guess::Kind::first, "first",
       "another guess at the first Newton iteration of a step, none at the others: for networks that learned of those "
       "alone",
       first_keys()},
  };
  return kinds;
}

Guess guess_spec(const Place& at) {
  const std::string& name = at.point.text(at.path);
  Guess guess;
  for (const Kind& kind : kinds()) {
    if (name != kind.name) continue;
    guess.kind = kind.kind;
    kind.parameters.fill(guess, at.of(name));
  }
  const Place within = at.of(name).of("guess");
  if (at.point.has(within.path)) {
    guess.inner.push_back(guess_spec(within));
    guess.inner.back().label = within.point.text(within.path);
  }
  return guess;
}

}  // namespace

const std::vector<Key>& guess_keys() {
  static const std::vector<Key> keys = [] {
    std::vector<Key> objects;
    for (const Kind& kind : kinds()) objects.push_back(object_key(kind.name, kind.help, kind.parameters.keys()));
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

std::vector<std::string> guess_labels(const Job& job) {
  std::vector<std::string> labels;
  for (const auto& guess : job.guesses()) labels.push_back(guess_label(guess));
  return labels;
}

std::vector<GuessSpec> guess_specs(const Point& point, const Job& job) {
  std::vector<GuessSpec> guesses;
  for (const std::string& label : guess_labels(job)) {
    guesses.push_back(guess_spec({point, job, element("guesses", guesses.size())}));
    guesses.back().label = label;
  }
  return guesses;
}

}  // namespace rodsweep
