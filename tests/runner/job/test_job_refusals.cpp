#include <array>
#include <catch2/catch.hpp>

#include "tests/runner/job_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::StartsWith;

TEST_CASE("values of guesses that are of another kind are refused, whatever stands in them") {
  for (const char* guess :
       {R"({"subspace": {"size": {"gird": [5, 10]}}})", R"({"oracle": {"error": {"gird": [5, 10]}}})",
        R"({"copingnet": {"model": 5}})", R"({"copingnet": {"model": {"a": {}}}})",
        R"({"knn": {"data": "x.h5", "inputs": {"b": [1]}}})",
        R"({"guarded": {"guess": {"subspace": {"size": {"gird": [5]}}}, "threshold": 1}})",
        R"({"first": {"guess": {"oracle": {"error": [1]}}}})"}) {
    CAPTURE(guess);
    CHECK_THAT(refusal(with("/guesses", std::string(R"(["zero", )") + guess + "]")),
               Catch::StartsWith("job.json: guesses[1].") && Catch::Contains("is not allowed"));
  }
}

TEST_CASE("a value that its key does not take is refused with what is allowed") {
  CHECK(refusal(small_job()) == "");
  CHECK(refusal(with("/scene/segments", "0")) ==
        "job.json: scene.segments: 0 is not allowed; must be an integer from 1 to 1000000");
  CHECK(refusal(with("/scene/segments", "2.5")) ==
        "job.json: scene.segments: 2.5 is not allowed; must be an integer from 1 to 1000000");
  CHECK(refusal(with("/scene/segments", "\"ten\"")) ==
        "job.json: scene.segments: \"ten\" is not allowed; must be an integer from 1 to 1000000");
  CHECK(refusal(with("/scene/segments", "null")) ==
        "job.json: scene.segments: null is not allowed; must be an integer from 1 to 1000000");
  CHECK(refusal(with("/scene/length_m", "-1")) ==
        "job.json: scene.length_m: -1 is not allowed; must be a number above 0 and at most 1000000");
  CHECK(refusal(with("/scene/gravity_m_s2", "[0, 1]")) ==
        "job.json: scene.gravity_m_s2: [0,1] is not allowed; must be three numbers [x, y, z], each from -1000000 to "
        "1000000");
  CHECK(refusal(with("/scene/gravity_m_s2", "[0, 1, true]")) ==
        "job.json: scene.gravity_m_s2[2]: true is not allowed; must be a number from -1000000 to 1000000");
  CHECK(refusal(with("/scene/stretch_compliance_per_j", "\"rigid\"")) ==
        "job.json: scene.stretch_compliance_per_j: \"rigid\" is not allowed; must be a number from 0 to 1000000, or "
        "\"from_stretch\"");
  CHECK(refusal(with("/scene", "3")) == "job.json: scene: 3 is not allowed; must be an object {...}");
  CHECK(refusal(with("/seed", "-1")) ==
        "job.json: seed: -1 is not allowed; must be an integer from 0 to 9007199254740991");
  CHECK(refusal(with("/solve", R"({"tolerance": 0})")) ==
        "job.json: solve.tolerance: 0 is not allowed; must be a number above 0 and at most 1");
  CHECK(refusal_of_text("[1]") == "job.json: [1] is not allowed; must be an object {...}");
}

TEST_CASE("a mistyped choice is refused with the nearest one") {
  CHECK(
      refusal(with("/solve", R"({"preconditioner": "jacoby"})")) ==
      "job.json: solve.preconditioner: \"jacoby\" is not allowed; must be one of \"none\", \"jacobi\", "
      "\"point_block_jacobi\", \"icc\", \"block_icc\", \"cholesky\", \"lagged_cholesky\", \"condensed\"; did you mean "
      "\"jacobi\"?");
  CHECK(refusal(with("/evaluation", "\"pared\"")) ==
        "job.json: evaluation: \"pared\" is not allowed; must be one of \"paired\", \"closed_loop\"; did you mean "
        "\"paired\"?");
  CHECK(refusal(with("/kind", "\"swep\"")) ==
        "job.json: kind: \"swep\" is not allowed; must be one of \"sweep\", \"dataset\", \"train\"; did you mean "
        "\"sweep\"?");
}

TEST_CASE("a condensed system has no other norm and no multipliers to project") {
  Json job = with("/solve", R"({"preconditioner": "condensed", "norm": "natural"})");
  CHECK(refusal(job) ==
        "job.json: solve.norm: \"natural\" is not allowed with the preconditioner \"condensed\", whose unknowns are "
        "motions; must be \"true_residual\"");
  job["solve"].erase("norm");
  job["guesses"] = Json::parse(R"(["zero", "deflation"])");
  CHECK(refusal(job) ==
        "job.json: guesses[1]: \"deflation\" is not allowed with the preconditioner \"condensed\", whose unknowns are "
        "motions; must be another guess, such as \"subspace\"");
}

TEST_CASE("an unknown key is refused with the nearest known one, or with all of them") {
  CHECK_THAT(refusal(with("/scene/lenght_m", "1")),
             StartsWith("job.json: scene.lenght_m: unknown key; did you mean \"length_m\"?"));
  CHECK(refusal(with("/time/dt", "1")) == "job.json: time.dt: unknown key; did you mean \"step_s\"?");
  CHECK(refusal(with("/scene/N", "1")) == "job.json: scene.N: unknown key; did you mean \"segments\"?");
  CHECK(refusal(with("/time_limit", "1")) == "job.json: time_limit: unknown key; did you mean \"task_time_limit_s\"?");
  CHECK(refusal(with("/comment", "\"hello\"")) == "job.json: comment: unknown key; did you mean \"description\"?");
  CHECK(refusal(with("/record", R"({"xyzzy": 1})")) ==
        "job.json: record.xyzzy: unknown key; allowed here: \"solves\", \"norms\", \"trajectory_every\"");
  CHECK(refusal(with("/scene/windings", "1")) ==
        "job.json: scene.windings: this key belongs to scene.type \"helix\", not to \"bending_rod\"");
}

TEST_CASE("a missing key is refused with its meaning, unit and bounds") {
  CHECK(refusal(without("/scene/length_m")) ==
        "job.json: scene.length_m: missing: length of the rod; of a tree's trunk [m], a number above 0 and at most "
        "1000000");
  CHECK(refusal(without("/kind")) == "job.json: kind: missing: kind of job, one of \"sweep\", \"dataset\", \"train\"");
  CHECK(refusal(without("/time/steps")) ==
        "job.json: time: missing: the length of the run, exactly one of \"steps\", \"duration_s\"");
  CHECK(refusal(with("/time/duration_s", "1")) ==
        "job.json: time: \"steps\", \"duration_s\" exclude each other; give exactly one");
}

TEST_CASE("all mistakes of a job are reported at once, one per line") {
  Json job = with("/scene/segments", "0", without("/scene/radius_m"));
  job["bogus"] = 1;
  CHECK_THAT(
      refusal(job),
      StartsWith(
          "job.json: scene.segments: 0 is not allowed; must be an integer from 1 to 1000000\n"
          "job.json: scene.radius_m: missing: radius of the rod's cross-section; of a tree's trunk at the ground [m], "
          "a number above 0 and at most 1000\n"
          "job.json: bogus: unknown key; allowed here: \"name\", "));
}

TEST_CASE("a job's name must be usable as a file name") {
  const std::string wanted =
      " is not allowed; must be a file name of 1 to 100 letters, digits, \"_\", \"-\" or \".\", not beginning with "
      "\"-\" or "
      "\".\"";
  for (const char* name : {"\"a/b\"", "\"-x\"", "\"..\"", "\"\"", "\"a b\"", "\"a\\n\"", "7"}) {
    CHECK(refusal(with("/name", name)) == "job.json: name: " + std::string(name) + wanted);
  }
  CHECK(refusal(with("/name", "\"" + std::string(101, 'a') + "\"")) ==
        "job.json: name: \"" + std::string(59, 'a') + "..." + wanted);
  CHECK(refusal(with("/name", "\"N_10-v1.2\"")) == "");
}

TEST_CASE("text that is not JSON is refused with line, column and a caret under the place") {
  CHECK(refusal_of_text("{\n  \"a\": 1\n  \"b\": 2\n}") ==
        "job.json: line 2, column 9: a comma is missing here\n"
        "  \"a\": 1\n"
        "        ^");
  CHECK(refusal_of_text("{\"a\": 1,\n  \"b\": 2,\n}") ==
        "job.json: line 2, column 9: a comma after the last entry, which JSON does not have: remove it\n"
        "  \"b\": 2,\n"
        "        ^");
  CHECK(refusal_of_text("{\"a\": NaN}") ==
        "job.json: line 1, column 7: JSON has numbers only: no NaN, no infinity\n"
        "{\"a\": NaN}\n"
        "      ^");
  CHECK(refusal_of_text("{\"a\": 1\n\n") ==
        "job.json: line 1, column 8: the object before this is not closed: } is missing\n"
        "{\"a\": 1\n"
        "       ^");
  CHECK_THAT(refusal_of_text(""), StartsWith("job.json: line 1, column 1: syntax error while parsing value"));
  CHECK_THAT(refusal_of_text("{} {}"), StartsWith("job.json: line 1, column 4: syntax error while parsing value"));
  const auto said = [](const std::string& text) {
    const std::string whole = refusal_of_text(text);
    return whole.substr(10, whole.find('\n') - 10);
  };
  const std::string comment = "JSON has no comments: remove it, or put it into \"description\"";
  CHECK(said("// no\n{}") == "line 1, column 1: " + comment);
  CHECK(said("{\n  # no\n}") == "line 2, column 3: " + comment);
  CHECK(said("{\"a\": sweep}") == "line 1, column 7: texts and keys stand in double quotes");
  CHECK(said("{'a': 1}") == "line 1, column 2: texts and keys stand in double quotes");
  CHECK(said("{a: 1}") == "line 1, column 2: texts and keys stand in double quotes");
  CHECK(said("[True]") == "line 1, column 2: true is written in small letters");
  CHECK(said("[None]") == "line 1, column 2: null is JSON's word for none");
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
  CHECK(refusal(with("/scene/segments", "[20, 60]")) ==
        "job.json: scene.segments: [20,60] is not allowed; must be an integer from 1 to 1000000; to sweep over these "
        "values write {\"grid\": [20, 60]}, to draw from the range {\"integer\": [20, 60]}");
  CHECK(refusal(with("/scene/length_m", "[3, 2, 1]")) ==
        "job.json: scene.length_m: [3,2,1] is not allowed; must be a number above 0 and at most 1000000; to sweep over "
        "these values write {\"grid\": [3, 2, 1]}");
  CHECK(
      refusal(with("/scene/gravity_m_s2", "[[0, 0, 0], [0, 0, -9.81]]")) ==
      "job.json: scene.gravity_m_s2: [[0,0,0],[0,0,-9.81]] is not allowed; must be three numbers [x, y, z], each from "
      "-1000000 to 1000000; to sweep over these values write {\"grid\": [[0,0,0], [0,0,-9.81]]}");
  CHECK(refusal(with("/scene/clamp", R"(["wall", "free"])")) ==
        "job.json: scene.clamp: [\"wall\",\"free\"] is not allowed; must be one of \"segment\", \"wall\", \"free\"; to "
        "sweep over these values write {\"grid\": [\"wall\", \"free\"]}");
  CHECK(refusal(with("/samples", "[1, 2]")) ==
        "job.json: samples: [1,2] is not allowed; must be an integer from 1 to 1000000");
}

TEST_CASE("a guess with a bare value is answered with an example that is accepted") {
  const auto with_guess = [](const std::string& guess) { return with("/guesses", "[\"zero\", " + guess + "]"); };
  const std::string begin = " is not allowed; must be an object {...} with its parameters; for example ";
  for (const auto& [guess, place, example] : std::vector<std::array<const char*, 3>>{
           {R"({"subspace": 10})", "subspace: 10", R"({"subspace": {"size": 10}})"},
           {R"({"subspace": 2.5})", "subspace: 2.5", R"({"subspace": {"size": 10}})"},
           {R"({"oracle": 0.2})", "oracle: 0.2", R"({"oracle": {"error": 0.2}})"},
           {R"({"guarded": "linear"})", "guarded: \"linear\"",
            R"({"guarded": {"guess": "linear", "threshold": 1}})"}}) {
    CAPTURE(guess);
    CHECK(refusal(with_guess(guess)) == "job.json: guesses[1]." + std::string(place) + begin + example);
    CHECK(refusal(with_guess(example)) == "");
  }
  CHECK(refusal(with_guess(R"({"copingnet": "net.h5"})")) ==
        "job.json: guesses[1].copingnet: \"net.h5\"" + begin + R"({"copingnet": {"model": "net.h5"}})");
  CHECK(
      refusal(with_guess(R"({"linear": 3})")) ==
      "job.json: guesses[1].linear: 3 is not allowed; must be an object {...}; \"linear\" has no parameters: write it "
      "alone");
}

TEST_CASE("what a lenient JSON parser lets through is refused") {
  CHECK(refusal_of_text(R"({"scene": {"length_m": 1, "length_m": 2}})") ==
        "job.json: scene.length_m: this key is given more than once; remove all but one");
  CHECK(refusal_of_text(R"({"a": [[1], [2, {"b": 1, "b": 1}]]})") ==
        "job.json: a[1][1].b: this key is given more than once; remove all but one");
  CHECK(refusal_of_text(R"({"time": {"step_s": 1e999}})") == "job.json: time.step_s: 1e999 is too large for a number");
  CHECK_THAT(refusal_of_text(std::string(100000, '[')), Catch::Matchers::EndsWith("nested deeper than 64 levels"));
  CHECK(refusal_of_text(small_job().dump() + std::string(1, '\0') + "{}") ==
        "job.json: holds a zero byte, so it is not JSON text");
}

TEST_CASE("a file that cannot be read is refused with the reason") {
  CHECK_THROWS_WITH(read_job("no-such-job.json"), "no-such-job.json: cannot be read: No such file or directory");
  CHECK_THROWS_WITH(read_job("/"), "/: is a folder, not a job file");
  CHECK_THROWS_WITH(read_job("/dev/zero"), "/dev/zero: is a device, not a job file");
}

TEST_CASE("a sweep that its key does not take is refused") {
  CHECK(refusal(with("/scene/length_m", R"({"uniform": [0, 2]})")) ==
        "job.json: scene.length_m.uniform[0]: 0 is not allowed; must be a number above 0 and at most 1000000");
  CHECK(refusal(with("/scene/length_m", R"({"uniform": [1, 1e7]})")) ==
        "job.json: scene.length_m.uniform[1]: 10000000.0 is not allowed; must be a number above 0 and at most 1000000");
  CHECK(refusal(with("/scene/length_m", R"({"uniform": [3, 2]})")) ==
        "job.json: scene.length_m.uniform: [3,2] is not allowed; the first end must not be above the second");
  CHECK(refusal(with("/scene/length_m", R"({"uniform": [1, 2, 3]})")) ==
        "job.json: scene.length_m.uniform: [1,2,3] is not allowed; must be the two ends of a range [a, b]");
  CHECK(refusal(with("/scene/initial_angle_deg", R"({"log_uniform": [0, 2]})")) ==
        "job.json: scene.initial_angle_deg.log_uniform: [0,2] is not allowed; a log_uniform range must lie above 0");
  CHECK(refusal(with("/scene/length_m", R"({"uniform": [{"grid": [1]}, 2]})")) ==
        "job.json: scene.length_m.uniform[0]: {\"grid\":[1]} is not allowed; must be a number above 0 and at most "
        "1000000; a range's ends are not swept");
  CHECK(refusal(with("/scene/segments", R"({"uniform": [1, 2]})")) ==
        "job.json: scene.segments.uniform: uniform draws numbers that are not whole; use {\"integer\": [a, b]} here");
  CHECK(refusal(with("/scene/segments", R"({"integer": [2, 3.5]})")) ==
        "job.json: scene.segments.integer[1]: 3.5 is not allowed; must be an integer from 1 to 1000000");
  CHECK(refusal(with("/scene/clamp", R"({"uniform": [0, 2]})")) ==
        "job.json: scene.clamp.uniform: uniform draws a number, which is not allowed here; must be one of \"segment\", "
        "\"wall\", \"free\"");
  CHECK(refusal(with("/scene/segments", R"({"grid": [4, {"grid": [5, 0]}]})")) ==
        "job.json: scene.segments.grid[1].grid[1]: 0 is not allowed; must be an integer from 1 to 1000000");
  CHECK(refusal(with("/scene/segments", R"({"grid": []})")) ==
        "job.json: scene.segments.grid: [] is not allowed; must be a list of at least one value");
  CHECK(
      refusal(with("/scene/segments", R"({"grid": [4], "zip": [5]})")) ==
      "job.json: scene.segments: {\"grid\":[4],\"zip\":[5]} is not allowed; a sweep has no other key beside \"grid\"");
  CHECK(
      refusal(with("/scene/length_m", R"({"unifrom": [1, 2]})")) ==
      "job.json: scene.length_m: {\"unifrom\":[1,2]} is not allowed; must be a number above 0 and at most 1000000; did "
      "you mean \"uniform\"?");
  CHECK(refusal(with("/samples", R"({"grid": [1, 2]})")) == "job.json: samples: this key cannot be swept");
  CHECK(refusal(grid({small_job(), small_job()})) ==
        "job.json: this key cannot be swept; put the sweep in place of a value");
  CHECK(refusal(with("/guesses", R"({"grid": [["zero"], ["zero", "previous"]]})")) ==
        "job.json: guesses: this key cannot be swept; all tasks share one list of guesses; put every guess in it, "
        "or a sweep in place of a guess");
  CHECK(refusal(with("/scene/type", R"({"grid": ["bending_rod", "helix"]})")) ==
        "job.json: scene.type: this key cannot be swept; to sweep over scenes, list whole ones: \"scene\": {\"grid\": "
        "[{\"type\": \"bending_rod\", ...}, {\"type\": \"helix\", ...}]}");
  CHECK(refusal(with("/time/steps", R"({"zip": [1, 2]})", with("/scene/segments", R"({"zip": [4, 5, 6]})"))) ==
        "job.json: time.steps: this zip has 2 values and that of scene.segments has 3; all zips run in step, so they "
        "must "
        "be equally long");
}

TEST_CASE("samples of which all would be equal are refused") {
  const std::string text =
      "job.json: samples: 5 is not allowed, since there are grid points at which nothing is random and all samples "
      "would "
      "be equal; make a value random there, such as {\"uniform\": [a, b]}, or use 1";
  Json job = with("/samples", "5");
  CHECK(refusal(job) == text);
  CHECK(refusal(with("/scene/length_m", R"({"grid": [2, {"uniform": [1, 3]}]})", job)) == text);
  CHECK(refusal(with("/scene/length_m", R"({"grid": [{"uniform": [4, 5]}, {"uniform": [1, 3]}]})", job)) == "");
}

TEST_CASE("guesses that make no guess axis are refused") {
  const std::string needs_zero =
      "job.json: guesses: solve.method \"cg\" needs \"zero\" in this list, the denominator of every ratio; for example "
      "[\"zero\", \"previous\", \"quadratic\"]";
  CHECK(refusal(with("/guesses", R"(["previous"])")) == needs_zero);
  CHECK(refusal(without("/guesses")) == needs_zero);
  CHECK(refusal(with("/solve", R"({"method": {"grid": ["direct", "cg"]}})", without("/guesses"))) == needs_zero);
  CHECK(refusal(with("/solve", R"({"method": "direct"})")) ==
        "job.json: guesses: only solve.method \"cg\" uses initial guesses; remove this key");
  CHECK(refusal(with("/guesses", R"(["zero", "previous", "zero"])")) ==
        "job.json: guesses[2]: its label \"zero\" is also that of guesses[0]; give one of them a \"label\" of its own");
  CHECK(
      refusal(with("/guesses", R"(["zero", {"guarded": {"guess": "quadratic"}}])")) ==
      "job.json: guesses[1].guarded.threshold: missing: the guess is used where the natural norm of b - A x0 is below "
      "this times b's, a number above 0 and at most 1000000");
  CHECK(refusal(with("/guesses", R"(["zero", {"oracle": {"errr": 0.1}}])")) ==
        "job.json: guesses[1].oracle.errr: unknown key; did you mean \"error\"?");
  CHECK(refusal(with("/guesses", R"(["zero", {"zero": {"label": ""}}])")) ==
        "job.json: guesses[1].zero.label: \"\" is not allowed; must be a text of 1 to 60 characters on one line");
  CHECK(
      refusal(with("/guesses", R"(["zero", {"guarded": {"guess": {"previous": {"label": "x"}}, "threshold": 1}}])")) ==
      "job.json: guesses[1].guarded.guess.previous.label: unknown key; no keys are allowed here");
  CHECK(refusal(with("/guesses", R"([{"grid": ["zero", "previous"]}, "linear"])")) == needs_zero);
  CHECK(refusal(with("/guesses", R"(["zero", {"uniform": [0, 1]}])")).substr(0, 76) ==
        "job.json: guesses[1].uniform: uniform draws a number, which is not allowed h");
  CHECK(refusal(with("/guesses", R"(["zero", {"grid": ["previous", {"oracle": {"errr": 1}}]}])")) ==
        "job.json: guesses[1].grid[1].oracle.errr: unknown key; did you mean \"error\"?");
  CHECK(refusal(with("/guesses", R"(["zero", {"grid": ["linear"], "label": "zero"}])")) ==
        "job.json: guesses[1]: its label \"zero\" is also that of guesses[0]; give one of them a \"label\" of its own");
  CHECK(refusal(with("/guesses", R"(["zero", {"grid": ["linear"], "label": 3}])")) ==
        "job.json: guesses[1].label: 3 is not allowed; must be a text of 1 to 60 characters on one line");
  CHECK(refusal(with("/guesses", R"(["zero", {"grid": ["linear"], "error": 3}])")) ==
        "job.json: guesses[1]: {\"grid\":[\"linear\"],\"error\":3} is not allowed; a sweep has no other key beside "
        "\"grid\"");
  const std::string names =
      " is not allowed; must be one of \"zero\", \"previous\", \"linear\", \"quadratic\", \"fischer\", \"subspace\", "
      "\"deflation\", "
      "\"regression\", \"copingnet\", \"knn\", \"oracle\", \"guarded\", \"totals\", \"first\", or an object such as "
      "{\"oracle\": "
      "{\"error\": "
      "0.1}}";
  CHECK(refusal(with("/guesses", R"(["zero", "orcale"])")) ==
        "job.json: guesses[1]: \"orcale\"" + names + "; did you mean \"oracle\"?");
  CHECK(refusal(with("/guesses", R"(["zero", 3])")) == "job.json: guesses[1]: 3" + names);
  CHECK(refusal(with("/guesses", R"(["zero", {"oracle": {}, "label": "x"}])")) ==
        "job.json: guesses[1]: {\"oracle\":{},\"label\":\"x\"}" + names +
            "; the label stands within: {\"previous\": {\"label\": \"...\"}}");
}

TEST_CASE("values that do not fit together at a point are refused before anything runs") {
  const std::string nothing_jointed = ", since nothing is jointed; must be at least 2, or 1 with clamp \"wall\"";
  CHECK(refusal(with("/scene/segments", R"({"grid": [8, 1]})")) ==
        "job.json: scene.segments: 1 is not allowed with clamp \"segment\"" + nothing_jointed);
  CHECK(refusal(with("/scene/clamp", "\"free\"", with("/scene/segments", "1"))) ==
        "job.json: scene.segments: 1 is not allowed with clamp \"free\"" + nothing_jointed);
  CHECK(refusal(with("/scene/clamp", "\"wall\"", with("/scene/segments", "1"))) == "");

  const Json open_ended = without("/time/steps");
  CHECK(refusal(with("/time/duration_s", R"({"grid": [1, 0.05]})", open_ended)) ==
        "job.json: time.duration_s: 0.05 is not allowed with step_s 0.02: it is 2.5 steps; must be a whole number of "
        "them, such as 0.04, or give \"steps\" instead");
  CHECK(refusal(with("/time/duration_s", "0.001", open_ended)) ==
        "job.json: time.duration_s: 0.001 is not allowed with step_s 0.02: it is 0.05 steps; must be a whole number of "
        "them, such as 0.02, or give \"steps\" instead");
  CHECK(refusal(with("/time/duration_s", "1e9", open_ended)) ==
        "job.json: time.duration_s: 1000000000 is not allowed with step_s 0.02: it is 5e+10 steps, and 10000000 is the "
        "most");
}

TEST_CASE("forcing terms are refused where the direct solve advances the rod") {
  const Json job = with("/solve/forcing", "\"eisenstat_walker\"");
  CHECK(refusal(job) ==
        "job.json: solve.forcing: \"eisenstat_walker\" is not allowed with evaluation \"paired\", in which the "
        "reference advances the rod, whatever the tolerance of cg; must be with \"closed_loop\"");
  CHECK(refusal(with("/solve/forcing", R"({"grid": ["fixed", "eisenstat_walker"]})")) == refusal(job));
  CHECK(refusal(with("/evaluation", "\"closed_loop\"", job)) == "");
  CHECK(refusal(with("/solve/forcing", "\"fixed\"")) == "");
}

TEST_CASE("a job of too many tasks or rows is refused") {
  Json job = with("/scene/length_m", R"({"uniform": [1, 2]})");
  job["samples"] = 1000000;
  job["solve"] = {{"tolerance", {{"grid", {0.1, 0.01}}}}};
  CHECK(refusal(job) == "job.json: 2 grid points with 1000000 samples each are too many tasks; the most is 1000000");

  Json large = with("/scene/segments", "1000000", with("/time/steps", R"({"grid": [10000000, 9999999]})"));
  large["time"]["newton_iterations"] = 1000;
  large["record"] = {{"trajectory_every", 1}};
  CHECK_THAT(refusal(with("/scene/radius_m", R"({"grid": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]})",
                          with("/time/step_s", R"({"grid": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]})", large))),
             StartsWith("job.json: this job is too large: more than 1000000 tasks or 1000000000000000 rows"));
}
