// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/message_schema.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/suggestion.h"

namespace quintet::job::interactive {
namespace {

using nlohmann::json;
using Schema = nlohmann::ordered_json;

constexpr std::int64_t kMaxIndex = std::int64_t{1} << 24;
constexpr std::int64_t kMaxWhole = std::int64_t{1} << 53;  // exact in JSON

const Schema kNothing = Schema::object();

// The member; an empty object if it is missing.
const Schema& memberOf(const Schema& object, const std::string& name) {
  const auto found = object.find(name);
  return found == object.end() ? kNothing : *found;
}

std::vector<std::string> keysOf(const Schema& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

// Each field becomes an object, and the ? of its type becomes "optional".
void completeFields(Schema& fields) {
  for (auto& [name, field] : fields.items()) {
    if (field.is_string()) field = Schema{{"type", field}};
    auto& type = field["type"].get_ref<std::string&>();
    if (!type.ends_with('?')) continue;
    type.pop_back();
    field["optional"] = true;
  }
}

// The kinds of values that types distinguish.
json::value_t kindOf(const json& value) { return value.is_number() ? json::value_t::number_float : value.type(); }

class MessageChecker {
 public:
  explicit MessageChecker(const Schema& types) : types_(types) {}

  // Adds the defaults. `owner`: what the messages of errors call the object; empty for a message.
  void checkFields(const Schema& fields, const Schema& description, const std::string& owner, json& object) const {
    const auto nameOf = [&](const std::string& key) { return fmt::format("'{}'{}", key, owner); };
    for (auto& [key, value] : object.items()) {  // first: a misspelled key explains why one is missing
      if (fields.contains(key)) continue;
      if (!description.contains("others"))
        throw UsageError(fmt::format("unknown key {}{}", nameOf(key), suggestionOrList(key, keysOf(fields))));
      check(nameOf(key), description["others"], kNothing, value);
    }
    for (const auto& [key, field] : fields.items()) {
      if (const auto value = object.find(key); value != object.end())
        check(nameOf(key), field["type"], field, *value);
      else if (field.contains("default"))
        object[key] = field["default"];
      else if (!field.contains("optional"))
        throw UsageError(nameOf(key) + " is missing");
    }
    if (!description.contains("together")) return;
    const std::string first = description["together"][0], second = description["together"][1];
    if (object.contains(first) != object.contains(second))
      throw UsageError(fmt::format("{} and {} require each other", nameOf(first), nameOf(second)));
  }

 private:
  void check(const std::string& name, const std::string& type, const Schema& field, json& value) const {
    const auto fail = [&] { throw UsageError(fmt::format("{} must be {}", name, textOf(type, field))); };
    const std::vector<std::string> all = alternativesOf(type);
    const auto one = std::ranges::find(all, kindOf(value), [&](const std::string& part) { return kindOfType(part); });
    if (one == all.end()) fail();
    if (value.is_array()) {
      const std::size_t bracket = one->rfind('[');
      const std::string size = one->substr(bracket + 1, one->size() - bracket - 2);
      if (!size.empty() && value.size() != std::stoul(size)) fail();
      for (std::size_t i = 0; i < value.size(); ++i)
        check(fmt::format("element {} of {}", i + 1, name), one->substr(0, bracket), field, value[i]);
    } else if (value.is_object()) {
      const Schema& described = memberOf(types_, *one);
      if (described.contains("fields")) checkFields(described["fields"], described, " of " + name, value);
      if (one->ends_with("{}"))
        for (auto& [key, member] : value.items())
          check(fmt::format("'{}' of {}", key, name), one->substr(0, one->size() - 2), field, member);
    } else if (value.is_number()) {
      const auto number = value.get<double>();
      if (*one == "number" && std::abs(number) > std::numeric_limits<float>::max())
        throw UsageError(name + " is out of range");
      if (!isInRange(*one, field, number)) fail();
    } else if (const Schema& values = memberOf(memberOf(types_, *one), "values"); !values.empty()) {
      const auto names = values.get<std::vector<std::string>>();
      if (const auto text = value.get<std::string>(); std::ranges::find(names, text) == names.end())
        throw UsageError(fmt::format("{} cannot be '{}'{}", name, text, suggestionOrList(text, names)));
    }
  }

  static bool isInRange(const std::string& type, const Schema& field, double number) {
    if (field.contains("above") && number <= field["above"].get<double>()) return false;
    if (field.contains("max") && number > field["max"].get<double>()) return false;
    if (type == "number") return true;
    const std::int64_t least = type == "count" ? 1 : 0, most = type == "whole" ? kMaxWhole : kMaxIndex;
    return number >= static_cast<double>(least) && number <= static_cast<double>(most) && number == std::floor(number);
  }

  // The parts between |, each without a name for other types.
  std::vector<std::string> alternativesOf(const std::string& type) const {
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin <= type.size();) {
      const std::size_t end = std::min(type.find('|', begin), type.size());
      const std::string part = type.substr(begin, end - begin);
      const Schema& is = memberOf(memberOf(types_, part), "is");
      if (is.is_string())
        std::ranges::copy(alternativesOf(is), std::back_inserter(all));
      else
        all.push_back(part);
      begin = end + 1;
    }
    return all;
  }

  // Of the values of a type.
  json::value_t kindOfType(const std::string& type) const {
    if (type.ends_with(']')) return json::value_t::array;
    if (type == "number" || type == "whole" || type == "index" || type == "count") return json::value_t::number_float;
    if (type == "flag") return json::value_t::boolean;
    if (type == "null") return json::value_t::null;
    return type == "text" || memberOf(types_, type).contains("values") ? json::value_t::string : json::value_t::object;
  }

  // "a number, true or false, or a text"
  std::string textOf(const std::string& type, const Schema& field) const {
    std::string text;
    const std::vector<std::string> all = alternativesOf(type);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i > 0) text += i + 1 < all.size() ? ", " : all.size() > 2 ? ", or " : " or ";
      text += textOfOne(all[i], field);
    }
    return text;
  }

  std::string textOfOne(const std::string& type, const Schema& field) const {
    switch (kindOfType(type)) {
      case json::value_t::array: {
        const std::size_t bracket = type.rfind('[');
        const std::string size = type.substr(bracket + 1, type.size() - bracket - 2);
        return type.starts_with("number[") ? fmt::format("a list of {}{}numbers", size, size.empty() ? "" : " ")
                                           : "a list";
      }
      case json::value_t::number_float: return type == "number" ? numberText(field) : wholeText(type, field);
      case json::value_t::boolean: return "true or false";
      case json::value_t::null: return "null";
      case json::value_t::string: return "a text";
      default: return "an object";
    }
  }
  static std::string wholeText(const std::string& type, const Schema& field) {
    const std::int64_t most = type == "whole" ? kMaxWhole : kMaxIndex;
    return fmt::format("a whole number from {} to {}", type == "count" ? 1 : 0, field.value("max", most));
  }
  static std::string numberText(const Schema& field) {
    std::string text = "a number";
    if (field.contains("above")) text += fmt::format(" above {:g}", field["above"].get<double>());
    if (field.contains("above") && field.contains("max")) text += " and";
    if (field.contains("max")) text += fmt::format(" of at most {:g}", field["max"].get<double>());
    return text;
  }

  const Schema& types_;
};

// `kind`: of the messages, for errors. `key`: the member with the name of the message.
void checkMessage(const Schema& content, const Schema& messages, const std::string& kind, const std::string& key,
                  json& message) {
  if (!message.is_object()) throw UsageError(fmt::format("the {} must be a JSON object", kind));
  if (!message.contains(key)) throw UsageError(fmt::format("'{}' is missing", key));
  if (!message[key].is_string()) throw UsageError(fmt::format("'{}' must be a text", key));
  const auto name = message[key].get<std::string>();
  const auto found = messages.find(name);
  if (found == messages.end())
    throw UsageError(fmt::format("unknown {} '{}'{}", kind, name, suggestionOrList(name, keysOf(messages))));
  Schema fields{{key, {{"type", "text"}}}};
  fields.update(memberOf(content, "common"));
  fields.update(memberOf(*found, "fields"));
  MessageChecker(content.at("types")).checkFields(fields, *found, "", message);
  const auto isRequired = [](const Schema& field) { return !field.contains("optional"); };
  const auto required = static_cast<std::size_t>(std::count_if(fields.begin(), fields.end(), isRequired));
  if (found->contains("atLeastOne") && message.size() == required)
    throw UsageError(fmt::format("no value of the {} is given", name));
}

}  // namespace

MessageSchema::MessageSchema(const std::vector<std::string_view>& files) {
  for (const char* section : {"types", "common", "commands", "events"}) content_[section] = Schema::object();
  for (const std::string_view file : files) {
    const Schema parsed = Schema::parse(file);
    for (const auto& [section, entries] : parsed.items())
      if (entries.is_object()) content_[section].update(entries);
  }
  for (const char* section : {"types", "commands", "events"})
    for (auto& entry : content_[section])
      if (entry.contains("fields")) completeFields(entry["fields"]);
  completeFields(content_["common"]);
}

json MessageSchema::readCommand(std::string_view text) const {
  try {
    return completeCommand(parseJson(text));
  } catch (const json::parse_error& error) {
    throw UsageError(fmt::format("byte {}: invalid JSON", error.byte));
  } catch (const json::out_of_range&) {
    throw UsageError("a number is out of range");
  }
}

json MessageSchema::completeCommand(json message) const {
  checkMessage(content_, content_.at("commands"), "command", "do", message);
  return message;
}

void MessageSchema::checkEvent(json event) const {
  checkMessage(content_, content_.at("events"), "event", "event", event);
}

}  // namespace quintet::job::interactive
