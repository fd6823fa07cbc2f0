// SPDX-License-Identifier: Apache-2.0
// Hit records of pipelines with a layout of their own. Q515: records beyond the hit table. Q609: geometry and the kind of its
// hit group. Q610: any-hit shaders that the ray flags or the geometry exclude.
#include <fmt/format.h>

#include <vector>

#include "base/plural.h"
#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"

namespace quintet::check {
namespace {

constexpr std::uint32_t kMaskOfInstance = 0xFF, kLargestOffset = 0xF;

class RecordRule {
 public:
  RecordRule(const CheckInput& input, Report& report)
      : graph_(input.graph), groups_(input.graph.groups), report_(report) {}

  void check() {
    if (groups_.hitRecords != HitRecords::byRecord) return;
    std::vector<bool> correct(graph_.targets.size(), false);  // equal traces use the same records
    for (const TraceSite& site : graph_.traces)
      if (!correct[site.targets] && !site.isExecution()) correct[site.targets] = checkTrace(site);
    if (!groups_.groupsKnown || !graph_.error.empty()) return;
    findAnyHits();
    for (std::size_t group = 0; group < groups_.hitGroups.size(); ++group) checkAnyHit({group, 0});
  }

 private:
  // Returns false if a record is reported.
  bool checkTrace(const TraceSite& site) {
    const spirv::TraceFacts& trace = *site.trace;
    bool correct = true;
    if (!groups_.instances || !groups_.tablesKnown || !trace.offset.certain() || !trace.stride.certain()) return true;
    for (const std::uint32_t offset : trace.offset.values)
      for (const std::uint32_t stride : trace.stride.values)
        if (offset <= kLargestOffset && stride <= kLargestOffset)  // Q503
          correct = checkRecords(site, offset, stride) && correct;
    return correct;
  }

  bool checkRecords(const TraceSite& site, std::uint32_t offset, std::uint32_t stride) {
    const spirv::TraceFacts& trace = *site.trace;
    for (const InstanceRecords& instance : *groups_.instances) {
      if (!trace.mask.mayHave(instance.facts.mask & kMaskOfInstance)) continue;
      for (std::uint32_t k = 0; k < instance.facts.geometryCount; ++k) {
        const program::GeometryFacts& geometry = groups_.geometries[instance.facts.firstGeometry + k];
        if (trace.flags.mustHave(geometry.procedural() ? kFlagSkipAabbs : kFlagSkipTriangles)) continue;
        const std::size_t record = std::size_t{instance.recordOffset} + std::size_t{k} * stride + offset;
        if (!checkRecord(site, instance, k, record)) return false;
      }
    }
    return true;
  }

  // Returns false if the record is reported.
  bool checkRecord(const TraceSite& site, const InstanceRecords& instance, std::uint32_t k, std::size_t record) {
    const std::size_t count = groups_.hitGroups.size();
    const std::string where = fmt::format("geometry {} of instance '{}'", k, instance.facts.name);
    if (record >= count) {
      report_.add("Q515", graph_.location(site),
                  fmt::format("{} uses hit record {} with this trace, but the table has {}", where, record,
                              counted(count, "record")));
      return false;
    }
    const program::HitShaders& shaders = graph_.shaders({record, 0});
    const bool empty = shaders.closestHit.empty() && shaders.anyHit.empty() && shaders.intersection.empty();
    const bool procedural = groups_.geometries[instance.facts.firstGeometry + k].procedural();
    if (empty || procedural != shaders.intersection.empty()) return true;
    report_.add("Q609", graph_.location(site),
                fmt::format("{} has {} and uses {} (record {}) with this trace, which has {} intersection shader",
                            where, procedural ? "boxes" : "triangles", graph_.describe(HitGroupRay{record, 0}), record,
                            procedural ? "no" : "an"));
    return false;
  }

  // By hit group: whether traces can hit it, and whether one of them can run its any-hit shader.
  void findAnyHits() {
    hasTrace_.assign(groups_.hitGroups.size(), false);
    runs_ = hasTrace_;
    std::vector<bool> known(graph_.targets.size(), false);
    for (const TraceSite& site : graph_.traces) {
      if (known[site.targets] || site.isExecution()) continue;  // the search runs any-hit shaders
      known[site.targets] = true;
      const spirv::ArgumentValues& flags = site.trace->flags;
      const bool runs = !flags.mustHave(kFlagOpaque) && !flags.mustHave(kFlagCullNoOpaque);
      for (const HitGroupRay hit : site.hits) {
        hasTrace_[hit.group] = true;
        if (runs) runs_[hit.group] = true;
      }
    }
  }

  // Q610
  void checkAnyHit(HitGroupRay hit) {
    const PipelineStage* stage = graph_.stage(graph_.shaders(hit).anyHit);
    if (!stage || !hasTrace_[hit.group] || runs_[hit.group]) return;
    report_.addOncePerLine(
        "Q610", mainLocation(graph_, *stage),
        fmt::format("any-hit shader '{}' of {} never runs: all traces that can hit it have gl_RayFlagsOpaqueEXT or "
                    "gl_RayFlagsCullNoOpaqueEXT",
                    stage->file, graph_.describe(hit)));
  }

  const PipelineGraph& graph_;
  const PipelineGroups& groups_;
  Report& report_;
  std::vector<bool> hasTrace_, runs_;  // by hit group
};

}  // namespace

void checkHitRecords(const CheckInput& input, Report& report) { RecordRule(input, report).check(); }

}  // namespace quintet::check
