// SPDX-License-Identifier: Apache-2.0
// Q507 to Q513: arguments of a trace that make its rays hit nothing, the wrong thing, or that Vulkan forbids.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "base/parallel.h"
#include "check/rules/rules.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::ValueRange;
using spv::Op;

constexpr std::uint32_t kInstanceMask = 0xFF;

std::string numberText(double value) { return fmt::format("{:.6g}", value); }

class RayRule {
 public:
  RayRule(const CheckInput& input, Report& report) : input_(input), graph_(input.graph), report_(report) {}

  void check(const TraceSite& site) {
    location_ = graph_.location(site);
    checkFirstHit(site);
    if (site.isExecution()) return;  // the search has the arguments
    for (const std::string& text : site.swapped) report_.add("Q508", location_, text);
    checkMask(*site.trace);
    checkInterval(site);
    if (site.swapped.empty()) checkDirection(site);
    checkGeometry(site);
  }

 private:
  // Q507
  void checkMask(const spirv::TraceFacts& trace) {
    const spirv::ArgumentValues& mask = trace.mask;
    if (!mask.known || mask.values.back() > kInstanceMask) return;  // Q505 reports larger masks
    if (!mask.mayHave(kInstanceMask)) {
      report_.add("Q507", location_, "the cull mask of this trace is 0, so it hits no instance");
      return;
    }
    if (!input_.scene || input_.scene->instances.empty()) return;
    std::uint32_t all = 0;
    for (const program::InstanceFacts& instance : input_.scene->instances) all |= instance.mask & kInstanceMask;
    if (mask.mayHave(all)) return;
    report_.add(
        "Q507", location_,
        fmt::format("the cull mask of this trace is {:#04x}, but the instances of {} have only the bits {:#04x}, "
                    "so it hits none of them",
                    mask.values.back(), input_.scene->name, all));
  }

  // Describes why no value of the interval is valid; empty if some can be.
  static std::string invalid(const ValueRange& tmin, const ValueRange& tmax) {
    if (tmin.empty() || tmax.empty()) return {};
    if (tmin.onlyNan() || tmax.onlyNan()) return fmt::format("{} is NaN", tmin.onlyNan() ? "tmin" : "tmax");
    if (!tmin.nan && tmin.max < 0.0)
      return fmt::format("tmin is {}, but it must not be negative", numberText(tmin.max));
    if (tmin.nan || tmax.nan) return {};
    const std::optional<double> low = tmin.constant(), high = tmax.constant();
    const auto text = [](std::string_view name, double value, bool exact) {
      return fmt::format("{} is {}{}", name, exact ? "" : name == "tmin" ? "at least " : "at most ", numberText(value));
    };
    const std::string both =
        text("tmin", tmin.min, low.has_value()) + " and " + text("tmax", tmax.max, high.has_value());
    if (tmin.min > tmax.max)
      return low && high && *high >= 0.0 ? both + ": they are swapped, or the interval is empty"
                                         : both + ": the interval is empty";
    if (low && high && *low == *high) return both + ": the interval is empty";
    return {};
  }

  // Q509
  void checkInterval(const TraceSite& site) {
    const spirv::StageFacts& facts = graph_.facts(site);
    const std::size_t at = site.trace->instruction;
    const auto ray = graph_.ray(site);
    if (!ray) return;
    const spirv::Id tmin = ray->tmin, tmax = ray->tmax;
    std::string text = invalid(facts.ranges().rangeAt(at, tmin), facts.ranges().rangeAt(at, tmax));
    if (text.empty()) {
      const DefaultRanges* defaults = graph_.defaults(site.stage);
      const std::string names = defaults ? defaults->parameters({tmin, tmax}) : "";
      if (names.empty()) return;
      text = invalid(defaults->at(at, tmin), defaults->at(at, tmax));
      if (!text.empty()) text += fmt::format(" (with the default of {})", names);
    }
    if (!text.empty()) report_.add("Q509", location_, text);
  }

  // Q510
  void checkDirection(const TraceSite& site) {
    const spirv::StageFacts& facts = graph_.facts(site);
    const std::size_t at = site.trace->instruction;
    const auto ray = graph_.ray(site);
    if (!ray) return;
    const spirv::Id direction = ray->direction;
    const auto isZero = [&](const auto& rangeOf) {
      for (std::uint32_t c = 0; c < 3; ++c)
        if (rangeOf(c).constant() != 0.0) return false;
      return true;
    };
    if (isZero([&](std::uint32_t c) { return facts.ranges().rangeAt(at, direction, {c}); })) {
      report_.add("Q510", location_, "the direction of this trace is (0, 0, 0)");
      return;
    }
    const DefaultRanges* defaults = graph_.defaults(site.stage);
    const std::string names = defaults ? defaults->parameters({direction}) : "";
    if (!names.empty() && isZero([&](std::uint32_t c) { return defaults->at(at, direction, {c}); }))
      report_.add("Q510", location_,
                  fmt::format("the direction of this trace is (0, 0, 0) with the default of {}", names));
  }

  // True if the value depends on which hit is found.
  static bool dependsOnHit(const spirv::Module& module, const spirv::ControlFlow& flow, spirv::Id value) {
    return spirv::dependsOnDataOrControl(module, flow, value, [&](const spirv::Instruction& i) {
      if (i.op != Op::OpLoad) return false;
      const spirv::Variable* variable = module.variable(module.access(i.at(0)).variable);
      if (!variable) return false;
      if (variable->storage == spv::StorageClass::HitAttributeKHR) return true;
      static constexpr std::array kHit{spv::BuiltIn::RayTmaxKHR,          spv::BuiltIn::PrimitiveId,
                                       spv::BuiltIn::InstanceId,          spv::BuiltIn::InstanceCustomIndexKHR,
                                       spv::BuiltIn::RayGeometryIndexKHR, spv::BuiltIn::HitKindKHR,
                                       spv::BuiltIn::ObjectToWorldKHR,    spv::BuiltIn::WorldToObjectKHR};
      return variable->builtIn && std::ranges::find(kHit, *variable->builtIn) != kHit.end();
    });
  }

  // Returns the line where the stage stores a value that depends on the hit to the leaf of its payload; 0 if none.
  static int lineOfHitStore(const spirv::StageFacts& facts, std::uint32_t leaf) {
    const spirv::SharedVariable* payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR);
    const spirv::Module& module = facts.module();
    for (const spirv::AccessFacts& a : facts.accesses()) {
      if (!payload || !a.writes || a.variable != payload->id || !a.leaves.covers(leaf)) continue;
      const auto position = module.position(a.instruction);
      const spirv::Id value = facts.storedValue(a, leaf).id;
      if (position && value != 0 && dependsOnHit(module, facts.flow(position->function), value))
        return std::max(1, module.location(module.instructions()[a.instruction]).line);
    }
    return 0;
  }

  // True if the value is only compared: it shows whether there is a hit.
  static bool onlyCompared(const spirv::Module& module, spirv::Id value) {
    const auto compares = [&](std::size_t user) {
      const spirv::Instruction& use = module.instructions()[user];
      return use.result != 0 && module.types().get(use.type).kind == spirv::Type::Kind::boolean;
    };
    return std::ranges::all_of(module.users(value), compares);
  }

  // Q512
  void checkFirstHit(const TraceSite& site) {
    const spirv::TraceFacts& trace = *site.trace;
    if (!trace.flags.mustHave(kFlagTerminateOnFirstHit) || trace.flags.mayHave(kFlagSkipClosestHit)) return;
    const spirv::StageFacts& tracer = graph_.facts(site);
    const spirv::SharedVariable* payload = tracer.variable(trace.payload);
    if (!payload || payload->storage != spv::StorageClass::RayPayloadKHR) return;
    for (std::uint32_t leaf = 0; leaf < tracer.leaves(payload->id).count(); ++leaf) {
      const std::vector<std::size_t> reads = tracer.readsAfter(trace.instruction, payload->id, leaf);
      const bool used = std::ranges::any_of(
          reads, [&](std::size_t read) { return !onlyCompared(tracer.module(), tracer.accesses()[read].value); });
      if (!used) continue;
      const auto [edge, line] = hitStore(site, leaf);
      if (!edge) continue;
      report_.add("Q512", location_,
                  fmt::format("this trace ends at the first hit that is found, which need not be the closest one, but "
                              "the {} writes values of the hit to the payload (line {}), which are read afterwards",
                              graph_.describe(*edge), line));
      return;
    }
  }

  // The first closest-hit shader of the trace that stores a value that depends on the hit, and the line; null if none.
  std::pair<const Edge*, int> hitStore(const TraceSite& site, std::uint32_t leaf) {
    const auto [found, isNew] = hitStores_.try_emplace({site.targets, leaf}, nullptr, 0);
    if (!isNew) return found->second;
    for (const Edge& edge : site.edges) {
      if (edge.role != Role::closestHit || !edge.exact) continue;
      const int line = lineOfHitStore(graph_.facts(edge), leaf);
      if (line != 0) return found->second = {&edge, line};
    }
    return found->second;
  }

  // Q513
  void checkGeometry(const TraceSite& site) {
    const spirv::ArgumentValues& flags = site.trace->flags;
    const bool noTriangles = flags.mustHave(kFlagSkipTriangles), noBoxes = flags.mustHave(kFlagSkipAabbs);
    if (noTriangles && noBoxes) return;  // Q605
    if (input_.scene) return checkSceneGeometry(*site.trace);
    const auto& groups = graph_.groups.hitGroups;
    if (groups.empty() || !graph_.groups.groupsKnown || (!noTriangles && !noBoxes)) return;
    std::size_t procedural = 0;
    for (std::size_t i = 0; i < groups.size(); ++i) procedural += graph_.hasIntersection(i) ? 1 : 0;
    if (noTriangles && procedural == 0)
      report_.add(
          "Q513", location_,
          fmt::format("this trace skips triangles (gl_RayFlagsSkipTrianglesEXT), but no hit group of the {} has an "
                      "intersection shader, so it hits nothing",
                      graph_.groups.noun));
    if (noBoxes && procedural == groups.size())
      report_.add(
          "Q513", location_,
          fmt::format("this trace skips procedural geometry (gl_RayFlagsSkipAABBEXT), but all hit groups of the {} "
                      "have intersection shaders, so it hits nothing",
                      graph_.groups.noun));
  }

  void checkSceneGeometry(const spirv::TraceFacts& trace) {
    const spirv::ArgumentValues& flags = trace.flags;
    const auto& geometries = input_.scene->geometries;
    std::set<std::string> reasons;
    for (const program::InstanceFacts& instance : input_.scene->instances) {
      if (!trace.mask.mayHave(instance.mask & kInstanceMask)) continue;
      for (std::uint32_t k = 0; k < instance.geometryCount && instance.firstGeometry + k < geometries.size(); ++k) {
        const program::GeometryFacts& geometry = geometries[instance.firstGeometry + k];
        const bool built = (geometry.opaque() && !instance.forceNoOpaque) || instance.forceOpaque;
        const bool opaque = (built && !flags.mayHave(kFlagNoOpaque)) || flags.mustHave(kFlagOpaque);
        const bool notOpaque = (!built && !flags.mayHave(kFlagOpaque)) || flags.mustHave(kFlagNoOpaque);
        if (!geometry.procedural() && flags.mustHave(kFlagSkipTriangles))
          reasons.insert("triangles (gl_RayFlagsSkipTrianglesEXT)");
        else if (geometry.procedural() && flags.mustHave(kFlagSkipAabbs))
          reasons.insert("procedural geometry (gl_RayFlagsSkipAABBEXT)");
        else if (opaque && flags.mustHave(kFlagCullOpaque))
          reasons.insert("opaque geometry (gl_RayFlagsCullOpaqueEXT)");
        else if (notOpaque && flags.mustHave(kFlagCullNoOpaque))
          reasons.insert("geometry that is not opaque (gl_RayFlagsCullNoOpaqueEXT)");
        else
          return;
      }
    }
    if (reasons.empty()) return;
    std::string text;
    for (const std::string& reason : reasons) text += (text.empty() ? "" : " and ") + reason;
    report_.add(
        "Q513", location_,
        fmt::format("this trace skips {}, but {} has nothing else, so it hits nothing", text, input_.scene->name));
  }

  const CheckInput& input_;
  const PipelineGraph& graph_;
  Report& report_;
  SourceLocation location_;                                                                 // of the trace
  std::map<std::pair<std::size_t, std::uint32_t>, std::pair<const Edge*, int>> hitStores_;  // by targets and leaf
};

class StrideRule {
 public:
  StrideRule(const ProgramInput& input, Report& report) : input_(input), graph_(input.graph), report_(report) {}

  void check(const TraceSite& site) {
    location_ = graph_.location(site);
    checkStride(site);
  }

 private:
  // True if hits of the trace run different shaders or records in the two groups.
  bool differ(const spirv::TraceFacts& trace, std::size_t a, std::size_t b) const {
    if (a == b) return false;
    for (const std::size_t ray : graph_.rayTypes(trace)) {
      const program::HitShaders& first = graph_.shaders({a, ray});
      const program::HitShaders& second = graph_.shaders({b, ray});
      const bool closest =
          !trace.flags.mustHave(kFlagSkipClosestHit) &&
          (first.closestHit != second.closestHit || (!first.closestHit.empty() && first.record != second.record));
      const bool any = !trace.flags.mustHave(kFlagOpaque) && first.anyHit != second.anyHit;
      if (closest || any || first.intersection != second.intersection) return true;
    }
    return false;
  }

  // Q511
  void checkStride(const TraceSite& site) {
    const spirv::TraceFacts& trace = *site.trace;
    if (!input_.scene || !trace.stride.exact() || trace.stride.values[0] != 0 || graph_.groups.hitGroups.empty())
      return;
    const auto& geometries = input_.scene->geometries;
    for (const program::InstanceFacts& instance : input_.scene->instances) {
      if (!trace.mask.mayHave(instance.mask & kInstanceMask)) continue;
      for (std::uint32_t k = 1; k < instance.geometryCount && instance.firstGeometry + k < geometries.size(); ++k) {
        const std::size_t used = program::hitGroupFor(input_.program, geometries[instance.firstGeometry]);
        const std::size_t needed = program::hitGroupFor(input_.program, geometries[instance.firstGeometry + k]);
        if (!differ(trace, used, needed)) continue;
        report_.add("Q511", location_,
                    fmt::format("the stride of this trace is 0, so geometry {} of instance '{}' uses hit group '{}' of "
                                "geometry 0 instead of '{}'; the stride must be {} (kRayTypeCount)",
                                k, instance.name, graph_.groups.hitGroups[used].name,
                                graph_.groups.hitGroups[needed].name, graph_.rayCount()));
        return;
      }
    }
  }

  const ProgramInput& input_;
  const PipelineGraph& graph_;
  Report& report_;
  SourceLocation location_;  // of the trace
};

}  // namespace

void checkRayArguments(const CheckInput& input, Report& report) {
  RayRule rule(input, report);
  for (const TraceSite& site : input.graph.traces) rule.check(site);
}

void checkStrides(const ProgramInput& input, Report& report) {
  StrideRule rule(input, report);
  for (const TraceSite& site : input.graph.traces) rule.check(site);
}

}  // namespace quintet::check
