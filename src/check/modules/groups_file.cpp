// SPDX-License-Identifier: Apache-2.0
#include "check/modules/groups_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/suggestion.h"
#include "base/text.h"

namespace quintet::check {
namespace {

using GroupsJson = nlohmann::json;

constexpr std::size_t kMaxRecords = 1u << 16;
constexpr std::uint32_t kMaxGeometries = 1u << 20;

// A value of the file and its JSON pointer.
struct Node {
  const GroupsJson& json;
  std::string pointer;
};

class GroupsReader {
 public:
  explicit GroupsReader(const std::filesystem::path& file) : file_(file) {}

  std::vector<DescribedPipeline> read(const GroupsJson& json) {
    const Node root{json, ""};
    requireObject(root);
    if (!json.contains("pipelines")) return {pipeline(root)};
    checkMembers(root, {"pipelines"});
    std::vector<DescribedPipeline> result;
    for (const Node& element : elements(*member(root, "pipelines"))) result.push_back(pipeline(element));
    if (result.empty()) fail({json, "/pipelines"}, "the list is empty; add a pipeline");
    return result;
  }

 private:
  [[noreturn]] void fail(const Node& node, const std::string& problem) const {
    throw FileError(file_, node.pointer.empty() ? "/" : node.pointer, problem);
  }

  static std::string escaped(std::string_view name) {
    std::string result;
    for (const char c : name) result += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return result;
  }

  static std::optional<Node> member(const Node& node, const char* name) {
    const auto found = node.json.find(name);
    if (found == node.json.end()) return {};
    return Node{*found, node.pointer + "/" + escaped(name)};
  }

  void requireObject(const Node& node) const {
    if (!node.json.is_object()) fail(node, fmt::format("must be an object, but is {}", kindOf(node)));
  }

  static std::string_view kindOf(const Node& node) {
    switch (node.json.type()) {
      case GroupsJson::value_t::null: return "null";
      case GroupsJson::value_t::object: return "an object";
      case GroupsJson::value_t::array: return "an array";
      case GroupsJson::value_t::string: return "a string";
      case GroupsJson::value_t::boolean: return "a boolean";
      default: return "a number";
    }
  }

  void checkMembers(const Node& node, std::initializer_list<std::string> known) const {
    for (const auto& [name, value] : node.json.items()) {
      if (std::ranges::find(known, name) != known.end()) continue;
      const std::vector<std::string> names(known);
      fail({value, node.pointer + "/" + escaped(name)},
           fmt::format("unknown member '{}'{}", printable(name), suggestion(name, names)));
    }
  }

  std::vector<Node> elements(const Node& node) const {
    if (!node.json.is_array()) fail(node, fmt::format("must be an array, but is {}", kindOf(node)));
    if (node.json.size() > kMaxRecords) fail(node, fmt::format("has more than {} elements", kMaxRecords));
    std::vector<Node> result;
    for (std::size_t i = 0; i < node.json.size(); ++i)
      result.push_back({node.json[i], fmt::format("{}/{}", node.pointer, i)});
    return result;
  }

  std::string text(const Node& node) const {
    if (!node.json.is_string()) fail(node, fmt::format("must be a string, but is {}", kindOf(node)));
    return node.json.get<std::string>();
  }

  bool boolean(const Node& node) const {
    if (!node.json.is_boolean()) fail(node, fmt::format("must be true or false, but is {}", kindOf(node)));
    return node.json.get<bool>();
  }

  std::uint32_t integer(const Node& node, std::uint32_t min, std::uint32_t max) const {
    const bool valid = node.json.is_number_unsigned() && node.json.get<std::uint64_t>() >= min &&
                       node.json.get<std::uint64_t>() <= max;
    if (!valid) fail(node, fmt::format("must be an integer between {} and {}", min, max));
    return node.json.get<std::uint32_t>();
  }

  // "file.spv" or "file.spv#entry". Returns the name under which the pipeline has the stage; empty for null.
  std::string stage(const Node& node, DescribedPipeline& pipeline) const {
    if (node.json.is_null()) return {};
    const std::string name = text(node);
    if (name.empty()) fail(node, "must name a module; write null for a record without a shader");
    const std::size_t mark = name.rfind('#');
    StageName stage{name.substr(0, mark), mark == name.npos ? "" : name.substr(mark + 1), node.pointer};
    if (stage.module.empty()) fail(node, fmt::format("'{}' names no module", printable(name)));
    pipeline.stages.try_emplace(name, std::move(stage));
    return name;
  }

  // A stage of a record: "file.spv", null, or { "module": "file.spv", "record": [ … ] }.
  std::string recordStage(const Node& node, DescribedPipeline& pipeline, RecordData& data) const {
    if (!node.json.is_object()) return stage(node, pipeline);
    checkMembers(node, {"module", "record"});
    if (const auto record = member(node, "record")) data = recordData(*record);
    const auto module = member(node, "module");
    if (!module) fail(node, "'module' is missing; name the module of the record");
    return stage(*module, pipeline);
  }

  // The words after the handle.
  RecordData recordData(const Node& node) const {
    constexpr std::size_t kMaxWords = 1024;  // 4096 bytes, the largest stride
    const std::vector<Node> words = elements(node);
    if (words.size() > kMaxWords) fail(node, fmt::format("has more than {} elements", kMaxWords));
    RecordData data(words.size() * sizeof(std::uint32_t));
    for (std::size_t i = 0; i < words.size(); ++i) {
      const std::uint32_t word = bitsOf(words[i]).front();
      std::memcpy(data.data() + i * sizeof word, &word, sizeof word);
    }
    return data;
  }

  void addDescriptors(const Node& node, PipelineGroups& groups) const {
    for (const Node& element : elements(node)) {
      requireObject(element);
      checkMembers(element, {"set", "binding", "count"});
      const auto number = [&](const char* name, std::uint32_t min) {
        const auto found = member(element, name);
        if (!found) fail(element, fmt::format("'{}' is missing", name));
        return integer(*found, min, std::numeric_limits<std::uint32_t>::max());
      };
      const DescriptorSlot slot{number("set", 0), number("binding", 0)};
      if (!groups.descriptorCounts.emplace(slot, number("count", 1)).second)
        fail(element, fmt::format("set {} and binding {} are listed twice", slot.first, slot.second));
    }
  }

  DescribedPipeline pipeline(const Node& node) const {
    requireObject(node);
    checkMembers(node, {"name", "recursion_depth", "ray_generation", "miss", "hit", "callable", "specialization",
                        "instances", "descriptors"});
    DescribedPipeline result;
    PipelineGroups& groups = result.groups;
    groups.noun = "pipeline";
    groups.rays = {""};
    groups.hitRecords = HitRecords::byRecord;
    groups.descriptionFile = file_.string();
    if (const auto name = member(node, "name")) result.name = text(*name);
    if (const auto depth = member(node, "recursion_depth")) groups.declaredRecursion = integer(*depth, 0, 1u << 16);
    if (groups.declaredRecursion == 0u) groups.declaredRecursion = 1;  // 0 allows only the rays of ray generation
    const auto generation = member(node, "ray_generation");
    if (!generation) fail(node, "'ray_generation' is missing; name the module of the ray generation shader");
    const auto addGeneration = [&](const Node& element) {
      RecordData data;
      const std::string name = recordStage(element, result, data);
      if (name.empty()) fail(element, "must name a module");
      groups.rayGenerations.push_back(name);
      if (!data.empty()) groups.recordData.rayGeneration[name] = std::move(data);
    };
    if (generation->json.is_array())
      for (const Node& element : elements(*generation)) addGeneration(element);
    else
      addGeneration(*generation);
    if (const auto misses = member(node, "miss"))
      for (const Node& element : elements(*misses))
        groups.misses.push_back({{}, recordStage(element, result, groups.recordData.misses.emplace_back()), {}, 0});
    if (const auto callables = member(node, "callable"))
      for (const Node& element : elements(*callables))
        groups.callables.push_back(
            {{}, recordStage(element, result, groups.recordData.callables.emplace_back()), {}, 0});
    if (const auto hits = member(node, "hit"))
      for (const Node& element : elements(*hits)) addHitGroup(element, result);
    if (const auto values = member(node, "specialization")) addSpecialization(*values, result);
    if (const auto instances = member(node, "instances")) addInstances(*instances, groups);
    if (const auto descriptors = member(node, "descriptors")) addDescriptors(*descriptors, groups);
    return result;
  }

  void addHitGroup(const Node& node, DescribedPipeline& pipeline) const {
    program::HitGroup group;
    group.name = std::to_string(pipeline.groups.hitGroups.size());
    program::HitShaders& shaders = group.shaders[""];
    RecordData& data = pipeline.groups.recordData.hits.emplace_back();
    if (!node.json.is_null()) {
      requireObject(node);
      checkMembers(node, {"name", "closest_hit", "any_hit", "intersection", "record"});
      if (const auto name = member(node, "name")) group.name = text(*name);
      if (const auto closest = member(node, "closest_hit")) shaders.closestHit = stage(*closest, pipeline);
      if (const auto any = member(node, "any_hit")) shaders.anyHit = stage(*any, pipeline);
      if (const auto intersection = member(node, "intersection")) shaders.intersection = stage(*intersection, pipeline);
      if (const auto record = member(node, "record")) data = recordData(*record);
    }
    pipeline.groups.hitGroups.push_back(std::move(group));
  }

  void addSpecialization(const Node& node, DescribedPipeline& pipeline) const {
    requireObject(node);
    for (const auto& [module, constants] : node.json.items()) {
      const Node ofModule{constants, node.pointer + "/" + escaped(module)};
      requireObject(ofModule);
      const bool used = std::ranges::any_of(
          pipeline.stages, [&name = module](const auto& stage) { return stage.second.module == name; });
      if (!used) fail(ofModule, fmt::format("no group uses the module '{}'", printable(module)));
      shader::SpecializationValues& values = pipeline.specialization[module];
      for (const auto& [id, value] : constants.items()) {
        const Node constant{value, ofModule.pointer + "/" + escaped(id)};
        const bool digits =
            !id.empty() && id.size() < 10 && std::ranges::all_of(id, [](char c) { return c >= '0' && c <= '9'; });
        if (!digits)
          fail(constant, fmt::format("'{}' is not a constant_id; write a number such as \"0\"", printable(id)));
        values[static_cast<std::uint32_t>(std::stoul(id))] = bitsOf(constant);
      }
    }
  }

  // Numbers without a point are integers, others are floats of 32 bits.
  std::vector<std::uint32_t> bitsOf(const Node& node) const {
    if (node.json.is_boolean()) return {node.json.get<bool>() ? 1u : 0u};
    if (node.json.is_number_float()) return {std::bit_cast<std::uint32_t>(node.json.get<float>())};
    if (node.json.is_number_integer()) {
      const bool fits = node.json.is_number_unsigned()
                            ? node.json.get<std::uint64_t>() <= std::numeric_limits<std::uint32_t>::max()
                            : node.json.get<std::int64_t>() >= std::numeric_limits<std::int32_t>::min();
      if (fits) return {static_cast<std::uint32_t>(node.json.get<std::int64_t>())};
    }
    fail(node, "must be a boolean, an integer of 32 bits, or a number with a decimal point for a float");
  }

  void addInstances(const Node& node, PipelineGroups& groups) const {
    groups.instances.emplace();
    for (const Node& element : elements(node)) {
      requireObject(element);
      checkMembers(element, {"name", "record_offset", "mask", "custom_index", "force_opaque", "force_no_opaque",
                             "transformed", "geometries"});
      InstanceRecords instance;
      instance.facts.name = std::to_string(groups.instances->size());
      if (const auto name = member(element, "name")) instance.facts.name = text(*name);
      if (const auto offset = member(element, "record_offset"))
        instance.recordOffset = integer(*offset, 0, (1u << 24) - 1);
      if (const auto mask = member(element, "mask")) instance.facts.mask = integer(*mask, 0, 255);
      if (const auto index = member(element, "custom_index")) {
        instance.facts.customIndex = integer(*index, 0, (1u << 24) - 1);
        instance.hasCustomIndex = true;
      }
      if (const auto opaque = member(element, "force_opaque")) instance.facts.forceOpaque = boolean(*opaque);
      if (const auto opaque = member(element, "force_no_opaque")) instance.facts.forceNoOpaque = boolean(*opaque);
      if (const auto moved = member(element, "transformed")) instance.facts.transformed = boolean(*moved);
      if (instance.facts.forceOpaque && instance.facts.forceNoOpaque)
        fail(element, "force_opaque and force_no_opaque exclude each other");
      instance.facts.firstGeometry = static_cast<std::uint32_t>(groups.geometries.size());
      const auto geometries = member(element, "geometries");
      if (!geometries)
        fail(element, "'geometries' is missing; list the geometries of the instance's acceleration structure");
      for (const Node& geometry : elements(*geometries)) groups.geometries.push_back(geometryOf(geometry));
      if (groups.geometries.size() > kMaxGeometries)
        fail(*geometries, fmt::format("more than {} geometries", kMaxGeometries));
      instance.facts.geometryCount =
          static_cast<std::uint32_t>(groups.geometries.size()) - instance.facts.firstGeometry;
      groups.instances->push_back(std::move(instance));
    }
  }

  program::GeometryFacts geometryOf(const Node& node) const {
    requireObject(node);
    checkMembers(node, {"type", "opaque"});
    const auto type = member(node, "type");
    if (!type) fail(node, "'type' is missing; write \"triangles\" or \"aabbs\"");
    program::GeometryFacts facts;
    const std::string name = text(*type);
    if (name == "aabbs")
      facts.kind = program::GeometryKind::custom;
    else if (name != "triangles")
      fail(*type, fmt::format("unknown type '{}'; write \"triangles\" or \"aabbs\"", printable(name)));
    const auto opaque = member(node, "opaque");
    facts.alpha = !opaque || !boolean(*opaque);
    return facts;
  }

  const std::filesystem::path& file_;
};

}  // namespace

std::vector<DescribedPipeline> parseGroups(const std::filesystem::path& file, std::string_view text) {
  GroupsJson json;
  try {
    json = parseJson<GroupsJson>(file, text, {.comments = true});
  } catch (const GroupsJson::parse_error& error) {
    throw FileError(file, fmt::format("byte {}", error.byte), "this is not valid JSON");
  }
  return GroupsReader(file).read(json);
}

}  // namespace quintet::check
