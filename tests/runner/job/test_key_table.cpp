// Keys and the members that they fill, in tables of a thing and of several.
#include <catch2/catch.hpp>

#include "runner/job/key_table.hpp"

namespace rodsweep {
namespace test_key_table {

struct Circle {
  static constexpr const char* name = "circle";
  double radius_m = 1.5;
  int count = 2;
};
struct Square {
  static constexpr const char* name = "square";
  double side_m = 1;
  int count = 2;
};
struct Crowd {
  static constexpr const char* name = "crowd";
  int count = 3;
};

TEST_CASE("a key belongs to the things that have its member, whose default is the key's") {
  KeyTable<std::variant<Circle, Square>> table;
  table.optional(number_key("radius_m", "radius"), &Circle::radius_m);
  table.optional(integer_key("count", "how many"), &Circle::count, &Square::count);
  table.required(number_key("side_m", "side"), [](auto& thing) -> decltype((thing.side_m)) { return thing.side_m; });
  const std::vector<Key>& keys = table.keys();
  CHECK(keys[0].only_for == std::vector<std::string>{"circle"});
  CHECK(keys[0].preset == 1.5);
  CHECK(keys[1].only_for.empty());
  CHECK(keys[1].preset->dump() == "2");
  CHECK(keys[2].only_for == std::vector<std::string>{"square"});
  CHECK_FALSE(keys[2].preset);
}

TEST_CASE("a thing whose member is another without the key has a default of its own") {
  KeyTable<std::variant<Circle, Crowd>> table;
  table.optional(integer_key("count", "how many"), &Circle::count, &Crowd::count);
  const Key& key = table.keys().front();
  CHECK(preset_of(key, "circle")->dump() == "2");
  CHECK(preset_of(key, "crowd")->dump() == "3");
}

}  // namespace test_key_table
}  // namespace rodsweep
