// Q501 ... Q506: the arguments that choose records of the shader binding table, and Q605: ray flags.
#include <fmt/format.h>

#include <algorithm>

#include "program/check_parts.h"

namespace quintet::program {
namespace {

constexpr std::uint32_t kRecordBits = 0xF, kMissBits = 0xFFFF, kMaskBits = 0xFF;

class Arguments {
 public:
  Arguments(const CheckInput& input, Report& report) : input_(input), model_(input.model), report_(report) {}

  void check(const TraceSite& site) {
    const shader::TraceFacts& trace = *site.trace;
    place_ = model_.at(model_.stages[site.stage], trace.place);
    if (inRange(trace.offset, "offset", "Q503", kRecordBits) && inRange(trace.stride, "stride", "Q503", kRecordBits))
      checkRecords(trace);
    if (inRange(trace.miss, "miss index", "Q504", kMissBits)) checkMiss(trace);
    for (const std::uint32_t mask : trace.mask.values)
      if (mask > kMaskBits)
        report_.add(
            "Q505", place_,
            fmt::format("the cull mask of this trace is {:#x}; its 8 low bits are {:#04x}", mask, mask & kMaskBits));
    checkShadowMiss(site);
  }

 private:
  bool inRange(const shader::ArgumentValues& argument, std::string_view name, std::string_view id,
               std::uint32_t limit) {
    for (const std::uint32_t value : argument.values) {
      if (value <= limit) continue;
      report_.add(id, place_,
                  fmt::format("the {} of this trace is {}; at most {} is possible, and {} would be used", name, value,
                              limit, value & limit));
      return false;
    }
    return true;
  }

  void checkMiss(const shader::TraceFacts& trace) {
    for (const std::uint32_t index : trace.miss.values)
      if (index >= model_.misses.size())
        report_.add("Q502", place_,
                    fmt::format("the miss index of this trace is {}, but the program has {} miss shader{}: 0{}", index,
                                model_.misses.size(), model_.misses.size() == 1 ? "" : "s",
                                model_.misses.size() == 1 ? "" : fmt::format(" to {}", model_.misses.size() - 1)));
  }

  void checkRecords(const shader::TraceFacts& trace) {
    const std::size_t rays = model_.rayCount();
    if (model_.program.hitGroups.empty()) return;
    for (const std::uint32_t offset : trace.offset.values) {
      if (offset < rays) continue;
      report_.add(
          "Q501", place_,
          fmt::format("the offset of this trace is {}, but each geometry has {} record{} (one for each ray type){}",
                      offset, rays, rays == 1 ? "" : "s", sceneText(trace, offset)));
      return;
    }
    for (const std::uint32_t stride : trace.stride.values)
      if (stride != 0 && stride != rays) checkStride(trace, stride);
  }

  // Records of an instance's second geometry on are those of others if the stride is not the number of ray types.
  void checkStride(const shader::TraceFacts& trace, std::uint32_t stride) {
    const std::size_t rays = model_.rayCount();
    const std::string text = fmt::format(
        "the stride of this trace is {}, but each geometry has {} record{} (one for each ray type): ", stride, rays,
        rays == 1 ? "" : "s");
    if (!input_.scene) {
      report_.add("Q501", place_, text + "the second geometry of a mesh uses records of another one");
      return;
    }
    for (const InstanceFacts& instance : input_.scene->instances) {
      if (!seen(trace, instance) || instance.geometryCount < 2) continue;
      const std::size_t last = std::size_t{instance.geometryCount} - 1;
      const std::size_t record = instance.firstGeometry * rays + last * stride + firstOffset(trace);
      report_.add(
          "Q501", place_,
          text + fmt::format("geometry {} of instance '{}' uses record {}, its own is {}{}", last, instance.name,
                             record, (instance.firstGeometry + last) * rays + firstOffset(trace), beyond(record)));
      return;
    }
  }

  static bool seen(const shader::TraceFacts& trace, const InstanceFacts& instance) {
    return trace.mask.may(instance.mask & kMaskBits);
  }
  static std::uint32_t firstOffset(const shader::TraceFacts& trace) {
    return trace.offset.known ? trace.offset.values.front() : 0;
  }

  std::string beyond(std::size_t record) const {
    const std::size_t count = input_.scene->geometries.size() * model_.rayCount();
    return record < count ? std::string() : fmt::format("; the table has {}", count);
  }

  // ": the last record of instance 'ball' would be 7, the table has 6"
  std::string sceneText(const shader::TraceFacts& trace, std::uint32_t offset) const {
    if (!input_.scene) return {};
    const std::uint32_t stride =
        trace.stride.exact() ? trace.stride.values[0] : static_cast<std::uint32_t>(model_.rayCount());
    for (const InstanceFacts& instance : input_.scene->instances) {
      const std::size_t record = instance.firstGeometry * model_.rayCount() +
                                 (std::max(1u, instance.geometryCount) - 1) * std::size_t{stride} + offset;
      if (seen(trace, instance) && !beyond(record).empty())
        return fmt::format(": instance '{}' of {} uses record {}{}", instance.name, input_.scene->name, record,
                           beyond(record));
    }
    return {};
  }

  static bool isShadow(const shader::TraceFacts& trace) {
    return trace.flags.must(kFlagTerminateOnFirstHit | kFlagSkipClosestHit);
  }

  // The miss shader that other traces use for radiance, although the program has one that no such trace uses.
  void checkShadowMiss(const TraceSite& site) {
    const shader::TraceFacts& trace = *site.trace;
    if (!isShadow(trace) || !trace.miss.exact() || trace.miss.values[0] >= model_.misses.size()) return;
    const auto forRadiance = [&](const std::string& file) {
      return std::ranges::any_of(model_.traces, [&](const TraceSite& other) {
        return !isShadow(*other.trace) && std::ranges::any_of(other.edges, [&](const Edge& e) {
          return e.role == Role::miss && model_.stages[e.stage].file == file;
        });
      });
    };
    const MissShader& used = model_.misses[trace.miss.values[0]];
    if (!forRadiance(used.file)) return;
    for (std::size_t i = 0; i < model_.misses.size(); ++i) {
      if (forRadiance(model_.misses[i].file)) continue;
      report_.add("Q506", place_,
                  fmt::format("this shadow ray runs miss shader '{}' (index {}), which radiance rays use; no trace of "
                              "radiance uses '{}' (index {})",
                              used.file, trace.miss.values[0], model_.misses[i].file, i));
      return;
    }
  }

  const CheckInput& input_;
  const LinkModel& model_;
  Report& report_;
  shader::Place place_;
};

}  // namespace

void checkTable(const CheckInput& input, Report& report) {
  Arguments arguments(input, report);
  for (const TraceSite& site : input.model.traces) arguments.check(site);
}

void checkFlags(const CheckInput& input, Report& report) {
  struct Flag {
    std::uint32_t bit;
    std::string_view name;
  };
  // Of each set one flag at most: VUID-RuntimeSpirv-OpTraceRayKHR-06892 to 06894.
  static const std::vector<std::vector<Flag>> kSets{
      {{kFlagOpaque, "Opaque"},
       {kFlagNoOpaque, "NoOpaque"},
       {kFlagCullOpaque, "CullOpaque"},
       {kFlagCullNoOpaque, "CullNoOpaque"}},
      {{kFlagSkipTriangles, "SkipTriangles"},
       {kFlagCullBack, "CullBackFacingTriangles"},
       {kFlagCullFront, "CullFrontFacingTriangles"}},
      {{kFlagSkipTriangles, "SkipTriangles"}, {kFlagSkipBoxes, "SkipAABB"}}};
  for (const TraceSite& site : input.model.traces) {
    for (const std::uint32_t flags : site.trace->flags.values) {
      for (const std::vector<Flag>& set : kSets) {
        std::vector<std::string_view> names;
        for (const Flag& flag : set)
          if ((flags & flag.bit) != 0) names.push_back(flag.name);
        if (names.size() > 1)
          report.add("Q605", input.model.at(input.model.stages[site.stage], site.trace->place),
                     fmt::format("this trace has gl_RayFlags{}EXT and gl_RayFlags{}EXT, which exclude each other",
                                 names[0], names[1]));
      }
    }
  }
}

}  // namespace quintet::program
