#include "scene/gltf_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "scene/gltf_schema_table.h"
#include "scene/printable.h"

namespace quintet::scene {
namespace {

using nlohmann::json;

// Where we are, as a chain on the stack: turned into a JSON pointer only for an error.
struct Place {
  const Place* parent = nullptr;
  std::string_view key{};
  std::size_t index = 0;

  std::string pointer() const {
    if (!parent) return {};
    std::string text = parent->pointer() + "/";
    if (key.data() == nullptr) return text + std::to_string(index);
    for (const char c : key) {
      if (c == '~')
        text += "~0";
      else if (c == '/')
        text += "~1";
      else
        text += c;
    }
    return text;
  }
  Place operator[](std::string_view name) const { return {this, name, 0}; }
  Place operator[](std::size_t i) const { return {this, {}, i}; }
};

class Checker {
 public:
  Checker(const std::filesystem::path& file, json& root) : file_(file), root_(root) {}

  json object(json& in, std::span<const Property> properties, const Place& place) const {
    if (!in.is_object()) fail(place, "must be an object");
    json out = json::object();
    for (const Property& property : properties) {
      const auto found = in.find(property.name);
      if (found != in.end()) {
        out[std::string(property.name)] = value(*found, property, place[property.name]);
      } else if (property.required) {
        fail(place, fmt::format("{} is missing", property.name));
      }
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const Place& place, std::string_view problem) const {
    throw FileError(file_, printable(place.pointer()), printable(problem));
  }

  json value(json& in, const Property& property, const Place& place) const {
    switch (property.kind) {
      case PropertyKind::boolean:
        if (!in.is_boolean()) fail(place, "must be true or false");
        return in;
      case PropertyKind::string: return string(in, property, place);
      case PropertyKind::integer: return integer(in, property, place);
      case PropertyKind::number: return number(in, property, place);
      case PropertyKind::numbers: return numbers(in, property, place);
      case PropertyKind::index: return index(in, property, place);
      case PropertyKind::object: return object(in, property.object, place);
      case PropertyKind::indexMap:
      case PropertyKind::integerMap: return map(in, property, place);
      case PropertyKind::strings:
      case PropertyKind::indices:
      case PropertyKind::indexMaps:
      case PropertyKind::objects: return array(in, property, place);
    }
    return {};
  }

  json string(json& in, const Property& property, const Place& place) const {
    if (!in.is_string()) fail(place, "must be a string");
    const auto& text = in.get_ref<const std::string&>();
    if (!property.choices.empty() && std::ranges::find(property.choices, text) == property.choices.end())
      fail(place, fmt::format("\"{}\" is none of {}", text.substr(0, 40), fmt::join(property.choices, ", ")));
    return std::move(in);
  }

  // 3.0 is accepted as 3: some exporters know only floating point.
  static bool isIntegral(const json& in) {
    if (!in.is_number_float()) return in.is_number_integer();
    const double d = in.get<double>();
    return std::abs(d) <= schema::kMaxBytes && d == std::floor(d);
  }

  json integer(const json& in, const Property& property, const Place& place) const {
    if (!isIntegral(in)) fail(place, "must be an integer");
    const double d = in.get<double>();
    if (!property.values.empty()) {
      if (std::ranges::none_of(property.values, [d](int v) { return v == d; }))
        fail(place, fmt::format("{} is none of {}", d, fmt::join(property.values, ", ")));
    } else if (d < property.low || d > property.high) {
      fail(place, fmt::format("{} is not in the range from {} to {}", d, property.low, property.high));
    }
    // tinygltf reads counts only from the unsigned kind of number.
    if (d >= 0) return static_cast<std::uint64_t>(d);
    return static_cast<std::int64_t>(d);
  }

  json number(const json& in, const Property& property, const Place& place) const {
    if (!in.is_number()) fail(place, "must be a number");
    const double d = in.get<double>();
    if (!std::isfinite(static_cast<float>(d))) fail(place, "the number is too large");
    if (d < property.low || d > property.high)
      fail(place, fmt::format("{} is not in the range from {} to {}", d, property.low, property.high));
    return d;
  }

  json numbers(const json& in, const Property& property, const Place& place) const {
    if (!in.is_array()) fail(place, "must be an array of numbers");
    if (in.size() < property.minCount || in.size() > property.maxCount)
      fail(place, fmt::format("must have {} numbers, not {}", property.minCount, in.size()));
    json out = json::array();
    for (std::size_t i = 0; i < in.size(); ++i) out.push_back(number(in[i], property, place[i]));
    return out;
  }

  json index(const json& in, const Property& property, const Place& place) const {
    if (!isIntegral(in)) fail(place, "must be an integer");
    const double d = in.get<double>();
    const std::size_t size = sizeOf(*property.target);
    if (d < 0 || d >= static_cast<double>(size))
      fail(place, fmt::format("{} {} does not exist: the file has {}", property.target->noun, d, size));
    return static_cast<std::uint64_t>(d);
  }

  json map(const json& in, const Property& property, const Place& place) const {
    if (!in.is_object()) fail(place, "must be an object");
    json out = json::object();
    for (const auto& [key, element] : in.items()) {
      const Place inside = place[std::string_view(key)];
      out[key] = property.target ? index(element, property, inside) : integer(element, property, inside);
    }
    return out;
  }

  json array(json& in, const Property& property, const Place& place) const {
    if (!in.is_array()) fail(place, "must be an array");
    json out = json::array();
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Place inside = place[i];
      switch (property.kind) {
        case PropertyKind::strings: out.push_back(string(in[i], property, inside)); break;
        case PropertyKind::indices: out.push_back(index(in[i], property, inside)); break;
        case PropertyKind::indexMaps: out.push_back(map(in[i], property, inside)); break;
        default: out.push_back(object(in[i], property.object, inside)); break;
      }
    }
    return out;
  }

  std::size_t sizeOf(const Collection& collection) const {
    const auto known = sizes_.find(&collection);
    if (known != sizes_.end()) return known->second;
    const json::json_pointer pointer(collection.pointer);
    const std::size_t size = root_.contains(pointer) && root_[pointer].is_array() ? root_[pointer].size() : 0;
    return sizes_[&collection] = size;
  }

  const std::filesystem::path& file_;
  json& root_;
  mutable std::map<const Collection*, std::size_t> sizes_;
};

}  // namespace

json checkSchema(const std::filesystem::path& file, json& root) {
  return Checker(file, root).object(root, schema::kRoot, Place{});
}

}  // namespace quintet::scene
