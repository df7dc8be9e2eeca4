#include "runner/job/obstacle_keys.hpp"

#include <string>
#include <tuple>

#include "runner/job/sweep.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

template <class Solid>
struct Kind {
  const char* name;
  const char* help;
  KeyTable<Solid> table;
};

Key place(const char* name, const char* help) { return vector_key(name, help).in("m").from(-1e6, 1e6); }
Key velocity() { return vector_key("velocity_m_s", "its velocity, from the start").in("m/s").from(-1e6, 1e6); }
Key radius() { return number_key("radius_m", "radius").in("m").above(0).at_most(1e6); }

KeyTable<HalfSpace> half_space_keys() {
  KeyTable<HalfSpace> table;
  table.optional(place("point_m", "a point of the plane"), &HalfSpace::point_m);
  table.optional(vector_key("normal", "direction out of the solid, of any length").from(-1e6, 1e6), &HalfSpace::normal);
  table.optional(velocity(), &HalfSpace::velocity_m_s);
  return table;
}

KeyTable<Ball> ball_keys() {
  KeyTable<Ball> table;
  table.required(place("centre_m", "its centre"), &Ball::centre_m);
  table.required(radius(), &Ball::radius_m);
  table.optional(velocity(), &Ball::velocity_m_s);
  return table;
}

KeyTable<Capsule> capsule_keys() {
  KeyTable<Capsule> table;
  table.required(place("from_m", "one end of the line"), &Capsule::from_m);
  table.required(place("to_m", "the other end"), &Capsule::to_m);
  table.required(radius(), &Capsule::radius_m);
  table.optional(velocity(), &Capsule::velocity_m_s);
  return table;
}

const auto& kinds() {
  static const std::tuple kinds{
      Kind<HalfSpace>{"half_space", "all that is below a plane", half_space_keys()},
      Kind<Ball>{"ball", "a ball", ball_keys()},
      Kind<Capsule>{"capsule", "all that is nearer than a radius to a line from one point to another", capsule_keys()}};
  return kinds;
}

template <class Solid>
void read_if(const Kind<Solid>& kind, const Place& at, Obstacle& obstacle) {
  if (at.point.text(at.path) != kind.name) return;
  Solid solid;
  kind.table.fill(solid, at.of(kind.name));
  obstacle = solid;
}

Obstacle obstacle(const Place& at) {
  Obstacle found;
  std::apply([&](const auto&... kind) { (read_if(kind, at, found), ...); }, kinds());
  if (const auto* space = std::get_if<HalfSpace>(&found); space && space->normal.isZero(0))
    throw job_error(at.job.path, at.path + ".half_space.normal", "[0, 0, 0] is not allowed; must have a direction");
  return found;
}

}  // namespace

Key obstacles_key() {
  const auto keys = [](const auto&... kind) {
    return std::vector<Key>{object_key(kind.name, kind.help, kind.table.keys())...};
  };
  return list_key("obstacles", "what rods with \"contact\" touch besides each other and the scene's own floor",
                  variant_key("obstacle", "a solid that rests or moves evenly", std::apply(keys, kinds())));
}

void read_value(const Place& list, std::vector<Obstacle>& obstacles) {
  obstacles.clear();
  while (true) {
    const Place item{list.point, list.job, element(list.path, obstacles.size())};
    if (!item.point.has(item.path)) return;
    obstacles.push_back(obstacle(item));
  }
}

void check_obstacles(const Json& scene, const std::string& path, const std::filesystem::path& file) {
  if (const std::string word = sweep_word(scene); !word.empty()) {
    for (std::size_t i = 0; i < scene[word].size(); ++i)
      check_obstacles(scene[word][i], element(member(path, word), i), file);
  } else if (scene["contact"] == "none" && !scene["obstacles"].empty()) {
    throw job_error(file, member(path, "obstacles"),
                    "rods pass through all obstacles without \"contact\"; give the scene \"contact\": "
                    "{\"friction\": 0.3}, or remove this key");
  }
}

}  // namespace rodsweep
