#include <catch2/catch.hpp>

#include "tests/runner/refused_jobs.hpp"

using namespace rodsweep;
using Catch::Matchers::StartsWith;

namespace test_job_refusals {

Json guesses(const std::string& list) { return with("/guesses", list); }

/// The guesses "zero" and `guess`.
Json with_guess(const std::string& guess) { return guesses("[\"zero\", " + guess + "]"); }

TEST_CASE("a value that its key does not take is refused with what is allowed") {
  const std::string integer = "must be an integer from 1 to 1000000";
  check_refused({
      {with("/scene/segments", "0"), "scene.segments: 0 ", integer},
      {with("/scene/segments", "2.5"), "scene.segments: 2.5 ", integer},
      {with("/scene/segments", "\"ten\""), "scene.segments: \"ten\" ", integer},
      {with("/scene/segments", "null"), "scene.segments: null ", integer},
      {with("/scene/length_m", "-1"), "scene.length_m: -1 ", "must be a number above 0 and at most 1000000"},
      {with("/scene/gravity_m_s2", "[0, 1]"), "scene.gravity_m_s2: [0,1] ", "each from -1000000 to 1000000"},
      {with("/scene/gravity_m_s2", "[0, 1, true]"), "scene.gravity_m_s2[2]: true ", "from -1000000 to 1000000"},
      {with("/scene/stretch_compliance_per_j", "\"rigid\""), "scene.stretch_compliance_per_j: \"rigid\" ",
       "a number from 0 to 1000000, or \"from_stretch\""},
      {with("/scene", "3"), "scene: 3 ", "must be an object {...}"},
      {with("/seed", "-1"), "seed: -1 ", "must be an integer from 0 to 9007199254740991"},
      {with("/solve", R"({"tolerance": 0})"), "solve.tolerance: 0 ", "must be a number above 0 and at most 1"},
      {with("/$schema", "3"), "$schema: 3 ", "must be a string"},
      {Json::parse("[1]"), "[1] ", "must be an object {...}"},
      {with_guess(R"({"copingnet": {"model": 5}})"), "guesses[1].copingnet.model: 5 ", "must be the path of a file"},
      {with_guess(R"({"copingnet": {"model": {"a": {}}}})"), "guesses[1].copingnet.model: {\"a\":{}} ", "a file"},
      {with_guess(R"({"knn": {"data": "x.h5", "inputs": {"b": [1]}}})"), "guesses[1].knn.inputs: ", "not allowed"},
      {with_guess(R"({"oracle": {"error": {"gird": [5, 10]}}})"), "guesses[1].oracle.error: ", "\"grid\"?"},
      {with_guess(R"({"subspace": {"size": {"gird": [5, 10]}}})"), "guesses[1].subspace.size: ", "\"grid\"?"},
      {with_guess(R"({"guarded": {"guess": {"subspace": {"size": {"gird": [5]}}}, "threshold": 1}})"),
       "guesses[1].guarded.guess.subspace.size: ", "\"grid\"?"},
      {with_guess(R"({"guarded": {"threshold": 1, "guess": {"oracle": {"error": {}}}}})"),
       "guesses[1].guarded.guess.oracle.error: {} ", "not allowed"},
      {with_guess(R"({"first": {"guess": {"oracle": {"error": [1]}}}})"), "guesses[1].first.guess.oracle.error: [1] ",
       "not allowed"},
  });
  CHECK(refusal(small_job()) == "");
  CHECK(refusal(with("/$schema", "\"schema.json\"")) == "");
}

TEST_CASE("a mistyped choice is refused with the nearest one") {
  check_refused({
      {with("/solve", R"({"preconditioner": "jacoby"})"), "solve.preconditioner: \"jacoby\" ",
       "\"none\", \"jacobi\", \"point_block_jacobi\", \"icc\", \"block_icc\", \"cholesky\", \"lagged_cholesky\", "
       "\"condensed\"",
       "did you mean \"jacobi\"?"},
      {with("/evaluation", "\"pared\""), "evaluation: \"pared\" ", "\"paired\", \"closed_loop\"", "mean \"paired\"?"},
      {with("/kind", "\"swep\""), "kind: \"swep\" ", "\"sweep\", \"dataset\", \"train\"", "mean \"sweep\"?"},
  });
}

TEST_CASE("a condensed system has no other norm and no multipliers to project") {
  const Json condensed = with("/solve", R"({"preconditioner": "condensed"})");
  check_refused({
      {with("/solve/norm", "\"natural\"", condensed), "solve.norm: \"natural\" ", "\"condensed\"",
       "must be \"true_residual\""},
      {with("/guesses", R"(["zero", "deflation"])", condensed), "guesses[1]: \"deflation\" ", "\"condensed\"",
       "such as \"subspace\""},
      {with("/guesses", R"(["zero", {"totals": {"guess": {"ritz": {"guess": "previous"}}}}])", condensed),
       "guesses[1]: \"ritz\" ", "\"condensed\"", "such as \"subspace\""},
  });
}

TEST_CASE("an unknown key is refused with the nearest known one, or with all of them") {
  check_refused({
      {with("/scene/lenght_m", "1"), "scene.lenght_m: unknown key", "did you mean \"length_m\"?"},
      {with("/time/dt", "1"), "time.dt: unknown key", "did you mean \"step_s\"?"},
      {with("/scene/N", "1"), "scene.N: unknown key", "did you mean \"segments\"?"},
      {with("/time_limit", "1"), "time_limit: unknown key", "did you mean \"task_time_limit_s\"?"},
      {with("/comment", "\"hello\""), "comment: unknown key", "did you mean \"description\"?"},
      {with("/record", R"({"xyzzy": 1})"), "record.xyzzy: unknown key",
       "allowed here: \"solves\", \"norms\", \"trajectory_every\""},
      {with("/scene/windings", "1"), "scene.windings: ", "\"helix\", not to \"bending_rod\""},
  });
}

TEST_CASE("a missing key is refused with its meaning, unit and bounds") {
  check_refused({
      {without("/scene/length_m"), "scene.length_m: missing: length of the rod", "[m]", "above 0 and at most 1000000"},
      {without("/kind"), "kind: missing: kind of job", "one of \"sweep\", \"dataset\", \"train\""},
      {without("/time/steps"), "time: missing: ", "exactly one of \"steps\", \"duration_s\""},
      {with("/time/duration_s", "1"), "time: ", "\"steps\", \"duration_s\" exclude each other"},
  });
}

TEST_CASE("all mistakes of a job are reported at once, one per line") {
  Json job = with("/scene/segments", "0", without("/scene/radius_m"));
  job["bogus"] = 1;
  check_refused({{job, "scene.segments: 0 ", "\njob.json: scene.radius_m: missing", "\njob.json: bogus: unknown key"}});
}

TEST_CASE("a job's name must be usable as a file name") {
  const std::string wanted = "must be a file name of 1 to 100 letters, digits, \"_\", \"-\" or \".\"";
  for (const std::string name : {"\"a/b\"", "\"-x\"", "\"..\"", "\"\"", "\"a b\"", "\"a\\n\"", "7"})
    check_refused({{with("/name", name), "name: " + name, wanted}});
  check_refused(
      {{with("/name", "\"" + std::string(101, 'a') + "\""), "name: \"" + std::string(59, 'a') + "...", wanted}});
  CHECK(refusal(with("/name", "\"N_10-v1.2\"")) == "");
}

TEST_CASE("text that is not JSON is refused with line, column and a caret under the place") {
  CHECK(refusal_of_text("{\"a\": 1,\n  \"b\": 2,\n}") ==
        "job.json: line 2, column 9: JSON does not allow a comma after the last entry: remove it\n"
        "  \"b\": 2,\n"
        "        ^");
  CHECK_THAT(refusal_of_text(""), StartsWith("job.json: line 1, column 1: syntax error while parsing value"));
  CHECK_THAT(refusal_of_text("{} {}"), StartsWith("job.json: line 1, column 4: syntax error while parsing value"));
  const auto said = [](const std::string& text) {
    const std::string whole = refusal_of_text(text);
    return whole.substr(10, whole.find('\n') - 10);
  };
  CHECK(said("{\n  \"a\": 1\n  \"b\": 2\n}") == "line 2, column 9: a comma is missing here");
  CHECK(said("{\"a\": NaN}") == "line 1, column 7: JSON does not allow NaN or infinity");
  CHECK(said("{\"a\": 1\n\n") == "line 1, column 8: the object before this is not closed: } is missing");
  const std::string comment = "JSON does not allow comments: remove it, or put it into \"description\"";
  CHECK(said("// no\n{}") == "line 1, column 1: " + comment);
  CHECK(said("{\n  # no\n}") == "line 2, column 3: " + comment);
  CHECK(said("{\"a\": sweep}") == "line 1, column 7: strings and keys must be in double quotes");
  CHECK(said("{'a': 1}") == "line 1, column 2: strings and keys must be in double quotes");
  CHECK(said("{a: 1}") == "line 1, column 2: strings and keys must be in double quotes");
  CHECK(said("[True]") == "line 1, column 2: true must be in lower case");
  CHECK(said("[None]") == "line 1, column 2: use null instead of none");
  CHECK(said("{\"a\": [1, 2\n}") == "line 2, column 1: the list before this is not closed: ] is missing");
  CHECK(said("[{\"a\": 1]") == "line 1, column 9: the object before this is not closed: } is missing");
  CHECK(said("[1, 2") == "line 1, column 6: the list before this is not closed: ] is missing");
}

TEST_CASE("a missing comma is found before whatever stands in its place, also behind tabs and letters of two bytes") {
  const auto shown = [](const std::string& text) {
    const std::string said = refusal_of_text(text);
    return said.substr(said.find(": ", 10) + 2);
  };
  CHECK(shown("[1 2]") == "a comma is missing here\n[1 2]\n  ^");
  CHECK(shown("[1\n{\"a\": 1}]") == "a comma is missing here\n[1\n  ^");
  CHECK(shown("[true\tfalse]") == "a comma is missing here\n[true\tfalse]\n     ^");
  CHECK(shown("{\n\t\"\u00e4\": \"\u00f6\" \"c\": 2}") ==
        "a comma is missing here\n\t\"\u00e4\": \"\u00f6\" \"c\": 2}\n\t        ^");
  CHECK(shown("[\"" + std::string(200, 'a') + "\" 5]") ==
        "a comma is missing here\n" + std::string(59, 'a') + "\" 5]\n" + std::string(60, ' ') + "^");
}

TEST_CASE("a list where one value is wanted is answered with the sweep that was meant") {
  check_refused({
      {with("/scene/segments", "[20, 60]"), "scene.segments: [20,60] ", "an integer from 1 to 1000000",
       "{\"grid\": [20, 60]}, to draw from the range {\"integer\": [20, 60]}"},
      {with("/scene/length_m", "[3, 2, 1]"), "scene.length_m: [3,2,1] ", "above 0 and at most 1000000",
       "{\"grid\": [3, 2, 1]}"},
      {with("/scene/gravity_m_s2", "[[0, 0, 0], [0, 0, -9.81]]"), "scene.gravity_m_s2: [[0,0,0],[0,0,-9.81]] ",
       "each from -1000000 to 1000000", "{\"grid\": [[0,0,0], [0,0,-9.81]]}"},
      {with("/scene/clamp", R"(["wall", "free"])"), "scene.clamp: [\"wall\",\"free\"] ",
       "\"segment\", \"wall\", \"free\"", "{\"grid\": [\"wall\", \"free\"]}"},
  });
  CHECK(refusal(with("/samples", "[1, 2]")) ==
        "job.json: samples: [1,2] is not allowed; must be an integer from 1 to 1000000");
}

TEST_CASE("a guess with a bare value is answered with an example that is accepted") {
  struct Bare {
    std::string guess, place, example;
  };
  for (const Bare& bare : std::vector<Bare>{
           {R"({"subspace": 10})", "subspace: 10", R"({"subspace": {"size": 10}})"},
           {R"({"subspace": 2.5})", "subspace: 2.5", R"({"subspace": {"size": 10}})"},
           {R"({"oracle": 0.2})", "oracle: 0.2", R"({"oracle": {"error": 0.2}})"},
           {R"({"guarded": "linear"})", "guarded: \"linear\"", R"({"guarded": {"guess": "linear", "threshold": 1}})"},
       }) {
    check_refused({{with_guess(bare.guess), "guesses[1]." + bare.place, "for example " + bare.example}});
    CHECK(refusal(with_guess(bare.example)) == "");
  }
  check_refused({
      {with_guess(R"({"copingnet": "net.h5"})"), "guesses[1].copingnet: \"net.h5\" ",
       R"(for example {"copingnet": {"model": "net.h5"}})"},
      {with_guess(R"({"linear": 3})"), "guesses[1].linear: 3 ", "\"linear\" has no parameters"},
  });
}

TEST_CASE("what a lenient JSON parser lets through is refused") {
  CHECK(refusal_of_text(R"({"scene": {"length_m": 1, "length_m": 2}})") ==
        "job.json: scene.length_m: this key is given more than once; remove all but one");
  CHECK(refusal_of_text(R"({"a": [[1], [2, {"b": 1, "b": 1}]]})") ==
        "job.json: a[1][1].b: this key is given more than once; remove all but one");
  CHECK(refusal_of_text(R"({"time": {"step_s": 1e999}})") == "job.json: time.step_s: 1e999 is too large for a number");
  CHECK_THAT(refusal_of_text(std::string(100000, '[')), Catch::Matchers::EndsWith("nested deeper than 64 levels"));
  CHECK(refusal_of_text(small_job().dump() + std::string(1, '\0') + "{}") ==
        "job.json: holds a zero byte, so it is not JSON in UTF-8; save it as UTF-8");
}

TEST_CASE("a file that cannot be read is refused with the reason") {
  CHECK_THROWS_WITH(read_job("no-such-job.json"), "no-such-job.json: cannot be read: No such file or directory");
  CHECK_THROWS_WITH(read_job("/"), "/: is a folder, not a job file");
  CHECK_THROWS_WITH(read_job("/dev/zero"), "/dev/zero: is a device, not a job file");
}

TEST_CASE("a sweep that its key does not take is refused") {
  const std::string number = "must be a number above 0 and at most 1000000";
  const std::string integer = "must be an integer from 1 to 1000000";
  const auto length = [](const char* sweep) { return with("/scene/length_m", sweep); };
  const auto segments = [](const char* sweep) { return with("/scene/segments", sweep); };
  check_refused({
      {length(R"({"uniform": [0, 2]})"), "scene.length_m.uniform[0]: 0 ", number},
      {length(R"({"uniform": [1, 1e7]})"), "scene.length_m.uniform[1]: 10000000.0 ", number},
      {length(R"({"uniform": [3, 2]})"), "scene.length_m.uniform: [3,2] ", "must not be above the second"},
      {length(R"({"uniform": [1, 2, 3]})"), "scene.length_m.uniform: [1,2,3] ", "the two ends of a range [a, b]"},
      {length(R"({"uniform": [{"grid": [1]}, 2]})"), "scene.length_m.uniform[0]: {\"grid\":[1]} ", number,
       "the ends of a range cannot be swept"},
      {length(R"({"unifrom": [1, 2]})"), "scene.length_m: {\"unifrom\":[1,2]} ", number, "did you mean \"uniform\"?"},
      {with("/scene/initial_angle_deg", R"({"log_uniform": [0, 2]})"), "scene.initial_angle_deg.log_uniform: [0,2] ",
       "must lie above 0"},
      {segments(R"({"uniform": [1, 2]})"), "scene.segments.uniform: ", "fractional numbers",
       "use {\"integer\": [a, b]}"},
      {segments(R"({"integer": [2, 3.5]})"), "scene.segments.integer[1]: 3.5 ", integer},
      {segments(R"({"grid": [4, {"grid": [5, 0]}]})"), "scene.segments.grid[1].grid[1]: 0 ", integer},
      {segments(R"({"grid": []})"), "scene.segments.grid: [] ", "at least one value"},
      {segments(R"({"grid": [4], "zip": [5]})"), "scene.segments: {\"grid\":[4],\"zip\":[5]} ",
       "no key other than \"grid\""},
      {with("/scene/clamp", R"({"uniform": [0, 2]})"), "scene.clamp.uniform: uniform draws a number",
       "\"segment\", \"wall\", \"free\""},
      {with("/samples", R"({"grid": [1, 2]})"), "samples: this key cannot be swept"},
      {grid({small_job(), small_job()}), "grid: this key cannot be swept", "sweep a value instead"},
      {guesses(R"({"grid": [["zero"], ["zero", "previous"]]})"), "guesses: this key cannot be swept",
       "sweep one guess of the list"},
      {with("/scene/type", R"({"grid": ["bending_rod", "helix"]})"), "scene.type: this key cannot be swept",
       R"("scene": {"grid": [{"type": "bending_rod", ...}, {"type": "helix", ...}]})"},
      {with("/time/steps", R"({"zip": [1, 2]})", segments(R"({"zip": [4, 5, 6]})")),
       "time.steps: this zip has 2 values, but scene.segments has 3"},
  });
}

TEST_CASE("samples of which all would be equal are refused") {
  const Json job = with("/samples", "5");
  const Json partly = with("/scene/length_m", R"({"grid": [2, {"uniform": [1, 3]}]})", job);
  check_refused({
      {job, "samples: 5 ", "must be 1", "such as {\"uniform\": [a, b]}"},
      {partly, "samples: 5 ", "must be 1", "such as {\"uniform\": [a, b]}"},
  });
  CHECK(refusal(with("/scene/length_m", R"({"grid": [{"uniform": [4, 5]}, {"uniform": [1, 3]}]})", job)) == "");
}

TEST_CASE("guesses that make no guess axis are refused") {
  const std::string zero = "needs \"zero\" in this list", text = "must be a string of 1 to 60 characters on one line";
  const std::string names =
      "must be one of \"zero\", \"previous\", \"linear\", \"quadratic\", \"fischer\", \"subspace\", \"deflation\", "
      "\"regression\", \"copingnet\", \"knn\", \"plugin\", \"python\", \"oracle\", \"guarded\", \"totals\", \"first\", "
      "\"ritz\", "
      "or an object "
      "such as "
      "{\"oracle\": {\"error\": 0.1}}";
  check_refused({
      {guesses(R"(["previous"])"), "guesses: ", zero, "for example [\"zero\", \"previous\", \"quadratic\"]"},
      {without("/guesses"), "guesses: ", zero},
      {with("/solve", R"({"method": {"grid": ["direct", "cg"]}})", without("/guesses")), "guesses: ", zero},
      {guesses(R"([{"grid": ["zero", "previous"]}, "linear"])"), "guesses: ", zero},
      {with("/solve", R"({"method": "direct"})"), "guesses: only solve.method \"cg\"", "remove this key"},
      {guesses(R"(["zero", "previous", "zero"])"), "guesses[2]: its label \"zero\"", "guesses[0]"},
      {with_guess(R"({"grid": ["linear"], "label": "zero"})"), "guesses[1]: its label \"zero\"", "guesses[0]"},
      {with_guess(R"({"zero": {"label": ""}})"), "guesses[1].zero.label: \"\" ", text},
      {with_guess(R"({"grid": ["linear"], "label": 3})"), "guesses[1].label: 3 ", text},
      {with_guess(R"({"guarded": {"guess": {"previous": {"label": "x"}}, "threshold": 1}})"),
       "guesses[1].guarded.guess.previous.label: unknown key", "no keys are allowed here"},
      {with_guess(R"({"guarded": {"guess": "quadratic"}})"), "guesses[1].guarded.threshold: missing",
       "a number above 0 and at most 1000000"},
      {with_guess(R"({"oracle": {"errr": 0.1}})"), "guesses[1].oracle.errr: unknown key", "did you mean \"error\"?"},
      {with_guess(R"({"grid": ["previous", {"oracle": {"errr": 1}}]})"), "guesses[1].grid[1].oracle.errr: unknown key",
       "did you mean \"error\"?"},
      {with_guess(R"({"uniform": [0, 1]})"), "guesses[1].uniform: uniform draws a number", "not allowed here"},
      {with_guess(R"({"grid": ["linear"], "error": 3})"), "guesses[1]: {\"grid\":[\"linear\"],\"error\":3} ",
       "no key other than \"grid\""},
      {with_guess("\"orcale\""), "guesses[1]: \"orcale\" ", names, "did you mean \"oracle\"?"},
      {with_guess("3"), "guesses[1]: 3 ", names},
      {with_guess(R"({"oracle": {}, "label": "x"})"), "guesses[1]: {\"oracle\":{},\"label\":\"x\"} ", names,
       "put the label inside: {\"previous\": {\"label\": \"...\"}}"},
  });
}

TEST_CASE("values that do not fit together at a point are refused before anything runs") {
  const Json one = with("/scene/segments", "1");
  const std::string jointed = "must be at least 2, or 1 with clamp \"wall\"";
  const Json open_ended = without("/time/steps");
  check_refused({
      {with("/scene/segments", R"({"grid": [8, 1]})"), "scene.segments: 1 ", "clamp \"segment\"", jointed},
      {with("/scene/clamp", "\"free\"", one), "scene.segments: 1 ", "clamp \"free\"", jointed},
      {with("/time/duration_s", R"({"grid": [1, 0.05]})", open_ended), "time.duration_s: 0.05 ",
       "with step_s 0.02: it is 2.5 steps", "such as 0.04"},
      {with("/time/duration_s", "0.001", open_ended), "time.duration_s: 0.001 ", "it is 0.05 steps", "such as 0.02"},
      {with("/time/duration_s", "1e9", open_ended), "time.duration_s: 1000000000 ", "it is 5e+10 steps", "10000000"},
  });
  CHECK(refusal(with("/scene/clamp", "\"wall\"", one)) == "");
}

TEST_CASE("forcing terms are refused where the direct solve advances the rod") {
  const Json job = with("/solve/forcing", "\"eisenstat_walker\"");
  const Json swept = with("/solve/forcing", R"({"grid": ["fixed", "eisenstat_walker"]})");
  for (const Json& forced : {job, swept})
    check_refused({{forced, "solve.forcing: \"eisenstat_walker\" ", "evaluation \"paired\"", "with \"closed_loop\""}});
  CHECK(refusal(with("/evaluation", "\"closed_loop\"", job)) == "");
  CHECK(refusal(with("/solve/forcing", "\"fixed\"")) == "");
}

TEST_CASE("a job of too many tasks or rows is refused") {
  Json job = with("/scene/length_m", R"({"uniform": [1, 2]})");
  job["samples"] = 1000000;
  job["solve"] = {{"tolerance", {{"grid", {0.1, 0.01}}}}};
  Json large = with("/scene/segments", "1000000", with("/time/steps", R"({"grid": [10000000, 9999999]})"));
  large["time"]["newton_iterations"] = 1000;
  large["record"] = {{"trajectory_every", 1}};
  large["scene"]["radius_m"] = large["time"]["step_s"] = grid({1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
  check_refused({
      {job, "2 grid points with 1000000 samples each", "must be at most 1000000"},
      {large, "this job is too large", "more than 1000000 tasks or 1000000000000000 rows"},
  });
}

}  // namespace test_job_refusals
