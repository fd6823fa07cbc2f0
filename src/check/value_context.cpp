// SPDX-License-Identifier: Apache-2.0
#include "check/value_context.h"

#include <algorithm>
#include <set>
#include <utility>

#include "check/library_names.h"
#include "program/hit_group_binding.h"
#include "spirv/access.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using program::Parameter;
using program::ParameterType;
using spirv::Occurrence;
using spirv::ValueRange;

constexpr std::string_view kParameters = "Parameters", kInstances = "InstanceData",
                           kPrimitiveIndices = "PrimitiveIndexArray";
constexpr std::string_view kRecord = "Record";
constexpr double kMaxPrimitive = 536870911.0;  // Vulkan's limit of gl_PrimitiveID

// Sets the values of a member of a structure of the library, in both forms of programs.
void setMember(spirv::ValueContext& context, std::string_view structure, const std::string& member,
               const std::vector<ValueRange>& ranges) {
  context.members[{std::string(structure), member}] = ranges;
  context.members[{lectureName(structure), member}] = ranges;
}

ValueRange amongAll(const std::set<double>& values) {
  if (values.empty()) return {};
  if (values.size() <= ValueRange::kMaxValues)
    return ValueRange::among({values.begin(), values.end()}, Occurrence::each);
  return ValueRange::between(*values.begin(), *values.rbegin(), Occurrence::each);
}

std::vector<ValueRange> allValues(const Parameter& parameter) {
  if (parameter.type == ParameterType::image) return {};
  if (parameter.type == ParameterType::boolean) return {amongAll({0.0, 1.0})};
  if (parameter.type == ParameterType::choice) {
    std::set<double> values;
    for (std::size_t i = 0; i < parameter.choices.size(); ++i) values.insert(static_cast<double>(i));
    return {amongAll(values)};
  }
  const auto [low, high] = program::typeRange(parameter.type);
  const bool declared = program::hasMin(parameter) && program::hasMax(parameter);
  return {ValueRange::between(std::max(low, parameter.min), std::min(high, parameter.max),
                              declared ? Occurrence::each : Occurrence::unknown)};
}

std::vector<ValueRange> valuesOf(const Parameter& parameter, const program::ParameterValue& value) {
  if (parameter.type == ParameterType::image) return {};
  std::vector<ValueRange> result;
  for (int i = 0; i < program::componentCount(parameter.type); ++i)
    result.push_back(ValueRange::of(value[static_cast<std::size_t>(i)]));
  return result;
}

bool uses(const program::HitShaders& shaders, const std::string& file) {
  return shaders.closestHit == file || shaders.anyHit == file || shaders.intersection == file;
}

// The record data of a stage, one entry for each record that it runs with.
std::vector<const program::RecordValues*> recordsOf(const program::Program& program, const std::string& file) {
  std::vector<const program::RecordValues*> records;
  if (program.rayGeneration == file) records.push_back(&program.rayGenerationRecord);
  for (const program::RayType& ray : program.rays)
    if (ray.miss == file) records.push_back(&ray.record);
  for (const program::MissShader& miss : program.misses)
    if (miss.file == file) records.push_back(&miss.record);
  for (const program::Callable& callable : program.callables)
    if (callable.file == file) records.push_back(&callable.record);
  for (const program::HitGroup& group : program.hitGroups)
    for (const auto& [ray, shaders] : group.shaders)
      if (uses(shaders, file)) records.push_back(&shaders.record);
  return records;
}

void addRecords(const program::Program& program, const std::string& file, spirv::ValueContext& context) {
  const std::vector<const program::RecordValues*> records = recordsOf(program, file);
  if (records.empty()) return;
  for (std::size_t i = 0; i < program.record.size(); ++i) {
    const Parameter& field = program.record[i];
    if (field.type == ParameterType::image) continue;
    std::vector<std::set<double>> values(static_cast<std::size_t>(program::componentCount(field.type)));
    for (const program::RecordValues* record : records)
      for (std::size_t c = 0; c < values.size(); ++c)
        values[c].insert(i < record->size() ? (*record)[i][c] : field.defaultValue[c]);
    std::vector<ValueRange>& ranges = context.members[{std::string(kRecord), field.name}];
    for (const std::set<double>& component : values) ranges.push_back(amongAll(component));
  }
}

// The hit groups that use a stage. Limits the kinds and attributes of its hits.
std::set<std::size_t> addHitGroups(const std::vector<program::HitGroup>& hitGroups, const std::string& file,
                                   spirv::ValueContext& context) {
  std::set<std::size_t> groups;
  for (std::size_t i = 0; i < hitGroups.size(); ++i)
    for (const auto& [ray, shaders] : hitGroups[i].shaders)
      if (uses(shaders, file)) groups.insert(i);
  if (groups.empty()) return groups;
  const auto procedural = [&](std::size_t group) { return program::hasIntersection(hitGroups[group]); };
  if (std::ranges::all_of(groups, procedural))
    context.builtIns[spv::BuiltIn::HitKindKHR] = ValueRange::between(0.0, 255.0);
  if (std::ranges::none_of(groups, procedural)) context.hitAttribute = ValueRange::between(0.0, 1.0);  // barycentrics
  return groups;
}

// Built-ins of the hits for which a stage of a hit group runs.
void addHits(const program::Program& program, const std::string& file, const program::SceneFacts* scene,
             spirv::ValueContext& context) {
  const std::set<std::size_t> groups = addHitGroups(program.hitGroups, file, context);
  if (groups.empty() || !scene) return;
  std::set<double> instances, geometries, all;
  for (std::size_t i = 0; i < scene->instances.size(); ++i) {
    const program::InstanceFacts& instance = scene->instances[i];
    all.insert(static_cast<double>(i));
    for (std::uint32_t k = 0; k < instance.geometryCount && instance.firstGeometry + k < scene->geometries.size(); ++k)
      if (groups.contains(program::hitGroupFor(program, scene->geometries[instance.firstGeometry + k])))
        instances.insert(static_cast<double>(i)), geometries.insert(k);
  }
  if (instances.empty()) return;
  context.builtIns[spv::BuiltIn::InstanceCustomIndexKHR] = amongAll(instances);
  context.builtIns[spv::BuiltIn::RayGeometryIndexKHR] = amongAll(geometries);
  ValueRange ids = amongAll(program.keepsInstanceOrder ? instances : all);
  if (!program.keepsInstanceOrder && instances != all) ids.occurrence = Occurrence::unknown;
  context.builtIns[spv::BuiltIn::InstanceId] = ids;
  std::set<double> custom;
  for (const double i : instances) custom.insert(scene->instances[static_cast<std::size_t>(i)].customIndex);
  // Shaders can also read the data of other instances.
  setMember(context, kInstances, "customIndex", {instances == all ? amongAll(custom) : ValueRange{}});
}

// Returns the name of the parameter that the load reads; empty if it reads none.
std::string parameterOf(const spirv::Module& module, const spirv::Instruction& load) {
  const auto member = spirv::bufferMember(module, load);
  return member && libraryName(member->structure) == kParameters ? member->member : "";
}

}  // namespace

spirv::ValueContext valueContext(const program::Program& program, const std::string& file,
                                 const program::SceneFacts* scene, ParameterUse parameters) {
  spirv::ValueContext context;
  for (const Parameter& parameter : program.parameters) {
    const bool defaults = parameters == ParameterUse::defaults;
    setMember(context, kParameters, parameter.name,
              defaults ? valuesOf(parameter, parameter.defaultValue) : allValues(parameter));
  }
  setMember(context, kPrimitiveIndices, "at", {ValueRange::between(0.0, kMaxPrimitive)});
  addRecords(program, file, context);
  addHits(program, file, scene, context);
  return context;
}

spirv::ValueContext groupContext(const std::vector<program::HitGroup>& hitGroups, const std::string& file) {
  spirv::ValueContext context;
  addHitGroups(hitGroups, file, context);
  return context;
}

void addCustomIndices(const std::set<double>& indices, bool each, spirv::ValueContext& context) {
  if (indices.empty()) return;
  ValueRange range = amongAll(indices);
  if (!each) range.occurrence = Occurrence::unknown;
  context.builtIns[spv::BuiltIn::InstanceCustomIndexKHR] = range;
}

void addGeometryIndices(const std::set<double>& indices, spirv::ValueContext& context) {
  if (!indices.empty()) context.builtIns[spv::BuiltIn::RayGeometryIndexKHR] = amongAll(indices);
}

DefaultRanges::DefaultRanges(spirv::ValueContext context, const spirv::Module& module)
    : module_(module), ranges_(module, std::move(context)) {}

std::string DefaultRanges::parameters(std::initializer_list<spirv::Id> values) const {
  std::set<std::string> found;
  for (const spirv::Id value : values)
    (void)spirv::dependsOn(module_, value, [&](const spirv::Instruction& i) {
      if (const std::string name = parameterOf(module_, i); !name.empty()) found.insert("'" + name + "'");
      return false;
    });
  std::string text;
  for (const std::string& name : found) text += (text.empty() ? "" : name == *found.rbegin() ? " and " : ", ") + name;
  return found.empty() ? "" : (found.size() > 1 ? "parameters " : "parameter ") + text;
}

}  // namespace quintet::check
