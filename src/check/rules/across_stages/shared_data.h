// SPDX-License-Identifier: Apache-2.0
// Helpers of the rules about payloads, callable data and hit attributes.
#ifndef QUINTET_CHECK_RULES_SHARED_DATA_H
#define QUINTET_CHECK_RULES_SHARED_DATA_H

#include "check/pipeline_graph.h"

namespace quintet::check {

// A message about a part of a variable: before + "'payload.color'" + after + " (line 12)" + end.
struct LeafText {
  std::string before, after, end;
  bool operator==(const LeafText&) const = default;
};

// Leaves with the same message.
struct LeafGroup {
  LeafText text;
  std::vector<std::uint32_t> leaves;
  std::size_t read = 0;  // first read, in StageFacts::accesses()
};

void addTo(std::vector<LeafGroup>& groups, LeafText text, std::uint32_t leaf, std::size_t read);

// "'payload.color'" for the part ".color".
std::string nameOf(const spirv::SharedVariable& variable, const std::string& part);

SourceLocation locationOf(const spirv::StageFacts& facts, const spirv::AccessFacts& access);

// " (line 12)", or " (file:12)" if the access is not in `file`; empty if its line is unknown.
std::string readLine(const spirv::StageFacts& facts, std::size_t access, const std::string& file);

// For each edge, whether the stage receives the type that is sent. True if it receives nothing.
std::vector<bool> sameTypes(const PipelineGraph& graph, std::span<const Edge> edges, const spirv::StageFacts& sender,
                            const spirv::SharedVariable& sent, spv::StorageClass incoming);

// True if the stage writes memory or images, traces or calls.
bool hasEffects(const spirv::StageFacts& facts);

// The line of main() in the source of a stage; only the file if it is not found.
SourceLocation mainLocation(const PipelineGraph& graph, const PipelineStage& stage);

}  // namespace quintet::check
#endif
