#include "program/program_parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "program/declaration.h"
#include "program/glsl_names.h"

namespace quintet::program {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxOutputs = 32;    // shared::kMaxOutputs, as a static_assert in render/film.cpp says
constexpr std::size_t kMaxRayTypes = 15;   // sbtRecordStride of traceRayEXT has 4 bits
constexpr std::size_t kMaxMisses = 65536;  // missIndex has 16
constexpr const char* kStagesExample = "{ closest_hit = \"a.rchit\" }";
// Keys of [[hit_group]], which no ray type can have as its name.
const std::vector<std::string> kHitGroupKeys{"name", "geometry", "material", "primitives", "record"};

template <class T>
std::vector<std::string> namesOf(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& thing : things)
    if (!thing.name.empty()) names.push_back(thing.name);
  return names;
}

class Parser {
 public:
  Parser(Program& program, const std::string& file) : program_(program), file_(file) {}

  void parse(const toml::table& root) {
    TomlReader reader(root, "program.toml", file_);
    const toml::node* head = reader.find("program");
    if (!head || !head->is_table()) reader.fail(head, "[program] is missing");
    for (const toml::table* table : reader.tables("record")) parseRecordField(program_, *table, file_);
    parseHead(*head->as_table());
    for (const toml::table* table : reader.tables("ray")) parseRay(*table);
    for (const toml::table* table : reader.tables("miss")) parseMiss(*table);
    for (const toml::table* table : reader.tables("callable")) parseCallable(*table);
    for (const toml::table* table : reader.tables("hit_group")) parseHitGroup(*table);
    for (const toml::table* table : reader.tables("output")) parseOutput(*table);
    for (const toml::table* table : reader.tables("parameter")) parseParameter(program_, *table, file_);
    reader.refuseOthers();
    if (program_.outputs.empty()) program_.outputs.push_back({.name = "color"});
    if (program_.rays.empty()) reader.fail(nullptr, "at least one [[ray]] is needed");
  }

 private:
  void parseHead(const toml::table& table) {
    TomlReader reader(table, "[program]", file_);
    program_.description = reader.text("description");
    program_.scene = reader.text("scene");
    if (!program_.scene.empty() && !program_.files.count(program_.scene))
      reader.fail(reader.find("scene"), fmt::format("there is no file '{}' in {}", program_.scene, program_.origin));
    program_.rayGeneration = shaderFile(reader, "ray_generation", ".rgen", true);
    program_.rayGenerationLine = reader.line(reader.find("ray_generation"));
    program_.rayGenerationRecord = parseRecordValues(program_, reader, {}, file_);
    if (reader.find("max_recursion")) program_.declaredRecursion = reader.count("max_recursion", 1, 31, 1);
    program_.samplesPerLaunch = reader.count("samples_per_launch", 1, 4096, 1);
    program_.accumulation = static_cast<Accumulation>(reader.choice("accumulation", {"film", "program"}, 0));
    program_.keepsInstanceOrder = reader.flag("keeps_instance_order", false);
    program_.anyHitForAll = reader.flag("any_hit_for_all", false);
    program_.adaptive = reader.flag("adaptive", false);
    parseCallableList(reader);
    reader.refuseOthers();
  }

  // The short form: callables = ["a.rcall"], each named by its file.
  void parseCallableList(TomlReader& reader) {
    const toml::node* node = reader.find("callables");
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array) reader.fail(node, "'callables' must be a list of files");
    for (const toml::node& element : *array) {
      if (!element.is_string()) reader.fail(&element, "'callables' must be a list of files");
      Callable callable;
      callable.line = reader.line(&element);
      callable.file = checkFile(reader, element, **element.as_string(), ".rcall");
      const std::string stem = fs::path(callable.file).stem().string();
      const std::vector<std::string> taken = namesOf(program_.callables);
      if (isIdentifier(stem) && std::find(taken.begin(), taken.end(), stem) == taken.end()) callable.name = stem;
      program_.callables.push_back(std::move(callable));
    }
  }

  void parseRay(const toml::table& table) {
    TomlReader reader(table, "[[ray]]", file_);
    RayType ray;
    ray.line = reader.line();
    ray.name = parseName(reader, namesOf(program_.rays));
    if (std::find(kHitGroupKeys.begin(), kHitGroupKeys.end(), ray.name) != kHitGroupKeys.end())
      reader.fail(reader.find("name"),
                  fmt::format("'{}' cannot be a ray's name: it is a key of [[hit_group]]", ray.name));
    ray.miss = shaderFile(reader, "miss", ".rmiss", true);
    ray.record = parseRecordValues(program_, reader, {}, file_);
    reader.refuseOthers();
    if (program_.rays.size() == kMaxRayTypes)
      reader.fail(nullptr, "more than 15 ray types do not fit the 4-bit stride");
    program_.rays.push_back(std::move(ray));
  }

  void parseMiss(const toml::table& table) {
    TomlReader reader(table, "[[miss]]", file_);
    MissShader miss;
    miss.line = reader.line();
    miss.name = parseName(reader, namesOf(missShaders(program_)));
    miss.file = shaderFile(reader, "file", ".rmiss", true);
    miss.record = parseRecordValues(program_, reader, {}, file_);
    reader.refuseOthers();
    if (program_.rays.size() + program_.misses.size() == kMaxMisses)
      reader.fail(nullptr, "more than 65536 miss shaders do not fit the 16-bit index");
    program_.misses.push_back(std::move(miss));
  }

  void parseCallable(const toml::table& table) {
    TomlReader reader(table, "[[callable]]", file_);
    Callable callable;
    callable.line = reader.line();
    callable.name = parseName(reader, namesOf(program_.callables));
    callable.file = shaderFile(reader, "file", ".rcall", true);
    callable.record = parseRecordValues(program_, reader, {}, file_);
    reader.refuseOthers();
    program_.callables.push_back(std::move(callable));
  }

  void parseHitGroup(const toml::table& table) {
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
      const toml::table* stages = reader.inlineTable(ray.name, kStagesExample);
      if (stages) group.shaders[ray.name] = parseStages(*stages, ray.name, record);
    }
    reader.refuseOthers();
    program_.hitGroups.push_back(std::move(group));
  }

  void checkClass(TomlReader& reader, const std::string& name) const {
    const std::vector<std::string>& classes = geometryClasses();
    if (std::find(classes.begin(), classes.end(), name) != classes.end()) return;
    reader.fail(reader.find("geometry"),
                fmt::format("'{}' is no class of geometry{}", name,
                            didYouMean(name, classes, fmt::format("; there are {}", fmt::join(classes, ", ")))));
  }

  HitShaders parseStages(const toml::table& table, const std::string& ray, const RecordValues& record) {
    TomlReader reader(table, fmt::format("'{}' of [[hit_group]]", ray), file_);
    HitShaders shaders;
    shaders.line = reader.line();
    shaders.closestHit = shaderFile(reader, "closest_hit", ".rchit", false);
    shaders.anyHit = shaderFile(reader, "any_hit", ".rahit", false);
    shaders.intersection = shaderFile(reader, "intersection", ".rint", false);
    shaders.record = parseRecordValues(program_, reader, record, file_);
    reader.refuseOthers();
    return shaders;
  }

  void parseOutput(const toml::table& table) {
    TomlReader reader(table, "[[output]]", file_);
    Output output;
    output.line = reader.line();
    output.name = parseName(reader, namesOf(program_.outputs));
    std::vector<std::string> kinds;
    for (int i = 0; i <= static_cast<int>(OutputKind::display); ++i)
      kinds.emplace_back(outputKindName(static_cast<OutputKind>(i)));
    const OutputKind usual = output.name == "color" ? OutputKind::color : OutputKind::linear;
    output.kind = static_cast<OutputKind>(reader.choice("kind", kinds, static_cast<std::size_t>(usual)));
    output.help = reader.text("help");
    std::vector<std::string> pixels;
    for (int i = 0; i <= static_cast<int>(OutputPixel::coverage); ++i)
      pixels.emplace_back(outputPixelName(static_cast<OutputPixel>(i)));
    output.pixel = static_cast<OutputPixel>(reader.choice("pixel", pixels, 0));
    output.optional = reader.flag("optional", false);
    output.channels = parseChannels(reader);
    if (program_.accumulation == Accumulation::program && (output.optional || output.pixel != OutputPixel::mean))
      reader.fail(nullptr, "accumulation = \"program\": outputs are neither optional nor anything but mean");
    if (program_.outputs.empty() && (output.optional || output.pixel != OutputPixel::mean))
      reader.fail(nullptr, "the first output is the picture: it can be neither optional nor anything but mean");
    reader.refuseOthers();
    if (program_.outputs.size() == kMaxOutputs)
      reader.fail(nullptr, fmt::format("more than {} outputs are not possible", kMaxOutputs));
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
      reader.fail(reader.find("channels"), "'channels' are one to four different names of letters, digits and _");
    return channels;
  }

  // An absent file that is not required gives an empty name.
  std::string shaderFile(TomlReader& reader, const std::string& key, const std::string& extension,
                         bool required) const {
    const std::string name = required ? reader.neededText(key) : reader.text(key);
    const toml::node* node = reader.find(key);
    return node ? checkFile(reader, *node, name, extension) : name;
  }

  std::string checkFile(const TomlReader& reader, const toml::node& node, const std::string& name,
                        const std::string& extension) const {
    const bool library = isLibraryStage(name);
    if (fs::path(library ? name.substr(1, name.size() - 2) : name).extension() != extension)
      reader.fail(&node, fmt::format("'{}' must end in {}", name, extension));
    if (library || program_.files.count(name)) return name;
    std::vector<std::string> others;
    for (const auto& [file, text] : program_.files)
      if (fs::path(file).extension() == extension) others.push_back(file);
    reader.fail(&node, fmt::format("there is no file '{}' in {}{}", name, program_.origin, didYouMean(name, others)));
  }

  Program& program_;
  const std::string& file_;
};

}  // namespace

void parseTables(Program& program, const toml::table& root, const std::string& file) {
  Parser(program, file).parse(root);
}

}  // namespace quintet::program
