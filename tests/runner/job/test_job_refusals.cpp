// Refused jobs: one table for what concerns several values or what a message advises. tests/laws/every_refusal.cpp has each
// key with values that its row does not allow, under wrong names, in other kinds of objects, and left out.

#include "runner/text/words.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;

namespace test_job_refusals {

/// A row has a job of `base_jobs()`, changes of it, and texts that its error message must contain: after the file, the key's
/// path and value; what is allowed; advice. A change is a JSON pointer and a value, which is removed without a value.
/// Indented lines continue a row.
constexpr const char* refused_jobs = R"table(
small: /scene/segments = 2.5 | scene.segments: 2.5 is not allowed; must be an integer from 1 to 1000000
small: /scene/gravity_m_s2 = [0, 1] | scene.gravity_m_s2: [0,1] | three numbers [x, y, z], each from -1000000 to 1000000
small: /scene/stretch_compliance_per_j = "rigid" | scene.stretch_compliance_per_j: "rigid"
  | a number from 0 to 1000000, or "from_stretch"
small: /name = "a/b" | name: "a/b" | must be a file name of 1 to 100 letters, digits, "_", "-" or "."
small: /solve = {"preconditioner": "jacoby"} | solve.preconditioner: "jacoby"
  | one of "none", "jacobi", "point_block_jacobi", "icc", "block_icc", "cholesky", "lagged_cholesky", "condensed"
small: /record = {"xyzzy": 1} | record.xyzzy: unknown key; allowed here: "solves", "norms", "trajectory_every", "states", "forces"
small: /scene/windings = 1 | scene.windings: this key belongs to scene.type "helix", not to "bending_rod"
small: /scene/length_m | scene.length_m: missing: length of the rod | [m] | above 0 and at most 1000000
small: /time/duration_s = 1 | time: "steps", "duration_s" exclude each other
small: /scene/segments = 0; /scene/radius_m; /bogus = 1 | scene.segments: 0
  | job.json: scene.radius_m: missing | job.json: bogus: unknown key
small: /scene/shear_modulus_pa = 2e5 | scene.shear_modulus_pa: "torsion_modulus_pa" and "shear_modulus_pa" are the same key

# guesses within guesses
small: /guesses/1 = {"guarded": {"guess": {"subspace": {"size": {"gird": [5]}}}, "threshold": 1}}
  | guesses[1].guarded.guess.subspace.size: | "grid"?
small: /guesses/1 = {"first": {"guess": {"oracle": {"error": [1]}}}} | guesses[1].first.guess.oracle.error: [1]
small: /guesses/1 = {"guarded": {"guess": {"previous": {"label": "x"}}, "threshold": 1}}
  | guesses[1].guarded.guess.previous.label: unknown key; no keys are allowed here
small: /guesses/1 = {"grid": ["previous", {"oracle": {"errr": 1}}]} | guesses[1].grid[1].oracle.errr: unknown key
  | did you mean "error"?

# a list where one value is wanted is answered with the sweep that was meant
small: /scene/segments = [20, 60] | scene.segments: [20,60] | {"grid": [20, 60]}, to draw from the range {"integer": [20, 60]}
small: /scene/length_m = [3, 2, 1] | scene.length_m: [3,2,1] | {"grid": [3, 2, 1]}
small: /scene/gravity_m_s2 = [[0, 0, 0], [0, 0, -9.81]] | scene.gravity_m_s2: [[0,0,0],[0,0,-9.81]]
  | {"grid": [[0,0,0], [0,0,-9.81]]}
small: /scene/clamp = ["wall", "free"] | scene.clamp: ["wall","free"] | {"grid": ["wall", "free"]}

# a guess with a bare value is answered with an example
small: /guesses/1 = {"subspace": 10} | guesses[1].subspace: 10 | for example {"subspace": {"size": 10}}
small: /guesses/1 = {"oracle": 0.2} | guesses[1].oracle: 0.2 | for example {"oracle": {"error": 0.2}}
small: /guesses/1 = {"guarded": "linear"} | guesses[1].guarded: "linear"
  | for example {"guarded": {"guess": "linear", "threshold": 1}}
small: /guesses/1 = {"copingnet": "net.h5"} | guesses[1].copingnet: "net.h5" | for example {"copingnet": {"model": "net.h5"}}
small: /guesses/1 = {"linear": 3} | guesses[1].linear: 3 | "linear" has no parameters

# sweeps
small: /scene/length_m = {"uniform": [3, 2]} | scene.length_m.uniform: [3,2] | must not be above the second
small: /scene/length_m = {"uniform": [{"grid": [1]}, 2]} | scene.length_m.uniform[0]: {"grid":[1]}
  | the ends of a range cannot be swept
small: /scene/length_m = {"unifrom": [1, 2]} | scene.length_m: {"unifrom":[1,2]} | did you mean "uniform"?
small: /scene/initial_angle_deg = {"log_uniform": [0, 2]} | scene.initial_angle_deg.log_uniform: [0,2] | must lie above 0
small: /scene/segments = {"integer": [2, 3.5]} | scene.segments.integer[1]: 3.5
small: /scene/segments = {"grid": [4, {"grid": [5, 0]}]} | scene.segments.grid[1].grid[1]: 0
small: /scene/shear_modulus_pa = {"grid": [2e5, -1]}; /scene/torsion_modulus_pa | scene.shear_modulus_pa.grid[1]: -1
small: /guesses = {"grid": [["zero"], ["zero", "previous"]]} | guesses: this key cannot be swept; | sweep one guess of the list
small: /scene/type = {"grid": ["bending_rod", "helix"]} | scene.type: this key cannot be swept
  | "scene": {"grid": [{"type": "bending_rod", ...}, {"type": "helix", ...}]}
small: /time/steps = {"zip": [1, 2]}; /scene/segments = {"zip": [4, 5, 6]}
  | time.steps: this zip has 2 values, but scene.segments has 3
train: /training/rate = {"grid": [0.1, 0.2]} | training.rate: this key cannot be swept; a job trains one model

# samples of which all would be equal
small: /samples = 5 | samples: 5 | must be 1 | such as {"uniform": [a, b]}
small: /samples = 5; /scene/length_m = {"grid": [2, {"uniform": [1, 3]}]} | samples: 5 | must be 1

# guesses that make no guess axis
small: /guesses = ["previous"] | guesses: | needs "zero" in this list | for example ["zero", "previous", "quadratic"]
small: /guesses | guesses: | needs "zero" in this list
small: /guesses; /solve = {"method": {"grid": ["direct", "cg"]}} | guesses: | needs "zero" in this list
small: /guesses = [{"grid": ["zero", "previous"]}, "linear"] | guesses: | needs "zero" in this list
small: /solve = {"method": "direct"} | guesses: only solve.method "cg" uses initial guesses | remove this key
small: /guesses = ["zero", "previous", "zero"] | guesses[2]: its label "zero" is also the label of guesses[0]
small: /guesses/1 = {"grid": ["linear"], "label": "zero"} | guesses[1]: its label "zero" is also the label of guesses[0]
small: /guesses/1 = {"zero": {"label": ""}} | guesses[1].zero.label: "" | a string of 1 to 60 characters on one line
small: /guesses/1 = {"grid": ["linear"], "label": 3} | guesses[1].label: 3 | a string of 1 to 60 characters on one line
small: /guesses/1 = {"grid": ["linear"], "error": 3} | guesses[1]: {"grid":["linear"],"error":3} | no key other than "grid"
small: /guesses/1 = "orcale" | guesses[1]: "orcale" is not allowed; must be one of "zero", "previous", "linear",
  | or an object such as {"oracle": {"error": 0.1}}; did you mean "oracle"?
small: /guesses/1 = {"oracle": {}, "label": "x"} | guesses[1]: {"oracle":{},"label":"x"}
  | put the label inside: {"previous": {"label": "..."}}

# values that do not fit together
condensed: /solve/norm = "natural" | solve.norm: "natural" | "condensed" | must be "true_residual"
condensed: /guesses/1 = "deflation" | guesses[1]: "deflation" | "condensed" | such as "subspace"
condensed: /guesses/1 = {"totals": {"guess": {"ritz": {"guess": "previous"}}}} | guesses[1]: "ritz" | "condensed"
small: /scene/segments = {"grid": [8, 1]} | scene.segments: 1 | clamp "segment" | must be at least 2, or 1 with clamp "wall"
small: /scene/segments = 1; /scene/clamp = "free" | scene.segments: 1 | clamp "free" | must be at least 2, or 1 with
small: /time/steps; /time/duration_s = {"grid": [1, 0.05]} | time.duration_s: 0.05 | with step_s 0.02: it is 2.5 steps
  | such as 0.04
small: /time/steps; /time/duration_s = 1e9 | time.duration_s: 1000000000 | it is 5e+10 steps | 10000000
small: /solve/forcing = "eisenstat_walker" | solve.forcing: "eisenstat_walker" | evaluation "paired" | with "closed_loop"
small: /solve/forcing = {"grid": ["fixed", "eisenstat_walker"]} | solve.forcing: "eisenstat_walker" | evaluation "paired"
small: /guesses; /solve = {"method": "pbd"} | solve.method: "pbd" | evaluation "paired" | must be used with "closed_loop"
small: /guesses; /solve = {"method": "xpbd"} | solve.method: "xpbd" | evaluation "paired" | must be used with "closed_loop"
closed: /solve = {"method": "pbd"}; /scene/internal_damping_s = 0.1 | scene.internal_damping_s: 0.1
  | solve.method "pbd" | must be 0
data: /scene/internal_damping_s = 0.1 | scene.internal_damping_s: 0.1 | kind "dataset" | must be 0
closed: /solve = {"method": {"grid": ["direct", "end_to_end"]}} | solve.model: missing
network: /guesses = ["zero"] | guesses: only solve.method "cg" uses initial guesses
network: /evaluation = "paired" | solve.method: "end_to_end" is not allowed | must be used with "closed_loop"

# scenes
small: /scene/stretch = "physical"; /scene/stretch_compliance_per_j = 1e-6 | scene: stretch is physical
  | stretch_compliance_per_j is given too | must be one of them
small: /scene/section = {"type": {"grid": ["tube"]}, "wall_m": 0.01} | scene.section.type | list complete ones
small: /scene/wind = "calm" | scene.wind: "calm" | an object {...}, or "none"
small: /scene/loads = [{"at_m": [1, 0, 0], "times_s": [0]}] | scene: loads[0]: times_s has 1 values, factors 0
small: /scene/motions = [{"at_m": [0, 0, 0], "displacement_m": [1, 0, 0]}] | scene: motions[0]: begins with the factor 1
small: /scene/obstacles = [{"half_space": {}}] | scene.obstacles: rods without "contact" pass through obstacles
  | "contact": {"friction": 0.3}, or remove this key
small: /scene/obstacles = {"grid": [[], [{"half_space": {}}]]} | scene.obstacles: rods without "contact"
small: /scene = {"grid": [{"type": "bending_rod", "segments": 4, "length_m": 2, "radius_m": 0.05, "density_kg_m3": 1000,
  "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6, "obstacles": [{"half_space": {}}]}]}
  | scene.grid[0].obstacles: rods without "contact" pass through obstacles
touching: /scene/obstacles = [{"half_space": {}, "ball": {}}] | scene.obstacles[0]: {"half_space":{},"ball":{}}
  | an object {...} with one of "half_space", "ball", "capsule"
touching: /scene/obstacles = [{"half_space": {"normal": [0, 0, 0]}}] | scene.obstacles[0].half_space.normal: [0, 0, 0]
  | must have a direction

# data sets and trainings
train: /data | data: missing: training data | a string of 1 to 4000 characters on one line, or a non-empty list of these
train: /data = ["a.h5", 5] | data[1]: 5 is not allowed
train: /training/shards = 5 | training.shards: 5 | a divisor of training.batch, 16
train: /network/encoding = "paper" | network.encoding: "paper" | with network.processor "factors"
train: /network/latent = 24 | network.latent: 24 is not allowed
train: /network = {"processor": "message_passing", "moves": true} | network.moves: true | with training.loss "energy"
  | use "mse" or remove this key
train: /training/noisy_copies = 2 | training.noisy_copies: 2 | network.encoding "linear_system" | must be used with "state"
state: /network/base = "subspace" | network.base: "subspace" | network.encoding "state" | must be "none"
state: /network/moves = false | network.moves: false
state: /training/loss = "energy" | training.loss: "energy"
state: /training/turned_copies = 1 | training.turned_copies: 1
state: /network = {"encoding": "state", "base": "none"} | network.processor: "factors"
)table";

std::map<std::string, Json> base_jobs() {
  Json train = train_job();
  train["network"] = train["training"] = Json::object();
  Json state = train;
  state["network"] =
      Json::parse(R"({"encoding": "state", "processor": "message_passing", "base": "none", "moves": true})");
  state["training"] = Json::parse(R"({"loss": "mse", "noisy_copies": 3, "noise": 0.2})");
  return {
      {"small", small_job()},
      {"condensed", with("/solve", R"({"preconditioner": "condensed"})")},
      {"closed",
       with("/evaluation", "\"closed_loop\"", with("/solve", R"({"method": "direct"})", without("/guesses")))},
      {"network",
       with("/evaluation", "\"closed_loop\"",
            with("/solve", R"({"method": "end_to_end", "model": ")" PRETRAINED R"(/rods.h5"})", without("/guesses")))},
      {"touching", with("/scene/contact", R"({"friction": 0.3})")},
      {"data", data_job()},
      {"train", train},
      {"state", state},
  };
}

std::vector<std::string> split(const std::string& text, const std::string& by) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t to; (to = text.find(by, from)) != std::string::npos; from = to + by.size())
    parts.push_back(text.substr(from, to - from));
  parts.push_back(text.substr(from));
  return parts;
}

Json changed(Json job, const std::string& changes) {
  for (const std::string& change : split(changes, "; ")) {
    const std::vector<std::string> parts = split(change, " = ");
    job = parts.size() > 1 ? with(parts[0], parts[1], job) : without(parts[0], job);
  }
  return job;
}

TEST_CASE("the jobs of the table are refused with file, path, value and what is allowed or advised") {
  const std::map<std::string, Json> bases = base_jobs();
  for (const auto& [name, job] : bases) {
    CAPTURE(name);
    CHECK(refusal(job) == "");
  }
  std::string rows = refused_jobs;
  for (std::size_t at; (at = rows.find("\n  ")) != std::string::npos;) rows.replace(at, 3, " ");
  for (const std::string& row : split(rows, "\n")) {
    if (row.empty() || row[0] == '#') continue;
    CAPTURE(row);
    const std::vector<std::string> parts = split(row, " | ");
    const std::size_t colon = parts[0].find(": ");
    const std::string said = refusal(changed(bases.at(row.substr(0, colon)), parts[0].substr(colon + 2)));
    CHECK_THAT(said, ContainsSubstring("job.json: " + parts.at(1)));
    for (const std::string& part : parts) CHECK((&part == &parts[0] || said.find(part) != std::string::npos));
  }
}

TEST_CASE("what is beside the refused jobs is accepted") {
  for (const char* changes :
       {R"(/$schema = "schema.json")", R"(/name = "N_10-v1.2")", R"(/guesses/1 = {"subspace": {"size": 10}})",
        R"(/guesses/1 = {"oracle": {"error": 0.2}})",
        R"(/guesses/1 = {"guarded": {"guess": "linear", "threshold": 1}})",
        R"(/samples = 5; /scene/length_m = {"grid": [{"uniform": [4, 5]}, {"uniform": [1, 3]}]})",
        R"(/scene/segments = 1; /scene/clamp = "wall")", R"(/solve/forcing = "fixed")",
        R"(/solve/forcing = "eisenstat_walker"; /evaluation = "closed_loop")", R"(/scene/obstacles = [])",
        R"(/scene/obstacles = {"grid": [[], {"zip": [[], []]}]})",
        R"(/scene/obstacles = [{"half_space": {}}]; /scene/contact = {"grid": ["none", {}]})"}) {
    CAPTURE(changes);
    CHECK(refusal(changed(small_job(), changes)) == "");
  }
  CHECK(refusal(with("/record", R"({"systems": "all"})", data_job())) == "");
}

TEST_CASE("text that is not JSON is refused with line, column, what to do and a caret under the place") {
  const std::string comment = "JSON does not allow comments: remove it, or put it into \"description\"";
  const std::string comma = "a comma is missing here";  // also behind tabs and letters of two bytes
  const std::pair<std::string, std::string> refused[] = {
      {"{\"a\": 1,\n  \"b\": 2,\n}",
       "line 2, column 9: JSON does not allow a comma after the last entry: remove it\n  \"b\": 2,\n        ^"},
      {"", "line 1, column 1: "},
      {"{} {}", "line 1, column 4: "},
      {"{\n  \"a\": 1\n  \"b\": 2\n}", "line 2, column 9: " + comma},
      {"[1 2]", "line 1, column 3: " + comma + "\n[1 2]\n  ^"},
      {"[1\n{\"a\": 1}]", "line 1, column 3: " + comma + "\n[1\n  ^"},
      {"[true\tfalse]", "line 1, column 6: " + comma + "\n[true\tfalse]\n     ^"},
      {"{\n\t\"\u00e4\": \"\u00f6\" \"c\": 2}", comma + "\n\t\"\u00e4\": \"\u00f6\" \"c\": 2}\n\t        ^"},
      {"[\"" + std::string(200, 'a') + "\" 5]",
       comma + "\n" + std::string(59, 'a') + "\" 5]\n" + std::string(60, ' ') + "^"},
      {"{\"a\": NaN}", "line 1, column 7: JSON does not allow NaN or infinity"},
      {"{\"a\": 1\n\n", "line 1, column 8: the object before this is not closed: } is missing"},
      {"// no\n{}", "line 1, column 1: " + comment},
      {"{\n  # no\n}", "line 2, column 3: " + comment},
      {"{\"a\": sweep}", "line 1, column 7: strings and keys must be in double quotes"},
      {"{'a': 1}", "line 1, column 2: strings and keys must be in double quotes"},
      {"{a: 1}", "line 1, column 2: strings and keys must be in double quotes"},
      {"[True]", "line 1, column 2: true must be in lower case"},
      {"[None]", "line 1, column 2: use null instead of none"},
      {"{\"a\": [1, 2\n}", "line 2, column 1: the list before this is not closed: ] is missing"},
      {"[{\"a\": 1]", "line 1, column 9: the object before this is not closed: } is missing"},
      {"[1, 2", "line 1, column 6: the list before this is not closed: ] is missing"},
  };
  for (const auto& [text, says] : refused)
    CHECK_THAT(refusal_of_text(text), StartsWith("job.json: ") && ContainsSubstring(says));
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

TEST_CASE("a job of too many tasks, or that is swept as a whole, is refused") {
  Json job = with("/scene/length_m", R"({"uniform": [1, 2]})");
  job["samples"] = 1000000;
  job["solve"] = {{"tolerance", {{"grid", {0.1, 0.01}}}}};
  CHECK_THAT(refusal(job), ContainsSubstring("2 grid points with 1000000 samples each") &&
                               ContainsSubstring("must be at most 1000000"));
  CHECK_THAT(refusal(grid({small_job(), small_job()})),
             ContainsSubstring("grid: this key cannot be swept; sweep a value instead"));
}

TEST_CASE("the nearest known word is found for small mistakes and none for large ones") {
  const std::vector<std::string> known{"length_m", "segments", "step_s", "gravity_m_s2", "zero"};
  CHECK(nearest("lenght_m", known) == "length_m");
  CHECK(nearest("Segment", known) == "segments");
  CHECK(nearest("steps", known) == "step_s");
  CHECK(nearest("gravity", known) == "gravity_m_s2");
  CHECK(nearest("zreo", known) == "zero");
  CHECK(nearest("temperature", known) == "");
  CHECK(nearest("", known) == "");
  CHECK(nearest(std::string(100000, 'x'), known) == "");
}

}  // namespace test_job_refusals
