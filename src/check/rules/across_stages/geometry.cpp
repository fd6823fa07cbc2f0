// SPDX-License-Identifier: Apache-2.0
// Q601 to Q604: hit groups and the geometry that uses them.
#include <fmt/format.h>

#include <algorithm>

#include "check/rules/across_stages/binding_names.h"
#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"

namespace quintet::check {
namespace {

bool binds(const program::HitGroup& group, std::string_view geometryClass) {
  return std::ranges::find(group.geometry, geometryClass) != group.geometry.end();
}

bool bindsProcedural(const program::HitGroup& group) {
  return binds(group, "solids") || binds(group, "csg") || binds(group, "custom") || binds(group, "procedural");
}

bool bindsOnly(const program::HitGroup& group, std::string_view geometryClass) {
  return group.geometry.size() == 1 && group.geometry[0] == geometryClass && group.material.empty() &&
         group.primitives.empty();
}

// A trace and a geometry that it can hit, with the hit record that it uses.
struct TraceGeometryPair {
  const TraceSite* site = nullptr;
  const program::InstanceFacts* instance = nullptr;
  const program::GeometryFacts* geometry = nullptr;
  HitGroupRay hit;
  bool opaque = false;     // certainly: no any-hit shader runs
  bool notOpaque = false;  // certainly
  bool misplaced = false;  // the name in a binding is misspelled, and only that is reported (Q802)
};

class GeometryRule {
 public:
  GeometryRule(const ProgramInput& input, Report& report)
      : input_(input), graph_(input.graph), program_(input.program), report_(report) {}

  void check() {
    for (std::size_t group = 0; group < program_.hitGroups.size(); ++group) checkBinding(group);
    if (input_.scene) {
      collectPairs();
      for (const TraceGeometryPair& pair : pairs_)
        if (!pair.misplaced) checkKind(pair);
    } else {
      assumePairs();
    }
    checkAlphaTests();
    checkAnyHits();
  }

 private:
  const program::HitGroup& groupOf(HitGroupRay hit) const { return program_.hitGroups[hit.group]; }

  bool isTraced(std::size_t ray, std::uint32_t skipFlag) const {
    return std::ranges::any_of(graph_.traces, [&](const TraceSite& site) {
      return !site.trace->flags.mustHave(skipFlag) &&
             std::ranges::any_of(site.hits, [&](HitGroupRay hit) { return hit.ray == ray; });
    });
  }

  // The line of the description. The lecture form has none: there it is the any-hit shader, or else the file.
  SourceLocation location(HitGroupRay hit) const {
    const program::HitShaders& shaders = graph_.shaders(hit);
    const int line = shaders.line > 0 ? shaders.line : groupOf(hit).line;
    const PipelineStage* anyHit = graph_.stage(shaders.anyHit);
    return line == 0 && anyHit ? mainLocation(graph_, *anyHit) : graph_.descriptionLocation(line);
  }

  // Q601, Q602: contradictions in the group itself.
  void checkBinding(std::size_t index) {
    const program::HitGroup& group = program_.hitGroups[index];
    const bool procedural = graph_.hasIntersection(index);
    if (procedural && binds(group, "triangles"))
      report_.add("Q602", graph_.descriptionLocation(group.line),
                  fmt::format("hit group '{}' is bound to triangles but has an intersection shader", group.name));
    for (std::size_t ray = 0; ray < graph_.rayCount(); ++ray) {
      const HitGroupRay hit{index, ray};
      if ((!procedural && !bindsProcedural(group)) || !graph_.shaders(hit).intersection.empty() ||
          !isTraced(ray, kFlagSkipAabbs))
        continue;
      report_.add("Q601", location(hit),
                  fmt::format("{} has no intersection shader, but {}", graph_.describe(hit),
                              procedural ? "the group has one for a different ray type, and these rays are traced"
                                         : "the group is bound to procedural geometry"));
    }
  }

  // The trace and the geometry meet here.
  std::vector<RelatedLocation> traceOf(const TraceGeometryPair& pair) const {
    return {relatedTo(graph_.location(*pair.site), "this trace uses the hit group")};
  }

  void collectPairs() {
    const program::SceneFacts& scene = *input_.scene;
    unknownNames_ = unknownNames(program_, scene);
    for (const TraceSite& site : graph_.traces)
      for (const program::InstanceFacts& instance : scene.instances)
        for (std::uint32_t k = 0; k < instance.geometryCount && instance.firstGeometry + k < scene.geometries.size();
             ++k)
          if (site.trace->mask.mayHave(instance.mask & 0xFFu)) addPairs(site, instance, k);
  }

  void addPairs(const TraceSite& site, const program::InstanceFacts& instance, std::uint32_t k) {
    const spirv::TraceFacts& trace = *site.trace;
    const program::SceneFacts& scene = *input_.scene;
    const program::GeometryFacts& geometry = scene.geometries[instance.firstGeometry + k];
    if (program_.hitGroups.empty() || trace.flags.mustHave(geometry.procedural() ? kFlagSkipAabbs : kFlagSkipTriangles))
      return;
    TraceGeometryPair pair{&site, &instance, &geometry, {}, false, false};
    pair.misplaced = isMisplaced(geometry, unknownNames_);
    const bool builtOpaque = (geometry.opaque() && !instance.forceNoOpaque) || instance.forceOpaque;
    pair.opaque = (builtOpaque && !trace.flags.mayHave(kFlagNoOpaque)) || trace.flags.mustHave(kFlagOpaque);
    pair.notOpaque = (!builtOpaque && !trace.flags.mayHave(kFlagOpaque)) || trace.flags.mustHave(kFlagNoOpaque);
    if ((pair.opaque && trace.flags.mustHave(kFlagCullOpaque)) ||
        (pair.notOpaque && trace.flags.mustHave(kFlagCullNoOpaque)))
      return;
    // With a stride of 0, all geometries of the instance use the records of the first one. Q511 reports geometries that
    // need other records.
    for (const std::size_t ray : graph_.rayTypes(trace)) {
      pair.hit = {program::hitGroupFor(program_, geometry), ray};
      pairs_.push_back(pair);
    }
  }

  // Without a scene, assumes the geometry that each group is bound to.
  void assumePairs() {
    static const program::InstanceFacts kInstance;
    static const program::GeometryFacts kOpaque, kAlpha{program::GeometryKind::triangles, true, {}, {}};
    for (const TraceSite& site : graph_.traces) {
      for (const HitGroupRay hit : site.hits) {
        const bool alpha = program_.anyHitForAll || !bindsOnly(groupOf(hit), "opaque");
        const spirv::ArgumentValues& flags = site.trace->flags;
        TraceGeometryPair pair{&site, &kInstance, alpha ? &kAlpha : &kOpaque, hit, false, false};
        pair.opaque = flags.mustHave(kFlagOpaque) || (!alpha && !flags.mayHave(kFlagNoOpaque));
        pair.notOpaque = !pair.opaque;
        pairs_.push_back(pair);
      }
    }
  }

  std::string describe(const TraceGeometryPair& pair) const {
    const std::string& name = pair.geometry->name.empty() ? pair.instance->name : pair.geometry->name;
    return fmt::format("{} '{}' of {}", pair.geometry->procedural() ? "procedural geometry" : "triangle geometry", name,
                       input_.scene->name);
  }

  // Q601, Q602: triangles with an intersection shader, procedural geometry without one.
  void checkKind(const TraceGeometryPair& pair) {
    const bool hasShader = !graph_.shaders(pair.hit).intersection.empty();
    const bool known = pair.site->trace->offset.certain();
    if (pair.geometry->procedural() && !hasShader && known)
      report_.add(
          "Q601", location(pair.hit),
          fmt::format("{} uses {}, which has no intersection shader", describe(pair), graph_.describe(pair.hit)),
          traceOf(pair));
    if (!pair.geometry->procedural() && hasShader)
      report_.add("Q602", location(pair.hit),
                  fmt::format("{} uses {}, which has an intersection shader for procedural geometry", describe(pair),
                              graph_.describe(pair.hit)),
                  traceOf(pair));
  }

  bool hasAnyHits(std::size_t ray) const {
    for (std::size_t group = 0; group < program_.hitGroups.size(); ++group)
      if (!graph_.shaders({group, ray}).anyHit.empty()) return true;
    return false;
  }

  // Q604: surfaces with alpha that a trace treats as opaque. A program without an any-hit shader for the ray type does so
  // on purpose, unless a group is bound to class alpha.
  void checkAlphaTests() {
    for (const TraceGeometryPair& pair : pairs_) {
      const bool bound = binds(groupOf(pair.hit), "alpha");
      const bool alpha = input_.scene ? pair.geometry->alpha : bound;
      if (!alpha || pair.misplaced || (!bound && !hasAnyHits(pair.hit.ray))) continue;
      const bool hasShader = !graph_.shaders(pair.hit).anyHit.empty();
      // A ray without the shader and with the flag ignores alpha on purpose.
      const bool wanted = !hasShader && pair.site->trace->flags.mustHave(kFlagOpaque);
      if (!wanted && (!hasShader || pair.opaque)) reportSkippedAlphaTest(pair);
    }
  }

  void reportSkippedAlphaTest(const TraceGeometryPair& pair) {
    const std::string surface = input_.scene
                                    ? fmt::format("material '{}' of {}", pair.geometry->material, input_.scene->name)
                                    : "a material with alpha";
    const std::string group = graph_.describe(pair.hit);
    const std::string& anyHit = graph_.shaders(pair.hit).anyHit;
    const spirv::TraceFacts& trace = *pair.site->trace;
    if (anyHit.empty()) {
      if (trace.offset.certain())
        report_.add("Q604", location(pair.hit),
                    fmt::format("{} is opaque for this ray type: {} has no any-hit shader", surface, group),
                    traceOf(pair));
    } else if (pair.instance->forceOpaque && !trace.flags.mustHave(kFlagOpaque)) {
      report_.add("Q604", location(pair.hit),
                  fmt::format("{} is opaque on instance '{}', which is forced opaque: any-hit shader '{}' does not run",
                              surface, pair.instance->name, graph_.nameOf(anyHit)),
                  traceOf(pair));
    } else {
      report_.add("Q604", graph_.location(*pair.site),
                  fmt::format("{} is opaque for this trace: with gl_RayFlagsOpaqueEXT, any-hit shader '{}' of {} does "
                              "not run",
                              surface, graph_.nameOf(anyHit), group),
                  {relatedTo(location(pair.hit), "the hit group with the any-hit shader")});
    }
  }

  // Q603: any-hit shaders whose geometry is always opaque.
  void checkAnyHits() {
    for (std::size_t group = 0; group < program_.hitGroups.size(); ++group)
      for (std::size_t ray = 0; ray < graph_.rayCount(); ++ray)
        if (!graph_.shaders({group, ray}).anyHit.empty()) checkAnyHit({group, ray});
  }

  void checkAnyHit(HitGroupRay hit) {
    const std::string& file = graph_.shaders(hit).anyHit;
    const PipelineStage* stage = graph_.stage(file);
    const auto matches = [&](const TraceGeometryPair& p) {
      const PipelineStage* other = graph_.stage(graph_.shaders(p.hit).anyHit);
      return p.hit.ray == hit.ray &&
             (p.hit.group == hit.group || (stage && other && graph_.areVariants(*stage, *other)));
    };
    if (std::ranges::none_of(pairs_, matches) || std::ranges::any_of(pairs_, [&](const TraceGeometryPair& p) {
          return matches(p) && !p.opaque && !skipsAnyHit(p);
        }))
      return;
    const bool byFlags =
        std::ranges::all_of(pairs_, [&](const TraceGeometryPair& p) { return !matches(p) || skipsAnyHit(p); });
    // The stages of the library are for all scenes, with or without alpha.
    if (input_.scene && !byFlags && program::isLibraryStage(file)) return;
    report_.addOncePerLine(
        "Q603", location(hit),
        fmt::format("any-hit shader '{}' of {} never runs: {}", graph_.nameOf(file), graph_.describe(hit),
                    byFlags ? "all traces of this ray type have gl_RayFlagsOpaqueEXT or gl_RayFlagsCullNoOpaqueEXT"
                    : input_.scene ? fmt::format("its geometry in {} is opaque", input_.scene->name)
                                   : "the group is bound to opaque geometry"));
  }

  // True if the flags exclude all geometry that is not opaque.
  static bool skipsAnyHit(const TraceGeometryPair& pair) {
    const spirv::ArgumentValues& flags = pair.site->trace->flags;
    return flags.mustHave(kFlagOpaque) || flags.mustHave(kFlagCullNoOpaque);
  }

  const ProgramInput& input_;
  const PipelineGraph& graph_;
  const program::Program& program_;
  Report& report_;
  std::vector<TraceGeometryPair> pairs_;
  std::vector<UnknownName> unknownNames_;  // of the scene
};

}  // namespace

void checkGeometry(const ProgramInput& input, Report& report) { GeometryRule(input, report).check(); }

}  // namespace quintet::check
