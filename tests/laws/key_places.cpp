#include "tests/laws/key_places.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "runner/keys/key.hpp"
#include "runner/measure/plan_check.hpp"
#include "runner/text/job_error.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep::laws {
namespace {

namespace fs = std::filesystem;

/// Within the bounds, and plausible.
Json example_number(const Key& key) {
  if (key.name == "segments") return 8;  // enough for a ring
  const double wanted = key.plausible && key.plausible->least > 0
                            ? std::sqrt(key.plausible->least * key.plausible->most)
                            : (key.kind == Key::Kind::integer ? 2 : 1);
  return number(std::clamp(wanted, key.low, key.high));
}

Json example(const Key& key, const std::string& tag);

/// An object with its required members. `tag`: the value of its own tag, or of that around it.
Json example_object(const Key& key, const std::string& tag) {
  Json object = Json::object();
  std::string group;
  for (const Key& child : key.keys) {
    if (!belongs(child, tag) || (child.name != key.tag && preset_of(child, tag))) continue;
    if (!child.alternative_group.empty() && child.alternative_group == group) continue;
    group = child.alternative_group;
    object[child.name] = child.name == key.tag ? Json(tag) : example(child, tag);
  }
  return object;
}

Json example(const Key& key, const std::string& tag) {
  switch (key.kind) {
    case Key::Kind::object: return example_object(key, key.tag.empty() ? tag : find_key(key.keys, key.tag)->choices[0]);
    case Key::Kind::integer:
    case Key::Kind::number: return example_number(key);
    case Key::Kind::boolean: return true;
    case Key::Kind::vector: return Json::array({0, 0, 0});
    case Key::Kind::text: return key.text == Key::Text::path ? inputs().of(key.file).front() : "x";
    case Key::Kind::choice: return key.choices.front();
    case Key::Kind::variant: return {{key.keys.front().name, example(key.keys.front(), tag)}};
    case Key::Kind::list: return Json::array({example(key.keys.front(), tag)});
    case Key::Kind::guess: return "previous";
    case Key::Kind::guesses: return Json::array({"zero", "previous"});
  }
  throw std::logic_error("a kind of key without an example");
}

/// Visits keys, each with what it needs around it.
class Walk {
 public:
  Walk(Json job, const std::function<void(const KeyPlace&)>& visit) : job_(std::move(job)), visit_(visit) {}

  /// The members of the object at `pointer`. `tag`: the value of its tag, or of that around it.
  void members(const Key& key, const std::string& pointer, const std::string& tag) {
    for (const Key& child : key.keys) {
      if (!belongs(child, tag) || (pointer == "/scene" && child.only_for.empty() && tag != "bending_rod")) continue;
      const Json before = job_;
      if (!child.alternative_group.empty()) {
        Json& object = pointer.empty() ? job_ : job_[Json::json_pointer(pointer)];
        for (const Key& other : key.keys)
          if (other.alternative_group == child.alternative_group) object.erase(other.name);
        object[child.name] = example(child, tag);
      }
      at(child, pointer + "/" + child.name, tag, child.name == key.tag);
      job_ = before;
    }
  }

  void at(const Key& key, const std::string& pointer, const std::string& tag, bool is_tag = false) {
    visit_({job_, pointer, key, sweepable_, is_tag});
    if (key.sweepable) sweepable_.push_back(pointer);
    const Json before = job_;
    inside(key, pointer, tag);
    job_ = before;
    if (key.sweepable) sweepable_.pop_back();
  }

 private:
  void inside(const Key& key, const std::string& pointer, const std::string& tag) {
    const Json::json_pointer here(pointer);
    const bool given = job_.contains(here);
    if (key.kind == Key::Kind::object) {
      std::vector<std::string> tags{tag};
      if (!key.tag.empty()) tags = find_key(key.keys, key.tag)->choices;
      if (given && job_[here].contains(key.tag)) tags = {job_[here][key.tag].get<std::string>()};
      for (const std::string& own : tags) {
        if (!given) job_[here] = example_object(key, own);
        members(key, pointer, own);
      }
    } else if (key.kind == Key::Kind::vector) {
      if (!given) job_[here] = key.preset.value_or(Json{0, 0, 0});
      at(component_key(key), pointer + "/1", tag);
    } else if (key.kind == Key::Kind::variant) {
      for (const Key& kind : key.keys) {
        job_[here] = {{kind.name, example(kind, tag)}};
        at(kind, pointer + "/" + kind.name, tag);
      }
    } else if (key.kind == Key::Kind::list) {
      if (!given) job_[here] = Json::array({item(key, tag)});
      at(key.keys.front(), pointer + "/0", tag);
    } else if (key.kind == Key::Kind::guesses && given && !job_[here].empty()) {
      for (const Key& guess : guess_keys()) {
        if (guess.name == "zero") continue;
        job_[here] = {"zero", {{guess.name, example_object(guess, "")}}};
        at_guess(guess, pointer + "/1");
      }
    }
  }

  /// Loads and motions at points that can have them, with times.
  Json item(const Key& list, const std::string& tag) const {
    Json item = example(list.keys.front(), tag);
    if (item.contains("at_m")) item["at_m"] = point_of_segment(list.name == "motions");
    if (find_key(list.keys.front().keys, "times_s")) item["times_s"] = item["factors"] = {0, 1};
    return item;
  }

  Json point_of_segment(bool is_held) const {
    const Rod rod = build_scene(Plan(read(job_)).spec(0).scene).rods.front();
    std::size_t s = 0;
    while (rod.segments.at(s).is_static != is_held) ++s;
    const Vector3& at = rod.position[s];
    return {at.x(), at.y(), at.z()};
  }

  void at_guess(const Key& guess, const std::string& pointer) {
    visit_({job_, pointer, guess_key("guess", "initial guess of cg"), sweepable_});
    sweepable_.push_back(pointer);
    members(guess, pointer + "/" + guess.name, "");
    sweepable_.pop_back();
  }

  Json job_;
  const std::function<void(const KeyPlace&)>& visit_;
  std::vector<std::string> sweepable_;
};

const Key& part(const char* name) { return *find_key(job_key().keys, name); }

Json sweep_of(Json scene, Json solve, Json guesses) {
  return {{"name", "law"},
          {"kind", "sweep"},
          {"scene", std::move(scene)},
          {"time", example_object(part("time"), "")},
          {"solve", std::move(solve)},
          {"guesses", std::move(guesses)}};
}

/// With contact, which obstacles need.
Json scene_of(const std::string& type) {
  Json scene = example_object(part("scene"), type);
  if (type == "knot") scene["segments"] = 32;
  scene["contact"] = Json::object();
  return scene;
}

/// Bending rods that are advanced by a method.
Json job_with(const std::string& method) {
  Json job = sweep_of(scene_of("bending_rod"), example_object(part("solve"), method), Json::array());
  job["solve"]["method"] = method;
  if (method == "cg") job["guesses"] = {"zero", "previous"};
  if (method != "cg" && method != "direct") job["evaluation"] = "closed_loop";
  if (job["solve"].contains("model"))
    for (const std::string& model : inputs().of(FileKind::model)) {
      job["solve"]["model"] = model;
      if (objection(job).empty()) break;
    }
  return job;
}

}  // namespace

Inputs::Inputs() {
  const auto copies = [&](FileKind kind, const std::vector<std::pair<fs::path, std::string>>& files) {
    for (const auto& [from, name] : files) {
      fs::create_directories((folder_ / name).parent_path());
      fs::copy_file(from, folder_ / name);
      names_[kind].push_back(name);
    }
  };
  const auto texts = [&](FileKind kind, const std::string& ending, const std::string& one, const std::string& other) {
    for (const auto& [name, text] : {std::pair("a file" + ending, one), std::pair("more/b" + ending, other)}) {
      fs::create_directories((folder_ / name).parent_path());
      std::ofstream(folder_ / name) << text;
      names_[kind].push_back(name);
    }
  };
  const fs::path models = PRETRAINED;
  copies(FileKind::model, {{models / "rods.h5", "a model.h5"},
                           {models / "lattices.h5", "more/b model.h5"},
                           {models / "bending-state.h5", "a state.h5"},
                           {models / "bending-state.h5", "more/b state.h5"}});
  copies(FileKind::plugin, {{PLUGIN_EXAMPLE, "a plug-in.so"}, {PLUGIN_EXAMPLE, "more/b.so"}});
  for (const char* name : {"a data set.h5", "more/b data set.h5"}) {
    make_data_set(folder_ / name, rodsweep::with("/time/steps", "2", data_job()));
    names_[FileKind::data_set].emplace_back(name);
  }
  for (const char* name : {"a start.h5", "more/b start.h5"}) {
    Json job = sweep_of(scene_of("bending_rod"), {{"method", "direct"}}, Json::array());
    job["scene"]["youngs_modulus_pa"] = {{"grid", {1e6, 2e6, 3e6, 4e6}}};
    job["record"] = {{"trajectory_every", 1}, {"states", true}};
    make_data_set(folder_ / name, job);
    names_[FileKind::results].emplace_back(name);
  }
  texts(FileKind::any, ".txt", "one", "two");
  texts(FileKind::skeleton, ".swc", "1 1 0 0 0 .1 -1\n2 1 0 1 0 .1 1\n3 1 0 2 0 .1 2\n",
        "1 1 0 0 0 .1 -1\n2 1 0 1 0 .1 1\n3 1 0 2 1 .1 2\n");
  texts(FileKind::curves, ".csv", "0 0 0\n1 0 0\n2 0 0\n", "0 0 0\n1 0 0\n2 1 0\n");
  const char* guess = "class Guess:\n    def __init__(self, rods, options): pass\n    def propose(self, system): ";
  texts(FileKind::python_guess, "guess.py", std::string(guess) + "return None\n",
        std::string(guess) + "return system.b\n");
  const char* preconditioner =
      "class Preconditioner:\n    def __init__(self, rods, options): pass\n"
      "    def set_up(self, system): return True\n    def apply(self, r): ";
  texts(FileKind::python_preconditioner, "preconditioner.py", std::string(preconditioner) + "return r\n",
        std::string(preconditioner) + "return 2 * r\n");
}

const Inputs& inputs() {
  static const Inputs files;
  return files;
}

std::string KeyPlace::path() const {
  std::string path;
  std::istringstream parts(pointer.substr(1));
  for (std::string part; std::getline(parts, part, '/');)
    path = std::isdigit(static_cast<unsigned char>(part[0])) ? element(path, std::stoul(part)) : member(path, part);
  return path;
}

Json KeyPlace::with(Json value) const {
  Json out = job;
  out[Json::json_pointer(pointer)] = std::move(value);
  return out;
}

std::map<std::string, Json> jobs_by_scene() {
  std::map<std::string, Json> jobs;
  for (const std::string& type : find_key(part("scene").keys, "type")->choices)
    jobs[type] = sweep_of(scene_of(type), {{"method", "cg"}}, {"zero", "previous"});
  return jobs;
}

void visit_keys(const std::function<void(const KeyPlace&)>& visit) {
  for (const auto& [type, job] : jobs_by_scene()) Walk(job, visit).at(part("scene"), "/scene", "sweep");
  const std::function<void(const KeyPlace&)> but_scene = [&](const KeyPlace& at) {
    if (at.pointer.rfind("/scene", 0) != 0) visit(at);
  };
  for (const Json& job : {data_job(), train_job(), job_with("cg")})
    Walk(job, but_scene).members(job_key(), "", job["kind"]);
  for (const std::string& method : find_key(part("solve").keys, "method")->choices)
    if (method != "cg") Walk(job_with(method), visit).at(part("solve"), "/solve", "sweep");
}

std::vector<Json> candidates(const Key& key) {
  std::vector<Json> values;
  if (key.preset) values.push_back(*key.preset);
  for (const std::string& word : key.choices) values.emplace_back(word);
  switch (key.kind) {
    case Key::Kind::integer:
    case Key::Kind::number: {
      const double some = example_number(key).get<double>();
      for (const double value : {0.0, some, key.kind == Key::Kind::integer ? some + 1 : 1.1 * some, key.low, key.high})
        if (std::isfinite(value) && value <= key.high && (key.above_low ? value > key.low : value >= key.low))
          values.push_back(number(value));
      break;
    }
    case Key::Kind::boolean: values.insert(values.end(), {true, false}); break;
    case Key::Kind::vector:
      for (const double x : {0.0, 0.01, 1.0}) values.push_back({x, 2 * x, -x});
      break;
    case Key::Kind::text:
      if (key.text == Key::Text::path)
        for (const std::string& file : inputs().of(key.file)) values.emplace_back(file);
      else
        values.insert(values.end(), {"x", "y"});
      break;
    case Key::Kind::list: values.push_back(Json::array()); break;
    case Key::Kind::guess: values.insert(values.end(), {"previous", "linear"}); break;
    default: break;
  }
  if (key.kind != Key::Kind::text) values.push_back(example(key, ""));
  return values;
}

Job read(const Json& job) { return parse_job(job.dump(), inputs().job()); }

std::string objection(const Json& values) {
  return message_of<JobError>([&] {
    const Job job = read(values);
    check_inputs(job);
    if (!is_training(job)) checked_plan(job);
  });
}

std::vector<Json> accepted(const KeyPlace& at, std::size_t count) {
  std::vector<Json> found;
  std::vector<Json> values = candidates(at.key);
  if (const Json::json_pointer here(at.pointer); at.job.contains(here)) {
    const Json& own = at.job[here];
    if (own.is_number_integer()) values.insert(values.begin(), own.get<std::int64_t>() + 1);
    values.insert(values.begin(), own);
  }
  for (const Json& value : values)
    if (found.size() < count && std::find(found.begin(), found.end(), value) == found.end() &&
        objection(at.with(value)).empty())
      found.push_back(value);
  return found;
}

}  // namespace rodsweep::laws
