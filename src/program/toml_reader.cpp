#include "program/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "program/parameter.h"

namespace quintet::program {

TomlReader::TomlReader(const toml::table& table, std::string what, const std::string& file)
    : table_(table), what_(std::move(what)), file_(file) {}

int TomlReader::line(const toml::node* node) const {
  return static_cast<int>(std::max<std::uint32_t>(1, (node ? node->source() : table_.source()).begin.line));
}

void TomlReader::fail(const toml::node* node, const std::string& problem) const {
  throw FileError(file_, fmt::format("line {}", line(node)), problem);
}

const toml::node* TomlReader::find(const std::string& key) {
  known_.insert(key);
  return table_.get(key);
}

const toml::node& TomlReader::need(const std::string& key) {
  const toml::node* node = find(key);
  if (!node) fail(nullptr, fmt::format("{} needs '{}'", what_, key));
  return *node;
}

std::string TomlReader::text(const std::string& key) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (!node->is_string()) fail(node, fmt::format("'{}' of {} must be a string", key, what_));
  return **node->as_string();
}

std::string TomlReader::neededText(const std::string& key) {
  need(key);
  return text(key);
}

std::vector<std::string> TomlReader::texts(const std::string& key) {
  const toml::node* node = find(key);
  if (!node) return {};
  std::vector<std::string> result;
  const auto add = [&](const toml::node& element) {
    if (!element.is_string())
      fail(&element, fmt::format("'{}' of {} must be a string or a list of strings", key, what_));
    result.push_back(**element.as_string());
    if (result.back().empty()) fail(&element, fmt::format("'{}' of {} has an empty name", key, what_));
  };
  if (const toml::array* array = node->as_array()) {
    for (const toml::node& element : *array) add(element);
    if (result.empty()) fail(node, fmt::format("'{}' of {} is an empty list", key, what_));
  } else {
    add(*node);
  }
  return result;
}

bool TomlReader::flag(const std::string& key, bool fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  if (!node->is_boolean()) fail(node, fmt::format("'{}' of {} must be true or false", key, what_));
  return **node->as_boolean();
}

std::uint32_t TomlReader::count(const std::string& key, std::uint32_t low, std::uint32_t high, std::uint32_t fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  const auto* integer = node->as_integer();
  if (!integer || **integer < low || **integer > high)
    fail(node, fmt::format("'{}' of {} must be an integer from {} to {}", key, what_, low, high));
  return static_cast<std::uint32_t>(**integer);
}

double TomlReader::number(const std::string& key, double fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  if (const auto* real = node->as_floating_point()) return **real;
  if (const auto* integer = node->as_integer()) return static_cast<double>(**integer);
  fail(node, fmt::format("'{}' of {} must be a number", key, what_));
}

std::size_t TomlReader::choice(const std::string& key, const std::vector<std::string>& choices, std::size_t fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  const std::string name = text(key);
  const auto found = std::find(choices.begin(), choices.end(), name);
  if (found == choices.end())
    fail(node, fmt::format("'{}' of {} cannot be '{}'{}", key, what_, name,
                           didYouMean(name, choices, fmt::format("; there are {}", fmt::join(choices, ", ")))));
  return static_cast<std::size_t>(found - choices.begin());
}

const toml::table* TomlReader::inlineTable(const std::string& key, const std::string& example) {
  const toml::node* node = find(key);
  if (!node) return nullptr;
  if (!node->is_table()) fail(node, fmt::format("'{}' must be a table such as {}", key, example));
  return node->as_table();
}

std::vector<const toml::table*> TomlReader::tables(const std::string& key) {
  std::vector<const toml::table*> result;
  const toml::node* node = find(key);
  if (!node) return result;
  const toml::array* array = node->as_array();
  if (!array) fail(node, fmt::format("'{}' must be written as [[{}]]", key, key));
  for (const toml::node& element : *array) {
    if (!element.is_table()) fail(&element, fmt::format("each '{}' must be a table", key));
    result.push_back(element.as_table());
  }
  return result;
}

void TomlReader::refuseOthers() const {
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (known_.count(name)) continue;
    fail(&node, fmt::format("{} has no key '{}'{}", what_, name, didYouMean(name, {known_.begin(), known_.end()})));
  }
}

std::string didYouMean(const std::string& name, const std::vector<std::string>& candidates,
                       const std::string& fallback) {
  const std::string nearest = nearestName(name, candidates);
  return nearest.empty() ? fallback : fmt::format("; did you mean '{}'?", nearest);
}

}  // namespace quintet::program
