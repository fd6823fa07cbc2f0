// SPDX-License-Identifier: Apache-2.0
// Q302, Q502 to Q506: arguments of traces and calls that select records of the shader binding table. Q605: ray flags. Q501:
// hit records in Quintet's layout, one per geometry and ray type.
#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "base/plural.h"
#include "check/rules/rules.h"

namespace quintet::check {
namespace {

constexpr std::uint32_t kRecordBits = 0xF, kMissBits = 0xFFFF, kMaskBits = 0xFF, kAllBits = ~std::uint32_t{0};

// The values of at least `count` that occur; a lower bound if the values are not known.
std::vector<std::uint32_t> wrongValues(const spirv::ArgumentValues& argument, std::uint32_t count) {
  if (!argument.certain()) {
    const auto value = argument.atLeast(count);
    return value ? std::vector{*value} : std::vector<std::uint32_t>{};
  }
  std::vector<std::uint32_t> values = argument.values;
  std::erase_if(values, [&](std::uint32_t value) { return value < count; });
  return values;
}

std::string_view boundText(const spirv::ArgumentValues& argument) { return argument.certain() ? "" : "at least "; }

class ArgumentRule {
 public:
  ArgumentRule(const CheckInput& input, Report& report) : input_(input), graph_(input.graph), report_(report) {}

  void check(const TraceSite& site) {
    const spirv::TraceFacts& trace = *site.trace;
    location_ = graph_.location(site);
    noun_ = site.noun();
    if (site.isExecution()) {  // the search has the arguments; a recorded miss has only its index
      if (trace.ray == spirv::Module::kNone) checkMissIndex(trace);
      return checkShadowMiss(site);
    }
    if (inRange(trace.offset, "offset", "Q503", kRecordBits)) inRange(trace.stride, "stride", "Q503", kRecordBits);
    if (trace.missRuns) checkMissIndex(trace);
    for (const std::uint32_t mask : wrongValues(trace.mask, kMaskBits + 1))
      if (mask != kAllBits || graph_.usesLibrary)  // ~0 is the usual mask of HLSL
        report_.add("Q505", location_,
                    fmt::format("the cull mask of this trace is {}{:#x}, but only its low 8 bits, {:#04x}, are used",
                                boundText(trace.mask), mask, mask & kMaskBits));
    if (!site.isSearch()) checkShadowMiss(site);
    if (trace.flags.certain())
      for (const std::uint32_t flags : trace.flags.values) checkFlags(flags);
    else
      checkFlags(trace.flags.ones);
  }

  void check(const CallSite& site) {
    location_ = graph_.location(site);
    const std::size_t count = graph_.groups.callables.size();
    const spirv::ArgumentValues& index = site.call->index;
    const std::string& noun = graph_.groups.noun;
    if (!graph_.groups.tablesKnown && count > 0) return;
    for (const std::uint32_t value : wrongValues(index, static_cast<std::uint32_t>(count)))
      report_.add("Q302", location_,
                  fmt::format("the callable index of this call is {}{}, but the {} has {}", boundText(index), value,
                              noun, countText(count, "callable shader")));
    if (!index.known && count > 0) checkSceneIndex(site, static_cast<std::uint32_t>(count));
    if (!index.known && count == 0)
      report_.add("Q302", location_, fmt::format("this calls a callable shader, but the {} has none", noun));
  }

 private:
  // An index by the instance or geometry, of which the scene has too many.
  void checkSceneIndex(const CallSite& site, std::uint32_t count) {
    if (!input_.scene || site.call->index.atLeast(count)) return;
    const spirv::Module& module = graph_.facts(site).module();
    const spirv::Id index = module.instructions()[site.call->instruction].at(0);
    const spirv::ValueRanges ranges(module, graph_.context(graph_.stages[site.stage].file, input_.scene));
    const auto value = ranges.rangeAt(site.call->instruction, index).atLeast(count);
    if (value && !ranges.guarded(site.call->instruction, index))
      report_.add("Q302", location_,
                  fmt::format("the callable index of this call is up to {:.0f} in {}, but the {} has {}", *value,
                              input_.scene->name, graph_.groups.noun, countText(count, "callable shader")));
  }

  // "no miss shaders", "1 miss shader (index 0)", "3 miss shaders (index 0 to 2)"
  static std::string countText(std::size_t count, std::string_view noun) {
    if (count == 0) return fmt::format("no {}s", noun);
    return counted(count, noun) + (count == 1 ? " (index 0)" : fmt::format(" (index 0 to {})", count - 1));
  }

  bool inRange(const spirv::ArgumentValues& argument, std::string_view name, std::string_view id, std::uint32_t limit) {
    const std::vector<std::uint32_t> wrong = wrongValues(argument, limit + 1);
    if (wrong.empty()) return true;
    report_.add(id, location_,
                fmt::format("the {} of this {} is {}{}, but the maximum is {}; the device would use {}", name, noun_,
                            boundText(argument), wrong.front(), limit,
                            argument.certain() ? std::to_string(wrong.front() & limit) : "its low bits"));
    return false;
  }

  void checkMissIndex(const spirv::TraceFacts& trace) {
    if (!inRange(trace.miss, "miss index", "Q504", kMissBits) || !graph_.groups.tablesKnown) return;
    for (const std::uint32_t index : wrongValues(trace.miss, static_cast<std::uint32_t>(graph_.groups.misses.size())))
      report_.add("Q502", location_,
                  fmt::format("the miss index of this {} is {}{}, but the {} has {}", noun_, boundText(trace.miss),
                              index, graph_.groups.noun, countText(graph_.groups.misses.size(), "miss shader")));
  }

  static bool isShadow(const spirv::TraceFacts& trace) {
    return trace.flags.mustHave(kFlagTerminateOnFirstHit | kFlagSkipClosestHit);
  }

  // Reports a shadow ray with the miss shader of radiance rays, if the program has one that it should use: that of the
  // ray's own type, or one that no ray uses while this one does not return what is read.
  void checkShadowMiss(const TraceSite& site) {
    const spirv::TraceFacts& trace = *site.trace;
    if (!graph_.groups.tablesKnown || !isShadow(trace) || !trace.miss.exact() ||
        trace.miss.values[0] >= graph_.groups.misses.size())
      return;
    const auto forRadiance = [&](const std::string& file) { return usesOf(file).radiance != nullptr; };
    const program::MissShader& used = graph_.groups.misses[trace.miss.values[0]];
    if (!forRadiance(used.file)) return;
    for (std::size_t i = 0; i < graph_.groups.misses.size(); ++i) {
      const std::string& file = graph_.groups.misses[i].file;
      if (forRadiance(file)) continue;
      const bool byRayType = graph_.groups.hitRecords == HitRecords::byRayType;
      const bool own = byRayType && trace.offset.exact() && trace.offset.values[0] == i;
      const bool unused = !usesOf(file).used;
      if (!own && (!unused || returnsWhatIsRead(site))) continue;
      report_.add(
          "Q506", location_,
          fmt::format("this shadow ray uses miss shader '{}' (index {}) of radiance rays, but '{}' (index {}) is "
                      "not used by radiance rays",
                      used.file, trace.miss.values[0], file, i),
          {relatedTo(graph_.location(*usesOf(used.file).radiance), "radiance rays use the same miss shader")});
      return;
    }
  }

  struct MissUses {
    bool used = false;
    const TraceSite* radiance = nullptr;  // the first trace other than of shadow rays
  };

  MissUses usesOf(const std::string& file) {
    if (misses_.empty())
      for (const TraceSite& site : graph_.traces)
        for (const Edge& edge : site.edges) {
          if (edge.role != Role::miss) break;  // they come first
          MissUses& uses = misses_[graph_.stages[edge.stage].file];
          uses.used = true;
          if (!uses.radiance && !isShadow(*site.trace)) uses.radiance = &site;
        }
    const auto found = misses_.find(file);
    return found == misses_.end() ? MissUses{} : found->second;
  }

  // True if the miss shader of the ray writes all that is read from the payload afterwards.
  bool returnsWhatIsRead(const TraceSite& site) const {
    const spirv::StageFacts& tracer = graph_.facts(site);
    const spirv::Id payload = site.trace->payload;
    const auto miss = std::ranges::find(site.edges, Role::miss, &Edge::role);
    if (miss == site.edges.end()) return false;
    const spirv::StageFacts& facts = graph_.facts(*miss);
    const spirv::SharedVariable* received = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR);
    if (!received) return false;
    for (std::uint32_t leaf = 0; leaf < tracer.leaves(payload).count(); ++leaf)
      if (!tracer.readsAfter(site.trace->instruction, payload, leaf).empty() && !facts.writesAlways(received->id, leaf))
        return false;
    return true;
  }

  // Each of these sets allows at most one flag: VUID-RuntimeSpirv-OpTraceRayKHR-06892 to 06894.
  void checkFlags(std::uint32_t flags) {
    struct Flag {
      std::uint32_t bit;
      std::string_view name;
    };
    static const std::vector<std::vector<Flag>> kSets{
        {{kFlagOpaque, "Opaque"},
         {kFlagNoOpaque, "NoOpaque"},
         {kFlagCullOpaque, "CullOpaque"},
         {kFlagCullNoOpaque, "CullNoOpaque"}},
        {{kFlagSkipTriangles, "SkipTriangles"},
         {kFlagCullBack, "CullBackFacingTriangles"},
         {kFlagCullFront, "CullFrontFacingTriangles"}},
        {{kFlagSkipTriangles, "SkipTriangles"}, {kFlagSkipAabbs, "SkipAABB"}}};
    for (const std::vector<Flag>& set : kSets) {
      std::vector<std::string_view> names;
      for (const Flag& flag : set)
        if ((flags & flag.bit) != 0) names.push_back(flag.name);
      if (names.size() > 1)
        report_.add("Q605", location_,
                    fmt::format("this trace has gl_RayFlags{}EXT and gl_RayFlags{}EXT, which exclude each other",
                                names[0], names[1]));
    }
  }

  const CheckInput& input_;
  const PipelineGraph& graph_;
  Report& report_;
  SourceLocation location_;                           // of the trace or call
  std::string_view noun_;                             // of the trace
  std::unordered_map<std::string, MissUses> misses_;  // by file
};

// Quintet's layout: geometry k has the records k * rays to k * rays + rays - 1.
class LayoutRule {
 public:
  LayoutRule(const ProgramInput& input, Report& report) : input_(input), graph_(input.graph), report_(report) {}

  void check(const TraceSite& site) {
    location_ = graph_.location(site);
    const spirv::TraceFacts& trace = *site.trace;
    if (wrongValues(trace.offset, kRecordBits + 1).empty() && wrongValues(trace.stride, kRecordBits + 1).empty())
      checkRecords(trace);  // Q503 reports the others
  }

 private:
  void checkRecords(const spirv::TraceFacts& trace) {
    const std::size_t rays = graph_.rayCount();
    if (graph_.groups.hitGroups.empty()) return;
    for (const std::uint32_t offset : wrongValues(trace.offset, static_cast<std::uint32_t>(rays))) {
      report_.add("Q501", location_,
                  fmt::format("the offset of this trace is {}{}, but each geometry has {} (one per ray type){}",
                              boundText(trace.offset), offset, counted(rays, "record"), sceneText(trace, offset)));
      return;
    }
    if (!trace.stride.certain()) return;
    for (const std::uint32_t stride : trace.stride.values)
      if (stride != 0 && stride != rays) checkStride(trace, stride);
  }

  // With a stride other than the number of ray types, all but the first geometry of an instance use wrong records.
  void checkStride(const spirv::TraceFacts& trace, std::uint32_t stride) {
    const std::size_t rays = graph_.rayCount();
    const std::string text =
        fmt::format("the stride of this trace is {}, but each geometry has {} (one per ray type): ", stride,
                    counted(rays, "record"));
    if (!input_.scene) {
      report_.add("Q501", location_, text + "the second geometry of a mesh uses the records of a different geometry");
      return;
    }
    for (const program::InstanceFacts& instance : input_.scene->instances) {
      if (!seen(trace, instance) || instance.geometryCount < 2) continue;
      const std::size_t last = std::size_t{instance.geometryCount} - 1;
      const std::size_t record = instance.firstGeometry * rays + last * stride + firstOffset(trace);
      report_.add(
          "Q501", location_,
          text + fmt::format("geometry {} of instance '{}' uses record {} instead of {}{}", last, instance.name, record,
                             (instance.firstGeometry + last) * rays + firstOffset(trace), beyond(record)));
      return;
    }
  }

  static bool seen(const spirv::TraceFacts& trace, const program::InstanceFacts& instance) {
    return trace.mask.mayHave(instance.mask & kMaskBits);
  }
  static std::uint32_t firstOffset(const spirv::TraceFacts& trace) {
    return trace.offset.known ? trace.offset.values.front() : 0;
  }

  std::string beyond(std::size_t record) const {
    const std::size_t count = input_.scene->geometries.size() * graph_.rayCount();
    return record < count ? std::string() : fmt::format("; the table has {}", counted(count, "record"));
  }

  // ": instance 'ball' of scene.glb uses record 7; the table has 6 records"
  std::string sceneText(const spirv::TraceFacts& trace, std::uint32_t offset) const {
    if (!input_.scene) return {};
    const std::uint32_t stride =
        trace.stride.exact() ? trace.stride.values[0] : static_cast<std::uint32_t>(graph_.rayCount());
    for (const program::InstanceFacts& instance : input_.scene->instances) {
      const std::size_t record = instance.firstGeometry * graph_.rayCount() +
                                 (std::max(1u, instance.geometryCount) - 1) * std::size_t{stride} + offset;
      if (seen(trace, instance) && !beyond(record).empty())
        return fmt::format(": instance '{}' of {} uses record {}{}", instance.name, input_.scene->name, record,
                           beyond(record));
    }
    return {};
  }

  const ProgramInput& input_;
  const PipelineGraph& graph_;
  Report& report_;
  SourceLocation location_;  // of the trace
};

}  // namespace

void checkArguments(const CheckInput& input, Report& report) {
  ArgumentRule rule(input, report);
  for (const TraceSite& site : input.graph.traces) rule.check(site);
  for (const CallSite& site : input.graph.calls) rule.check(site);
}

void checkRecordLayout(const ProgramInput& input, Report& report) {
  LayoutRule rule(input, report);
  for (const TraceSite& site : input.graph.traces) rule.check(site);
}

}  // namespace quintet::check
