#include "program/declaration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "program/glsl_names.h"

namespace quintet::program {
namespace {

const std::vector<std::string>& typeNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (int i = 0; i < kParameterTypeCount; ++i) names.emplace_back(typeName(static_cast<ParameterType>(i)));
    return names;
  }();
  return kNames;
}

double readNumber(const TomlReader& reader, const toml::node& node, ParameterType type, const std::string& label) {
  if (const auto* real = node.as_floating_point()) return **real;
  if (const auto* integer = node.as_integer()) return static_cast<double>(**integer);
  if (type == ParameterType::boolean && node.is_boolean()) return **node.as_boolean() ? 1.0 : 0.0;
  reader.fail(&node,
              fmt::format("{} must be {}", label, type == ParameterType::boolean ? "true or false" : "a number"));
}

double readChoice(const TomlReader& reader, const toml::node& node, const Parameter& parameter,
                  const std::string& label) {
  const std::vector<std::string>& choices = parameter.choices;
  if (!node.is_string()) reader.fail(&node, fmt::format("{} must be one of {}", label, fmt::join(choices, ", ")));
  const std::string name = **node.as_string();
  const auto found = std::find(choices.begin(), choices.end(), name);
  if (found == choices.end())
    reader.fail(&node, fmt::format("{} cannot be '{}'{}", label, name,
                                   didYouMean(name, choices, fmt::format("; there are {}", fmt::join(choices, ", ")))));
  return static_cast<double>(found - choices.begin());
}

// `label` in messages: "the default of 'tint'".
ParameterValue readValue(const TomlReader& reader, const toml::node& node, const Parameter& parameter,
                         const std::string& label) {
  ParameterValue value{};
  if (parameter.type == ParameterType::choice) return {readChoice(reader, node, parameter, label)};
  const auto count = static_cast<std::size_t>(componentCount(parameter.type));
  const toml::array* array = node.as_array();
  if (array ? array->size() != count : count != 1)
    reader.fail(&node, fmt::format("{} needs {} number{}", label, count, count > 1 ? "s" : ""));
  for (std::size_t i = 0; i < count; ++i)
    value[i] = readNumber(reader, array ? *array->get(i) : node, parameter.type, label);
  if (isWhole(parameter.type) && value[0] != std::floor(value[0]))
    reader.fail(&node, fmt::format("{} must be a whole number", label));
  for (std::size_t i = 0; i < count; ++i) {
    if (!(value[i] >= parameter.min && value[i] <= parameter.max))
      reader.fail(&node, fmt::format("{} is outside {} … {}", label, parameter.min, parameter.max));
  }
  return value;
}

std::vector<std::string> namesOf(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  return names;
}

void parseRange(TomlReader& reader, Parameter& parameter) {
  const auto [low, high] = typeRange(parameter.type);
  parameter.min = std::max(low, reader.number("min", low));
  parameter.max = std::min(high, reader.number("max", high));
}

void parseChoices(TomlReader& reader, Parameter& parameter) {
  reader.need("choices");
  for (const std::string& choice : reader.texts("choices")) {
    if (!isIdentifier(choice))
      reader.fail(reader.find("choices"), fmt::format("the choice '{}' is not an identifier", choice));
    if (std::find(parameter.choices.begin(), parameter.choices.end(), choice) != parameter.choices.end())
      reader.fail(reader.find("choices"), fmt::format("the choice '{}' is there twice", choice));
    parameter.choices.push_back(choice);
  }
}

void parseEncoding(TomlReader& reader, Parameter& parameter) {
  parameter.sRgb = reader.choice("encoding", {"srgb", "linear"}, 0) == 0;
}

void parseDefaultImage(const TomlReader& reader, const toml::node& node, Parameter& parameter,
                       const std::map<std::string, std::string>& files) {
  if (!node.is_string())
    reader.fail(&node, fmt::format("the default of '{}' must be the name of a file, or \"\"", parameter.name));
  parameter.defaultImage = **node.as_string();
  if (parameter.defaultImage.empty() || files.count(parameter.defaultImage)) return;
  std::vector<std::string> names;
  for (const auto& [name, text] : files) names.push_back(name);
  reader.fail(&node, fmt::format("there is no file '{}' beside program.toml{}", parameter.defaultImage,
                                 didYouMean(parameter.defaultImage, names)));
}

// What [[parameter]] and [[record]] have in common. `kind`: "parameter" or "field"; `files`: the program's.
Parameter parseDeclaration(TomlReader& reader, const std::vector<Parameter>& others, std::string_view kind,
                           const std::map<std::string, std::string>& files) {
  Parameter parameter;
  parameter.line = reader.line();
  parameter.name = parseName(reader, namesOf(others));
  if (isReservedWord(parameter.name))
    reader.fail(reader.find("name"), fmt::format("'{}' is a word of GLSL or of the shader library", parameter.name));
  const std::string type = reader.neededText("type");
  const auto found = std::find(typeNames().begin(), typeNames().end(), type);
  if (found == typeNames().end())
    reader.fail(
        reader.find("type"),
        fmt::format("'{}' is no type{}", type,
                    didYouMean(type, typeNames(), fmt::format("; there are {}", fmt::join(typeNames(), ", ")))));
  parameter.type = static_cast<ParameterType>(found - typeNames().begin());
  if (parameter.type == ParameterType::choice)
    parseChoices(reader, parameter);
  else if (parameter.type == ParameterType::image)
    parseEncoding(reader, parameter);
  else
    parseRange(reader, parameter);
  parameter.unit = reader.text("unit");
  parameter.help = reader.text("help");
  const toml::node* node = reader.find("default");
  if (!node) reader.fail(nullptr, fmt::format("{} '{}' needs a default", kind, parameter.name));
  const std::string label = fmt::format("the default of '{}'", parameter.name);
  if (parameter.type == ParameterType::image)
    parseDefaultImage(reader, *node, parameter, files);
  else
    parameter.defaultValue = readValue(reader, *node, parameter, label);
  reader.refuseOthers();
  return parameter;
}

}  // namespace

std::string parseName(TomlReader& reader, const std::vector<std::string>& taken) {
  const std::string name = reader.neededText("name");
  const toml::node* node = reader.find("name");
  if (!isIdentifier(name)) reader.fail(node, fmt::format("'{}' is not an identifier", name));
  if (std::find(taken.begin(), taken.end(), name) != taken.end())
    reader.fail(node, fmt::format("'{}' is there twice", name));
  return name;
}

void parseParameter(Program& program, const toml::table& table, const std::string& file) {
  TomlReader reader(table, "[[parameter]]", file);
  program.parameters.push_back(parseDeclaration(reader, program.parameters, "parameter", program.files));
}

void parseRecordField(Program& program, const toml::table& table, const std::string& file) {
  TomlReader reader(table, "[[record]]", file);
  program.record.push_back(parseDeclaration(reader, program.record, "field", program.files));
  if (program.record.back().type == ParameterType::image)
    reader.fail(reader.find("type"), "a field cannot be an image: declare a parameter");
}

RecordValues parseRecordValues(const Program& program, TomlReader& reader, const RecordValues& base,
                               const std::string& file) {
  const toml::table* table = reader.inlineTable("record", "{ tint = [1.0, 0.5, 0.0] }");
  if (!table) return base;
  const TomlReader values(*table, fmt::format("'record' of {}", reader.what()), file);
  if (program.record.empty()) values.fail(nullptr, "the program declares no [[record]]");
  RecordValues result = base;
  if (result.empty())
    for (const Parameter& field : program.record) result.push_back(field.defaultValue);
  for (const auto& [key, node] : *table) {
    const std::string name(key.str());
    const auto field =
        std::find_if(program.record.begin(), program.record.end(), [&](const Parameter& p) { return p.name == name; });
    if (field == program.record.end()) {
      const std::vector<std::string> names = namesOf(program.record);
      values.fail(&node, fmt::format("the record has no field '{}'{}", name,
                                     didYouMean(name, names, fmt::format("; there are {}", fmt::join(names, ", ")))));
    }
    result[static_cast<std::size_t>(field - program.record.begin())] =
        readValue(values, node, *field, fmt::format("the record's '{}'", name));
  }
  return result;
}

}  // namespace quintet::program
