// SPDX-License-Identifier: Apache-2.0
#include "program/description/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/plural.h"
#include "base/suggestion.h"
#include "base/toml_reader.h"
#include "program/description/generated_glsl.h"
#include "program/description/limits.h"

namespace quintet::program {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxRayTypes = 15;   // sbtRecordStride of traceRayEXT has 4 bits
constexpr std::size_t kMaxMisses = 65536;  // missIndex of traceRayEXT has 16 bits
constexpr const char* kStagesExample = "{ closest_hit = \"a.rchit\" }";
// Keys of [[hit_group]], which cannot be names of ray types.
const std::vector<std::string> kHitGroupKeys{"name", "geometry", "material", "primitives", "record"};

template <class T>
std::vector<std::string> namesOf(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& thing : things)
    if (!thing.name.empty()) names.push_back(thing.name);
  return names;
}

// ---- [[parameter]], [[record]] and values of records ----

const std::vector<std::string>& typeNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (int i = 0; i < kParameterTypeCount; ++i) names.emplace_back(typeName(static_cast<ParameterType>(i)));
    return names;
  }();
  return kNames;
}

double readNumber(const TomlReader& reader, const TomlValue& node, ParameterType type, const std::string& label) {
  if (node.isNumber()) return node.real;
  if (type == ParameterType::boolean && node.kind == TomlValue::Kind::boolean) return node.boolean ? 1.0 : 0.0;
  reader.fail(node, fmt::format("{} must be {}", label, type == ParameterType::boolean ? "true or false" : "a number"));
}

double readChoice(const TomlReader& reader, const TomlValue& node, const Parameter& parameter,
                  const std::string& label) {
  const std::vector<std::string>& choices = parameter.choices;
  if (node.kind != TomlValue::Kind::text)
    reader.fail(node, fmt::format("{} must be one of {}", label, fmt::join(choices, ", ")));
  const std::string& name = node.text;
  const auto found = std::find(choices.begin(), choices.end(), name);
  if (found == choices.end())
    reader.fail(node, fmt::format("{} cannot be '{}'{}", label, name, suggestionOrList(name, choices)));
  return static_cast<double>(found - choices.begin());
}

// `label` names the value in messages: "the default of 'tint'".
ParameterValue readValue(const TomlReader& reader, const TomlValue& node, const Parameter& parameter,
                         const std::string& label) {
  ParameterValue value{};
  if (parameter.type == ParameterType::choice) return {readChoice(reader, node, parameter, label)};
  const auto count = static_cast<std::size_t>(componentCount(parameter.type));
  const bool array = node.kind == TomlValue::Kind::array;
  if (array ? node.elements.size() != count : count != 1)
    reader.fail(node, fmt::format("{} requires {}", label, counted(count, "number")));
  for (std::size_t i = 0; i < count; ++i)
    value[i] = readNumber(reader, array ? node.elements[i] : node, parameter.type, label);
  if (isWhole(parameter.type) && value[0] != std::floor(value[0]))
    reader.fail(node, fmt::format("{} must be an integer", label));
  for (std::size_t i = 0; i < count; ++i) {
    if (!(value[i] >= parameter.min && value[i] <= parameter.max))
      reader.fail(node, fmt::format("{} is out of range ({} to {})", label, parameter.min, parameter.max));
  }
  return value;
}

void parseRange(TomlReader& reader, Parameter& parameter) {
  const auto [low, high] = typeRange(parameter.type);
  parameter.min = std::max(low, reader.number("min", low));
  parameter.max = std::min(high, reader.number("max", high));
}

void parseChoices(TomlReader& reader, Parameter& parameter) {
  reader.require("choices");
  for (const std::string& choice : reader.texts("choices")) {
    if (!isIdentifier(choice))
      reader.fail(*reader.find("choices"), fmt::format("the choice '{}' is not an identifier", choice));
    if (std::find(parameter.choices.begin(), parameter.choices.end(), choice) != parameter.choices.end())
      reader.fail(*reader.find("choices"), fmt::format("duplicate choice '{}'", choice));
    parameter.choices.push_back(choice);
  }
}

void parseEncoding(TomlReader& reader, Parameter& parameter) {
  parameter.sRgb = reader.choice("encoding", {"srgb", "linear"}, 0) == 0;
}

void parseDefaultImage(const TomlReader& reader, const TomlValue& node, Parameter& parameter,
                       const std::map<std::string, std::string>& files) {
  if (node.kind != TomlValue::Kind::text)
    reader.fail(node, fmt::format("the default of '{}' must be a file name or \"\"", parameter.name));
  parameter.defaultImage = node.text;
  if (parameter.defaultImage.empty() || files.count(parameter.defaultImage)) return;
  std::vector<std::string> names;
  for (const auto& [name, text] : files) names.push_back(name);
  reader.fail(node, fmt::format("file '{}' not found next to program.toml{}", parameter.defaultImage,
                                suggestion(parameter.defaultImage, names)));
}

// Returns the table's `name`, an identifier that is not in `taken`.
std::string parseName(TomlReader& reader, const std::vector<std::string>& taken) {
  const std::string name = reader.requiredText("name");
  const TomlValue& node = reader.require("name");
  if (!isIdentifier(name)) reader.fail(node, fmt::format("'{}' is not an identifier", name));
  if (std::find(taken.begin(), taken.end(), name) != taken.end())
    reader.fail(node, fmt::format("duplicate name '{}'", name));
  return name;
}

// Parses what [[parameter]] and [[record]] have in common. `kind` names the table in messages: "parameter" or "record
// field". `files` are the program's.
Parameter parseDeclaration(TomlReader& reader, const std::vector<Parameter>& others, std::string_view kind,
                           const std::map<std::string, std::string>& files) {
  Parameter parameter;
  parameter.line = reader.line();
  parameter.name = parseName(reader, namesOf(others));
  if (isReservedWord(parameter.name))
    reader.fail(*reader.find("name"),
                fmt::format("'{}' is a reserved word of GLSL or of the shader library", parameter.name));
  const std::string type = reader.requiredText("type");
  const auto found = std::find(typeNames().begin(), typeNames().end(), type);
  if (found == typeNames().end())
    reader.fail(*reader.find("type"), fmt::format("unknown type '{}'{}", type, suggestionOrList(type, typeNames())));
  parameter.type = static_cast<ParameterType>(found - typeNames().begin());
  if (parameter.type == ParameterType::choice)
    parseChoices(reader, parameter);
  else if (parameter.type == ParameterType::image)
    parseEncoding(reader, parameter);
  else
    parseRange(reader, parameter);
  parameter.unit = reader.text("unit");
  parameter.help = reader.text("help");
  const TomlValue* node = reader.find("default");
  if (!node) reader.fail(fmt::format("{} '{}' requires a default", kind, parameter.name));
  const std::string label = fmt::format("the default of '{}'", parameter.name);
  if (parameter.type == ParameterType::image)
    parseDefaultImage(reader, *node, parameter, files);
  else
    parameter.defaultValue = readValue(reader, *node, parameter, label);
  reader.rejectUnknownKeys();
  return parameter;
}

// Returns the value of `record` in the reader's table over `base` (empty means the fields' defaults).
RecordValues parseRecordValues(const Program& program, TomlReader& reader, const RecordValues& base,
                               const std::string& file) {
  const TomlValue* table = reader.inlineTable("record", "{ tint = [1.0, 0.5, 0.0] }");
  if (!table) return base;
  const TomlReader values(*table, fmt::format("'record' of {}", reader.what()), file);
  if (program.record.empty()) values.fail("the program declares no [[record]] fields");
  RecordValues result = base;
  if (result.empty())
    for (const Parameter& field : program.record) result.push_back(field.defaultValue);
  for (const auto& [name, node] : table->members) {
    const auto field = std::ranges::find(program.record, name, &Parameter::name);
    if (field == program.record.end()) {
      const std::vector<std::string> names = namesOf(program.record);
      values.fail(node, fmt::format("unknown record field '{}'{}", name, suggestionOrList(name, names)));
    }
    result[static_cast<std::size_t>(field - program.record.begin())] =
        readValue(values, node, *field, fmt::format("record field '{}'", name));
  }
  return result;
}

// ---- the tables of program.toml ----

class Parser {
 public:
  Parser(Program& program, const std::string& file) : program_(program), file_(file) {}

  void parse(const TomlValue& root) {
    TomlReader reader(root, "program.toml", file_);
    const TomlValue* head = reader.find("program");
    if (!head || head->kind != TomlValue::Kind::table) reader.fail(head ? *head : root, "[program] is missing");
    for (const TomlValue& table : reader.tables("record")) parseRecordField(table);
    parseHead(*head);
    for (const TomlValue& table : reader.tables("ray")) parseRay(table);
    for (const TomlValue& table : reader.tables("miss")) parseMiss(table);
    for (const TomlValue& table : reader.tables("callable")) parseCallable(table);
    for (const TomlValue& table : reader.tables("hit_group")) parseHitGroup(table);
    for (const TomlValue& table : reader.tables("output")) parseOutput(table);
    for (const TomlValue& table : reader.tables("parameter")) parseParameter(table);
    reader.rejectUnknownKeys();
    if (program_.outputs.empty()) program_.outputs.push_back({.name = "color"});
    if (program_.rays.empty()) reader.fail("at least one [[ray]] is required");
  }

 private:
  void parseHead(const TomlValue& table) {
    TomlReader reader(table, "[program]", file_);
    program_.description = reader.text("description");
    program_.scene = reader.text("scene");
    if (!program_.scene.empty() && !program_.files.count(program_.scene))
      reader.fail(*reader.find("scene"), fmt::format("file '{}' not found in {}", program_.scene, program_.origin));
    program_.rayGeneration = shaderFile(reader, "ray_generation", ".rgen", true);
    program_.rayGenerationLine = reader.require("ray_generation").line;
    program_.rayGenerationRecord = parseRecordValues(program_, reader, {}, file_);
    if (reader.find("max_recursion")) program_.declaredRecursion = reader.integer("max_recursion", 1, 1, 31);
    program_.samplesPerLaunch = reader.integer("samples_per_launch", 1, 1, 4096);
    program_.accumulation = static_cast<Accumulation>(reader.choice("accumulation", {"film", "program"}, 0));
    program_.keepsInstanceOrder = reader.boolean("keeps_instance_order", false);
    program_.mergesInstances = reader.boolean("merges_instances", false);
    program_.anyHitForAll = reader.boolean("any_hit_for_all", false);
    program_.adaptive = reader.boolean("adaptive", false);
    parseCallableList(reader);
    reader.rejectUnknownKeys();
  }

  // Parses the short form callables = ["a.rcall"], in which each callable has the name of its file.
  void parseCallableList(TomlReader& reader) {
    const TomlValue* node = reader.find("callables");
    if (!node) return;
    if (node->kind != TomlValue::Kind::array) reader.fail(*node, "'callables' must be a list of files");
    for (const TomlValue& element : node->elements) {
      if (element.kind != TomlValue::Kind::text) reader.fail(element, "'callables' must be a list of files");
      Callable callable;
      callable.line = element.line;
      callable.file = checkFile(reader, element, element.text, ".rcall");
      const std::string stem = fs::path(callable.file).stem().string();
      const std::vector<std::string> taken = namesOf(program_.callables);
      if (isIdentifier(stem) && std::find(taken.begin(), taken.end(), stem) == taken.end()) callable.name = stem;
      program_.callables.push_back(std::move(callable));
    }
  }

  void parseRay(const TomlValue& table) {
    TomlReader reader(table, "[[ray]]", file_);
    RayType ray;
    ray.line = reader.line();
    ray.name = parseName(reader, namesOf(program_.rays));
    if (std::find(kHitGroupKeys.begin(), kHitGroupKeys.end(), ray.name) != kHitGroupKeys.end())
      reader.fail(*reader.find("name"),
                  fmt::format("a ray cannot have the name '{}', which is a key of [[hit_group]]", ray.name));
    ray.miss = shaderFile(reader, "miss", ".rmiss", true);
    ray.record = parseRecordValues(program_, reader, {}, file_);
    reader.rejectUnknownKeys();
    if (program_.rays.size() == kMaxRayTypes)
      reader.fail("more than 15 ray types: sbtRecordStride of traceRayEXT has 4 bits");
    program_.rays.push_back(std::move(ray));
  }

  void parseMiss(const TomlValue& table) {
    TomlReader reader(table, "[[miss]]", file_);
    MissShader miss;
    miss.line = reader.line();
    miss.name = parseName(reader, namesOf(missShaders(program_)));
    miss.file = shaderFile(reader, "file", ".rmiss", true);
    miss.record = parseRecordValues(program_, reader, {}, file_);
    reader.rejectUnknownKeys();
    if (program_.rays.size() + program_.misses.size() == kMaxMisses)
      reader.fail("more than 65536 miss shaders: missIndex of traceRayEXT has 16 bits");
    program_.misses.push_back(std::move(miss));
  }

  void parseCallable(const TomlValue& table) {
    TomlReader reader(table, "[[callable]]", file_);
    Callable callable;
    callable.line = reader.line();
    callable.name = parseName(reader, namesOf(program_.callables));
    callable.file = shaderFile(reader, "file", ".rcall", true);
    callable.record = parseRecordValues(program_, reader, {}, file_);
    reader.rejectUnknownKeys();
    program_.callables.push_back(std::move(callable));
  }

  void parseHitGroup(const TomlValue& table) {
    TomlReader reader(table, "[[hit_group]]", file_);
    HitGroup group;
    group.line = reader.line();
    group.name = parseName(reader, namesOf(program_.hitGroups));
    group.geometry = reader.texts("geometry");
    for (const std::string& name : group.geometry) checkClass(reader, name);
    group.material = reader.texts("material");
    group.primitives = reader.texts("primitives");
    const RecordValues record = parseRecordValues(program_, reader, {}, file_);
    for (const RayType& ray : program_.rays) {
      const TomlValue* stages = reader.inlineTable(ray.name, kStagesExample);
      if (stages) group.shaders[ray.name] = parseStages(*stages, ray.name, record);
    }
    reader.rejectUnknownKeys();
    program_.hitGroups.push_back(std::move(group));
  }

  void checkClass(TomlReader& reader, const std::string& name) const {
    const std::vector<std::string>& classes = geometryClasses();
    if (std::find(classes.begin(), classes.end(), name) != classes.end()) return;
    reader.fail(*reader.find("geometry"),
                fmt::format("unknown geometry class '{}'{}", name, suggestionOrList(name, classes)));
  }

  HitShaders parseStages(const TomlValue& table, const std::string& ray, const RecordValues& record) {
    TomlReader reader(table, fmt::format("'{}' of [[hit_group]]", ray), file_);
    HitShaders shaders;
    shaders.line = reader.line();
    shaders.closestHit = shaderFile(reader, "closest_hit", ".rchit", false);
    shaders.anyHit = shaderFile(reader, "any_hit", ".rahit", false);
    shaders.intersection = shaderFile(reader, "intersection", ".rint", false);
    shaders.record = parseRecordValues(program_, reader, record, file_);
    reader.rejectUnknownKeys();
    return shaders;
  }

  void parseOutput(const TomlValue& table) {
    TomlReader reader(table, "[[output]]", file_);
    Output output;
    output.line = reader.line();
    output.name = parseName(reader, namesOf(program_.outputs));
    std::vector<std::string> kinds;
    for (int i = 0; i <= static_cast<int>(OutputKind::heat); ++i)
      kinds.emplace_back(outputKindName(static_cast<OutputKind>(i)));
    const OutputKind usual = output.name == "color" ? OutputKind::color : OutputKind::linear;
    output.kind = static_cast<OutputKind>(reader.choice("kind", kinds, static_cast<std::size_t>(usual)));
    output.help = reader.text("help");
    std::vector<std::string> pixels;
    for (int i = 0; i <= static_cast<int>(OutputPixel::coverage); ++i)
      pixels.emplace_back(outputPixelName(static_cast<OutputPixel>(i)));
    output.pixel = static_cast<OutputPixel>(reader.choice("pixel", pixels, 0));
    output.optional = reader.boolean("optional", false);
    output.channels = parseChannels(reader);
    if (program_.accumulation == Accumulation::program && (output.optional || output.pixel != OutputPixel::mean))
      reader.fail("with accumulation = \"program\", an output cannot be optional and 'pixel' must be \"mean\"");
    if (program_.outputs.empty() && (output.optional || output.pixel != OutputPixel::mean))
      reader.fail("the first output is the image: it cannot be optional and 'pixel' must be \"mean\"");
    reader.rejectUnknownKeys();
    if (program_.outputs.size() == kMaxOutputs) reader.fail(fmt::format("more than {} outputs", kMaxOutputs));
    program_.outputs.push_back(std::move(output));
  }

  std::vector<std::string> parseChannels(TomlReader& reader) const {
    std::vector<std::string> channels = reader.texts("channels");
    const auto good = [](const std::string& name) {
      return name.size() <= 32 &&
             std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
    };
    const bool twice = std::set<std::string>(channels.begin(), channels.end()).size() != channels.size();
    if (channels.size() > 4 || twice || !std::ranges::all_of(channels, good))
      reader.fail(*reader.find("channels"),
                  "'channels' must be one to four different names of letters, digits and '_'");
    return channels;
  }

  void parseParameter(const TomlValue& table) {
    TomlReader reader(table, "[[parameter]]", file_);
    program_.parameters.push_back(parseDeclaration(reader, program_.parameters, "parameter", program_.files));
  }

  void parseRecordField(const TomlValue& table) {
    TomlReader reader(table, "[[record]]", file_);
    program_.record.push_back(parseDeclaration(reader, program_.record, "record field", program_.files));
    if (program_.record.back().type == ParameterType::image)
      reader.fail(*reader.find("type"), "a record field cannot be an image; declare a [[parameter]] instead");
  }

  // Returns an empty name for an absent file that is not required.
  std::string shaderFile(TomlReader& reader, const std::string& key, const std::string& extension,
                         bool required) const {
    const std::string name = required ? reader.requiredText(key) : reader.text(key);
    const TomlValue* node = reader.find(key);
    return node ? checkFile(reader, *node, name, extension) : name;
  }

  std::string checkFile(const TomlReader& reader, const TomlValue& node, const std::string& name,
                        const std::string& extension) const {
    const bool library = isLibraryStage(name);
    if (fs::path(library ? name.substr(1, name.size() - 2) : name).extension() != extension)
      reader.fail(node, fmt::format("'{}' must end in {}", name, extension));
    if (library || program_.files.count(name)) return name;
    std::vector<std::string> others;
    for (const auto& [file, text] : program_.files)
      if (fs::path(file).extension() == extension) others.push_back(file);
    reader.fail(node, fmt::format("file '{}' not found in {}{}", name, program_.origin, suggestion(name, others)));
  }

  Program& program_;
  const std::string& file_;
};

}  // namespace

Program parseProgram(const std::string& toml, const std::string& name, const std::string& origin,
                     std::map<std::string, std::string> files) {
  Program program;
  program.name = name;
  program.origin = origin;
  program.files = std::move(files);
  const std::string file = program.path(program.descriptionFile);
  Parser(program, file).parse(parseToml(toml, file));
  chooseDefaultScene(program);
  return program;
}

}  // namespace quintet::program
