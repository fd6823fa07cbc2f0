// Reads program.toml (docs/programs.md) from a folder or from the programs compiled into the binary.
#include "program/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#define TOML_EXCEPTIONS 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

#include "base/embedded.h"
#include "base/error.h"
#include "base/file.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedPrograms();
}

namespace quintet::program {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxOutputs = 16;  // shared::kMaxOutputs, as a static_assert in render/film.cpp says

// Typed access to a table that knows where it is, refuses unknown keys and names the line.
class Reader {
 public:
  Reader(const toml::table& table, std::string what, const std::string& file) : table_(table), what_(std::move(what)), file_(file) {}

  [[noreturn]] void fail(const toml::node* node, const std::string& problem) const {
    const auto line = (node ? node->source() : table_.source()).begin.line;
    throw FileError(file_, fmt::format("line {}", std::max<unsigned>(1, line)), problem);
  }

  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }

  std::string text(const std::string& key, bool required = false) {
    const toml::node* node = need(key, required);
    if (!node) return {};
    if (!node->is_string()) fail(node, fmt::format("'{}' of {} must be a string", key, what_));
    return **node->as_string();
  }

  std::uint32_t count(const std::string& key, std::uint32_t fallback, std::uint32_t low, std::uint32_t high) {
    const toml::node* node = need(key, false);
    if (!node) return fallback;
    const auto* integer = node->as_integer();
    if (!integer || **integer < low || **integer > high)
      fail(node, fmt::format("'{}' of {} must be an integer from {} to {}", key, what_, low, high));
    return static_cast<std::uint32_t>(**integer);
  }

  double number(const std::string& key, double fallback) {
    const toml::node* node = need(key, false);
    if (!node) return fallback;
    return numberOf(*node, key);
  }

  double numberOf(const toml::node& node, const std::string& key) const {
    if (const auto* real = node.as_floating_point()) return **real;
    if (const auto* integer = node.as_integer()) return static_cast<double>(**integer);
    if (const auto* boolean = node.as_boolean()) return **boolean ? 1.0 : 0.0;
    fail(&node, fmt::format("'{}' of {} must be a number", key, what_));
  }

  // The tables of [[key]]; empty if absent.
  std::vector<const toml::table*> tables(const std::string& key) {
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

  void refuseOthers() const {
    for (const auto& [key, node] : table_) {
      const std::string name(key.str());
      if (known_.count(name)) continue;
      const std::string nearest = nearestName(name, {known_.begin(), known_.end()});
      fail(&node, fmt::format("{} has no key '{}'{}", what_, name, nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
    }
  }

 private:
  const toml::node* need(const std::string& key, bool required) {
    const toml::node* node = find(key);
    if (!node && required) fail(nullptr, fmt::format("{} needs '{}'", what_, key));
    return node;
  }

  const toml::table& table_;
  std::string what_;
  const std::string& file_;
  std::set<std::string> known_;
};

bool isIdentifier(const std::string& name) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  return !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) && std::all_of(name.begin(), name.end(), word) &&
         name.rfind("gl_", 0) != 0;
}

class Parser {
 public:
  Parser(Program& program, const std::string& file) : program_(program), file_(file) {}

  void parse(const toml::table& root) {
    Reader reader(root, "program.toml", file_);
    const toml::node* head = reader.find("program");
    if (!head || !head->is_table()) reader.fail(head, "[program] is missing");
    parseHead(*head->as_table());
    for (const toml::table* table : reader.tables("ray")) parseRay(*table);
    for (const toml::table* table : reader.tables("hit_group")) parseHitGroup(*table);
    for (const toml::table* table : reader.tables("output")) {
      Reader output(*table, "[[output]]", file_);
      addName(output, *table, output.text("name", true), program_.outputs);
      output.refuseOthers();
    }
    for (const toml::table* table : reader.tables("parameter")) parseParameter(*table);
    reader.refuseOthers();
    if (program_.outputs.size() > kMaxOutputs) reader.fail(nullptr, fmt::format("more than {} outputs are not possible", kMaxOutputs));
    if (program_.outputs.empty()) program_.outputs.push_back("color");
    if (program_.rays.empty()) reader.fail(nullptr, "at least one [[ray]] is needed");
  }

 private:
  void parseHead(const toml::table& table) {
    Reader reader(table, "[program]", file_);
    program_.description = reader.text("description");
    program_.rayGeneration = shaderFile(reader, table, "ray_generation", ".rgen", true);
    program_.maxRecursion = reader.count("max_recursion", 1, 1, 31);
    program_.samplesPerLaunch = reader.count("samples_per_launch", 1, 1, 4096);
    if (const toml::node* node = reader.find("callables")) {
      const toml::array* array = node->as_array();
      if (!array) reader.fail(node, "'callables' must be a list of files");
      for (const toml::node& element : *array) {
        if (!element.is_string()) reader.fail(&element, "'callables' must be a list of files");
        program_.callables.push_back(checkFile(reader, element, **element.as_string(), ".rcall"));
      }
    }
    reader.refuseOthers();
  }

  void parseRay(const toml::table& table) {
    Reader reader(table, "[[ray]]", file_);
    RayType ray;
    std::vector<std::string> names;
    for (const RayType& other : program_.rays) names.push_back(other.name);
    addName(reader, table, reader.text("name", true), names);
    ray.name = names.back();
    if (ray.name == "name" || ray.name == "geometry")
      reader.fail(table.get("name"), fmt::format("'{}' cannot be a ray's name: it is a key of [[hit_group]]", ray.name));
    ray.miss = shaderFile(reader, table, "miss", ".rmiss", true);
    reader.refuseOthers();
    if (program_.rays.size() == 15) reader.fail(nullptr, "more than 15 ray types do not fit the 4-bit stride");
    program_.rays.push_back(ray);
  }

  void parseHitGroup(const toml::table& table) {
    Reader reader(table, "[[hit_group]]", file_);
    HitGroup group;
    std::vector<std::string> names;
    for (const HitGroup& other : program_.hitGroups) names.push_back(other.name);
    addName(reader, table, reader.text("name", true), names);
    group.name = names.back();
    group.geometry = reader.text("geometry");
    if (!group.geometry.empty() && group.geometry != "opaque" && group.geometry != "alpha")
      reader.fail(table.get("geometry"), fmt::format("'{}' is no class of geometry; there are opaque and alpha", group.geometry));
    for (const RayType& ray : program_.rays) {
      const toml::node* node = reader.find(ray.name);
      if (!node) continue;
      if (!node->is_table()) reader.fail(node, fmt::format("'{}' must be a table such as {{ closest_hit = \"a.rchit\" }}", ray.name));
      const toml::table& stages = *node->as_table();
      Reader inner(stages, fmt::format("'{}' of [[hit_group]]", ray.name), file_);
      HitShaders shaders;
      shaders.closestHit = shaderFile(inner, stages, "closest_hit", ".rchit", false);
      shaders.anyHit = shaderFile(inner, stages, "any_hit", ".rahit", false);
      shaders.intersection = shaderFile(inner, stages, "intersection", ".rint", false);
      inner.refuseOthers();
      group.shaders[ray.name] = shaders;
    }
    reader.refuseOthers();
    program_.hitGroups.push_back(group);
  }

  void parseParameter(const toml::table& table) {
    Reader reader(table, "[[parameter]]", file_);
    Parameter parameter;
    std::vector<std::string> names;
    for (const Parameter& other : program_.parameters) names.push_back(other.name);
    addName(reader, table, reader.text("name", true), names);
    parameter.name = names.back();
    const std::string type = reader.text("type", true);
    bool known = false;
    for (int i = 0; i <= static_cast<int>(ParameterType::color); ++i) {
      if (type != typeName(static_cast<ParameterType>(i))) continue;
      parameter.type = static_cast<ParameterType>(i);
      known = true;
    }
    if (!known) reader.fail(table.get("type"), fmt::format("'{}' is no type; there are bool, int, float, vec2, vec3, vec4, color", type));
    parameter.min = reader.number("min", parameter.type == ParameterType::boolean ? 0.0 : parameter.type == ParameterType::integer ? -2147483648.0 : -1e30);
    parameter.max = reader.number("max", parameter.type == ParameterType::boolean ? 1.0 : parameter.type == ParameterType::integer ? 2147483647.0 : 1e30);
    parameter.unit = reader.text("unit");
    parameter.help = reader.text("help");
    parseDefault(reader, parameter);
    reader.refuseOthers();
    program_.parameters.push_back(parameter);
  }

  void parseDefault(Reader& reader, Parameter& parameter) {
    const toml::node* node = reader.find("default");
    if (!node) reader.fail(nullptr, fmt::format("parameter '{}' needs a default", parameter.name));
    const auto count = static_cast<std::size_t>(componentCount(parameter.type));
    if (const toml::array* array = node->as_array()) {
      if (array->size() != count) reader.fail(node, fmt::format("the default of '{}' needs {} numbers", parameter.name, count));
      for (std::size_t i = 0; i < count; ++i) parameter.defaultValue[i] = reader.numberOf(*array->get(i), "default");
    } else {
      if (count != 1) reader.fail(node, fmt::format("the default of '{}' needs {} numbers", parameter.name, count));
      parameter.defaultValue[0] = reader.numberOf(*node, "default");
    }
    const bool whole = parameter.type == ParameterType::integer || parameter.type == ParameterType::boolean;
    if (whole && parameter.defaultValue[0] != std::floor(parameter.defaultValue[0]))
      reader.fail(node, fmt::format("the default of '{}' must be a whole number", parameter.name));
    for (std::size_t i = 0; i < count; ++i)
      if (!(parameter.defaultValue[i] >= parameter.min && parameter.defaultValue[i] <= parameter.max))
        reader.fail(node, fmt::format("the default of '{}' is outside {} … {}", parameter.name, parameter.min, parameter.max));
  }

  void addName(const Reader& reader, const toml::table& table, const std::string& name, std::vector<std::string>& names) const {
    if (!isIdentifier(name)) reader.fail(table.get("name"), fmt::format("'{}' is not an identifier", name));
    if (std::find(names.begin(), names.end(), name) != names.end()) reader.fail(table.get("name"), fmt::format("'{}' is there twice", name));
    names.push_back(name);
  }

  std::string shaderFile(Reader& reader, const toml::table& table, const std::string& key, const std::string& extension, bool required) const {
    const std::string name = reader.text(key, required);
    return name.empty() && !required ? name : checkFile(reader, *table.get(key), name, extension);
  }

  std::string checkFile(const Reader& reader, const toml::node& node, const std::string& name, const std::string& extension) const {
    const bool library = isLibraryStage(name);
    if (fs::path(library ? name.substr(1, name.size() - 2) : name).extension() != extension) reader.fail(&node, fmt::format("'{}' must end in {}", name, extension));
    if (!library && !program_.files.count(name)) reader.fail(&node, fmt::format("there is no file '{}' in {}", name, program_.origin));
    return name;
  }

  Program& program_;
  const std::string& file_;
};

Program loadFolder(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.file_size() <= (1u << 24)) files[entry.path().filename().string()] = readTextFile(entry.path());
  const auto toml = files.find("program.toml");
  if (toml == files.end()) throw FileError(folder, "has no program.toml");
  const std::string text = toml->second;
  std::error_code ignored;
  const fs::path absolute = fs::canonical(folder, ignored);
  return parseProgram(text, absolute.filename().string(), folder.string(), std::move(files));
}

}  // namespace

Program parseProgram(const std::string& toml, const std::string& name, const std::string& origin, std::map<std::string, std::string> files) {
  Program program;
  program.name = name;
  program.origin = origin;
  program.files = std::move(files);
  const std::string file = program.path("program.toml");
  toml::table root;
  try {
    root = toml::parse(toml, file);
  } catch (const toml::parse_error& error) {
    throw FileError(file, fmt::format("line {}", error.source().begin.line), std::string(error.description()));
  }
  Parser(program, file).parse(root);
  return program;
}

bool isLibraryStage(const std::string& file) { return file.size() > 2 && file.front() == '<' && file.back() == '>'; }

std::vector<std::string> builtInPrograms() {
  std::vector<std::string> names;
  constexpr std::string_view kEnd = "/program.toml";
  for (const EmbeddedFile& file : embeddedPrograms())
    if (file.path.ends_with(kEnd)) names.emplace_back(file.path.substr(0, file.path.size() - kEnd.size()));
  return names;
}

Program loadProgram(const std::string& nameOrFolder) {
  std::error_code ignored;
  fs::path path = nameOrFolder;
  if (path.filename() == "program.toml" && fs::is_regular_file(path, ignored)) path = path.has_parent_path() ? path.parent_path() : ".";
  if (fs::is_directory(path, ignored) && fs::exists(path / "program.toml", ignored)) return loadFolder(path);

  std::map<std::string, std::string> files;
  const std::string prefix = nameOrFolder + "/";
  for (const EmbeddedFile& file : embeddedPrograms())
    if (file.path.starts_with(prefix)) files.emplace(file.path.substr(prefix.size()), file.data);
  if (files.count("program.toml")) {
    const std::string text = files.at("program.toml");
    return parseProgram(text, nameOrFolder, "<programs/" + nameOrFolder + ">", std::move(files));
  }
  if (fs::is_directory(path, ignored)) throw FileError(path, "has no program.toml");
  const std::string nearest = nearestName(nameOrFolder, builtInPrograms());
  throw UsageError(fmt::format("no program '{}': neither a folder with program.toml nor one of {}{}", nameOrFolder,
                               fmt::join(builtInPrograms(), ", "), nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
}

std::string generatedConstants(const Program& program) {
  std::string text = "// Generated from program.toml.\n#ifndef QUINTET_GENERATED_PROGRAM\n#define QUINTET_GENERATED_PROGRAM\n";
  text += fmt::format("const uint kRayTypeCount = {}u;\n", program.rays.size());
  for (std::size_t i = 0; i < program.rays.size(); ++i) {
    text += fmt::format("const uint kRay_{} = {}u;\n", program.rays[i].name, i);
    text += fmt::format("const uint kMiss_{} = {}u;\n", program.rays[i].name, i);
  }
  for (std::size_t i = 0; i < program.outputs.size(); ++i) text += fmt::format("const uint kOutput_{} = {}u;\n", program.outputs[i], i);
  text += "struct Parameters {\n";
  for (const Parameter& parameter : program.parameters) text += fmt::format("  {} {};\n", glslType(parameter.type), parameter.name);
  if (program.parameters.empty()) text += "  uint unused_;\n";
  text += "};\n"
          "layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ParametersReference { Parameters value; };\n"
          "#define parameters ParametersReference(launch.parameters).value\n#endif\n";
  return text;
}

}  // namespace quintet::program
