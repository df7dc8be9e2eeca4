// Tables of keys with the members that they fill: the keys of a job for a type, and how to construct it from them.
//
//   KeyTable<WindParameters> table;
//   table.required(vector_key("mean_m_s", "mean velocity"), &WindParameters::mean_m_s);
//   table.optional(integer_key("seed", "which turbulence").at_least(0), &WindParameters::seed);
//
// The job reader, the schema and help texts use keys(); fill() reads a parameter point. The default of an optional key
// is its member's initial value, for each kind of Owner. The Words of an enumeration may be given between key and
// member; so may the table of a std::optional part, which is an object or the word for none. The first key of a part
// is always present; if the part is a variant, it is the tag.
// A member is anything that std::invoke() accepts with an Owner: a pointer to a member, or a function that returns a
// reference. Bugs in a table throw std::logic_error.
//
// If Owner is a std::variant, the object has a tag. The tag's value is the `name` of one of its structs. A key applies
// to the structs that have a member for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "runner/inputs/input_file.hpp"
#include "runner/keys/key.hpp"
#include "runner/keys/point.hpp"
#include "runner/text/job_error.hpp"
#include "runner/text/words.hpp"
#include "solver/numbers/types.hpp"

namespace rodsweep {

/// A key of a job at a parameter point, and its value there.
class KeyValue {
 public:
  KeyValue(const Point& point, const JobFiles& job, std::string path)
      : point_(point), job_(job), path_(std::move(path)), value_(point.find(path_)) {}

  const JobFiles& job() const { return job_; }
  const std::string& path() const { return path_; }
  KeyValue of(const std::string& name) const { return {point_, job_, member(path_, name)}; }
  KeyValue item(std::size_t index) const { return {point_, job_, element(path_, index)}; }

  bool is_given() const { return value_ != nullptr; }
  // These throw std::logic_error if the key has no value of this type.
  const Point::Value& value() const { return value_ != nullptr ? *value_ : point_.at(path_); }
  double number() const { return value().number[0]; }
  const std::string& text() const { return value().is_text() ? *value_->text : point_.text(path_); }

 private:
  const Point& point_;
  const JobFiles& job_;
  std::string path_;
  const Point::Value* value_;
};

// Reads the value of a key that is present. Overloads for other types are beside their tables.
inline void read_value(const KeyValue& at, double& value) { value = at.number(); }
inline void read_value(const KeyValue& at, bool& value) { value = at.number() != 0; }
inline void read_value(const KeyValue& at, int& value) { value = static_cast<int>(at.number()); }
inline void read_value(const KeyValue& at, std::int64_t& value) { value = static_cast<std::int64_t>(at.number()); }
inline void read_value(const KeyValue& at, std::uint64_t& value) { value = static_cast<std::uint64_t>(at.number()); }
inline void read_value(const KeyValue& at, Vector3& value) { value = Vector3::Map(at.value().number); }
inline void read_value(const KeyValue& at, std::string& value) { value = at.text(); }
inline void read_value(const KeyValue& at, std::filesystem::path& file) { file = at.job().files.at(at.text()).path; }
inline void read_value(const KeyValue& list, std::vector<std::filesystem::path>& files) {
  files.clear();
  for (std::size_t i = 0; list.item(i).is_given(); ++i) read_value(list.item(i), files.emplace_back());
}
inline void read_value(const KeyValue& at, std::optional<double>& value) {
  value.reset();
  if (!at.value().is_text()) value = at.number();
}

// A value as written in a job, for the default of `key`.
template <class Value, class = std::enable_if_t<std::is_arithmetic_v<Value>>>
nlohmann::ordered_json written(const Key&, Value value) {
  return number(static_cast<double>(value));
}
inline nlohmann::ordered_json written(const Key&, bool value) { return value; }
inline nlohmann::ordered_json written(const Key&, const std::string& value) { return value; }
inline nlohmann::ordered_json written(const Key& key, const Vector3& value) {
  return {written(key, value.x()), written(key, value.y()), written(key, value.z())};
}
template <class Value>
nlohmann::ordered_json written(const Key& key, const std::optional<Value>& value) {
  if (!value) return key.choices.front();
  if (key.kind != Key::Kind::object) throw std::logic_error(key.name + " has a default that is neither a word nor {}");
  return nlohmann::ordered_json::object();  // all defaults
}
template <class Item>
nlohmann::ordered_json written(const Key&, const std::vector<Item>&) {
  return nlohmann::ordered_json::array();  // default: none
}

/// The alternatives of an Owner.
template <class Owner>
struct KindsOf {
  static constexpr bool tagged = false;
  template <class F>
  static void each(const F& f) {
    f(Owner{});
  }
  template <class F>
  static void visit(const F& f, Owner& owner) {
    f(owner);
  }
};
template <class... Kind>
struct KindsOf<std::variant<Kind...>> {
  static constexpr bool tagged = true;
  template <class F>
  static void each(const F& f) {
    (f(Kind{}), ...);
  }
  template <class F>
  static void visit(const F& f, std::variant<Kind...>& owner) {
    std::visit(f, owner);
  }
};

/// The alternative of a variant with this name.
template <class Owner>
Owner kind_named(const std::string& name) {
  std::optional<Owner> owner;
  KindsOf<Owner>::each([&](const auto& kind) {
    if (name == kind.name) owner = kind;
  });
  if (!owner) throw std::logic_error("no kind is called " + name);
  return *owner;
}

/// The first of several members that the struct has.
template <class Kind, class First, class... More>
auto& member_of(Kind& kind, const First& first, const More&... more) {
  if constexpr (std::is_invocable_v<const First&, Kind&>)
    return std::invoke(first, kind);
  else
    return member_of(kind, more...);
}

template <class Owner>
class KeyTable {
 public:
  /// Adds a key without a member: it is read elsewhere.
  KeyTable& unbound(Key key) {
    keys_.push_back(std::move(key));
    return *this;
  }

  template <class... Binding>
  KeyTable& required(Key key, const Binding&... binding) {
    return add<false>(std::move(key), binding...);
  }
  template <class... Binding>
  KeyTable& optional(Key key, const Binding&... binding) {
    return add<true>(std::move(key), binding...);
  }

  const std::vector<Key>& keys() const { return keys_; }

  /// Sets members from the object at a place. Members without a value are unchanged.
  void fill(Owner& owner, const KeyValue& object) const {
    for (const auto& read : readers_) read(owner, object);
  }

 private:
  template <bool is_optional, class... Member>
  KeyTable& add(Key key, const Member&... member) {
    return bind<is_optional>(
        std::move(key), [](const Key& of, const auto& value) { return written(of, value); },
        [](const KeyValue& at, auto& value) { read_value(at, value); }, member...);
  }
  template <bool is_optional, class Value, class... Member>
  KeyTable& add(Key key, const Words<Value>& words, const Member&... member) {
    for (const auto& [word, value] : words) key.choices.emplace_back(word);
    return bind<is_optional>(
        std::move(key), [&words](const Key&, Value value) { return word_of(words, value); },
        [words](const KeyValue& at, Value& value) { value = value_of(words, at.text()); }, member...);
  }
  template <bool is_optional, class Part, class... Member>
  KeyTable& add(Key key, const KeyTable<Part>& part, const Member&... member) {
    key.keys = part.keys();
    return bind<is_optional>(
        std::move(key), [](const Key& of, const std::optional<Part>& value) { return written(of, value); },
        [part](const KeyValue& at, std::optional<Part>& value) {
          value.reset();
          const KeyValue first = at.of(part.keys().front().name);
          if (!first.is_given()) return;
          value.emplace();
          if constexpr (KindsOf<Part>::tagged) *value = kind_named<Part>(first.text());
          part.fill(*value, at);
        },
        member...);
  }

  template <bool is_optional, class Write, class Read, class... Member>
  KeyTable& bind(Key key, const Write& write, const Read& read, const Member&... member) {
    std::vector<std::string> having;
    bool all = true;
    KindsOf<Owner>::each([&]([[maybe_unused]] auto kind) {
      using Kind = decltype(kind);
      if constexpr ((std::is_invocable_v<const Member&, Kind&> || ...)) {
        if constexpr (KindsOf<Owner>::tagged) having.emplace_back(Kind::name);
        if constexpr (is_optional) {
          auto preset = write(key, member_of(kind, member...));
          if (!key.preset)
            key.preset = std::move(preset);
          else if constexpr (KindsOf<Owner>::tagged)
            if (*key.preset != preset) key.preset_for[Kind::name] = std::move(preset);
        }
      } else {
        all = false;
      }
    });
    if (!all) key.only_for = std::move(having);
    readers_.emplace_back([=, name = key.name](Owner& owner, const KeyValue& object) {
      const auto read_if_given = [&]([[maybe_unused]] auto& kind) {
        if constexpr ((std::is_invocable_v<const Member&, decltype(kind)> || ...))
          if (const KeyValue at = object.of(name); at.is_given()) read(at, member_of(kind, member...));
      };
      KindsOf<Owner>::visit(read_if_given, owner);
    });
    keys_.push_back(std::move(key));
    return *this;
  }

  std::vector<Key> keys_;
  std::vector<std::function<void(Owner&, const KeyValue& object)>> readers_;
};

}  // namespace rodsweep
