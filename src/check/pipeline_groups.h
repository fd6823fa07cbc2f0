// SPDX-License-Identifier: Apache-2.0
// The shader groups that the graph links: those of a program's description, of a groups.json file, or of a pipeline that an
// application creates. Plain data, without anything that only Quintet's programs have (layout of the shader binding table,
// bindings of hit groups to geometry, parameters, outputs).
#ifndef QUINTET_CHECK_PIPELINE_GROUPS_H
#define QUINTET_CHECK_PIPELINE_GROUPS_H

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "program/description/program.h"
#include "program/scene_facts.h"

namespace quintet::check {

// Which records of the hit table a trace uses.
enum class HitRecords {
  byRayType,  // Quintet's layout: each geometry has one record per ray type, and the offset of a trace is its ray type
  byRecord,   // any layout: offset + stride * geometry + the instance's offset
};

// An instance of an acceleration structure that an application builds.
struct InstanceRecords {
  program::InstanceFacts facts;    // its geometries are a range of PipelineGroups::geometries
  std::uint32_t recordOffset = 0;  // instanceShaderBindingTableRecordOffset
  bool hasCustomIndex = false;     // facts.customIndex is known
};

// Data of the records of a shader binding table, after their handles. An empty one is unknown.
using RecordData = std::vector<std::byte>;
struct TableData {
  std::map<std::string, RecordData> rayGeneration;  // by stage
  std::vector<RecordData> misses, hits, callables;  // in the order of the records; further records are unknown
};

// Set and binding of a variable of a shader.
using DescriptorSlot = std::pair<std::uint32_t, std::uint32_t>;
// Number of descriptors; bindings that are missing are unknown.
using DescriptorCounts = std::map<DescriptorSlot, std::uint32_t>;

struct PipelineGroups {
  std::string noun = "program";             // what messages call the whole: "program", "pipeline"
  std::vector<std::string> rayGenerations;  // stages
  std::vector<program::MissShader> misses;
  std::vector<program::HitGroup> hitGroups;
  std::vector<program::Callable> callables;
  std::vector<std::string> rays;  // keys of HitGroup::shaders; with byRecord one without a name
  std::optional<std::uint32_t> declaredRecursion;

  HitRecords hitRecords = HitRecords::byRayType;
  // The lists are the records of the shader binding table in their order. If not, they are in any order, and an index
  // selects one of them that is unknown unless there is only one.
  bool tablesKnown = true;
  // False if it is unknown which stages form a hit group.
  bool groupsKnown = true;
  bool hasIntersections = false;  // without known groups: some stage is an intersection shader
  // With byRecord: what rays can hit. Without, a hit uses one of the hit groups that is unknown unless there is only one.
  std::optional<std::vector<InstanceRecords>> instances = {};
  std::vector<program::GeometryFacts> geometries = {};
  TableData recordData = {};               // if tablesKnown
  DescriptorCounts descriptorCounts = {};  // of the pipeline layout

  std::string origin;                             // folder of the stages' files; empty if their names are paths
  std::string descriptionFile;                    // that declares the groups; lines of the groups refer to it
  std::map<std::string, std::string> files = {};  // texts by name, relative to `origin`

  std::string path(const std::string& file) const {
    return program::isLibraryStage(file) || origin.empty() ? file : origin + "/" + file;
  }
};

// True if the hit group can be for boxes.
bool mayBeProcedural(const PipelineGroups& groups, const program::HitGroup& group);

PipelineGroups groupsOf(const program::Program& program);

// Returns the groups without those that have the shaders of an earlier one. For tables in an unknown order, where they add nothing:
// engines create thousands of hit groups that differ only in the data of their records.
PipelineGroups withoutRepeatedGroups(PipelineGroups groups);

}  // namespace quintet::check
#endif
