#include "runner/job/obstacle_keys.hpp"

#include <optional>
#include <string>

#include "runner/job/key_path.hpp"
#include "runner/job/sweep.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* list = "scene.obstacles";

Key place(const char* name, const char* help) { return vector_key(name, help).in("m").at_least(-1e6).at_most(1e6); }
Key radius() { return number_key("radius_m", "radius").in("m").above(0).at_most(1e6); }

Vector3 vector(const Point& point, const std::string& path) {
  const double* number = point.at(path).number;
  return {number[0], number[1], number[2]};
}

HalfSpace half_space(const Point& point, const Job& job, const std::string& path) {
  const HalfSpace space{vector(point, path + ".point_m"), vector(point, path + ".normal")};
  if (space.normal.isZero(0))
    throw job_error(job.path, path + ".normal", "[0, 0, 0] is not allowed; must have a direction");
  return space;
}

/// The obstacle at a place of the list, nothing behind its end.
std::optional<Obstacle> obstacle(const Point& point, const Job& job, const std::string& path) {
  const std::string space = path + ".half_space", ball = path + ".ball", capsule = path + ".capsule";
  if (point.has(space + ".normal")) return half_space(point, job, space);
  if (point.has(ball + ".radius_m")) return Ball{vector(point, ball + ".centre_m"), point.number(ball + ".radius_m")};
  if (point.has(capsule + ".radius_m"))
    return Capsule{vector(point, capsule + ".from_m"), vector(point, capsule + ".to_m"),
                   point.number(capsule + ".radius_m")};
  return std::nullopt;
}

}  // namespace

Key obstacles_key() {
  const Key obstacle =
      variant_key("obstacle", "a solid that rests",
                  {
                      object_key("half_space", "all that is below a plane",
                                 {
                                     place("point_m", "a point of the plane").defaults_to(Json::array({0, 0, 0})),
                                     vector_key("normal", "direction out of the solid, of any length")
                                         .at_least(-1e6)
                                         .at_most(1e6)
                                         .defaults_to(Json::array({0, 1, 0})),
                                 }),
                      object_key("ball", "a ball", {place("centre_m", "its centre"), radius()}),
                      object_key("capsule", "all that is nearer than a radius to a line from one point to another",
                                 {place("from_m", "one end of the line"), place("to_m", "the other end"), radius()}),
                  });
  return list_key("obstacles", "what rods with \"contact\" touch besides each other and the scene's own floor",
                  obstacle)
      .defaults_to(Json::array());
}

std::vector<Obstacle> obstacles(const Point& point, const Job& job) {
  std::vector<Obstacle> found;
  while (const auto next = obstacle(point, job, element(list, found.size()))) found.push_back(*next);
  return found;
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
