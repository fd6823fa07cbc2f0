// SPDX-License-Identifier: Apache-2.0
#include "job/explanation_builder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "quintet/shared/explain.h"
#include "quintet/shared/frame.h"

namespace quintet::job {
namespace {

// Ray flags of VK_KHR_ray_tracing_pipeline and VK_KHR_ray_tracing_maintenance1, without gl_RayFlags…EXT.
constexpr std::pair<std::uint32_t, const char*> kRayFlags[] = {
    {1, "Opaque"},
    {2, "NoOpaque"},
    {4, "TerminateOnFirstHit"},
    {8, "SkipClosestHitShader"},
    {16, "CullBackFacingTriangles"},
    {32, "CullFrontFacingTriangles"},
    {64, "CullOpaque"},
    {128, "CullNoOpaque"},
    {256, "SkipTriangles"},
    {512, "SkipAABB"},
};
constexpr const char* kLobes[] = {"clearcoat", "specular", "diffuse", "transmission", "sheen", "diffuse transmission"};
constexpr const char* kLightTypes[] = {"point", "spot", "directional", "triangle", "environment", "solid"};
constexpr const char* kSources[] = {"background", "surface", "light sample"};
constexpr const char* kReasons[] = {"unlit surface", "largest number of bounces",
                                    "the direction is on different sides of shading and geometric normal"};
constexpr std::string_view kRay[] = {"ray"};
constexpr std::string_view kCall[] = {"call"};
constexpr std::string_view kStages[] = {"closest-hit", "hit", "any-hit", "intersection", "miss", "callable"};
constexpr const char* kResults[] = {"accepted", "ignored", "terminated"};
constexpr std::uint32_t kHitKindFront = 0xFE;
constexpr std::uint32_t kHitKindBack = 0xFF;

template <std::size_t n>
std::string nameIn(const char* const (&names)[n], std::uint32_t index) {
  return index < n ? names[index] : fmt::format("{}", index);
}

EventValue floats(const vec2& v) { return std::vector<float>{v.x, v.y}; }
EventValue floats(const vec3& v) { return std::vector<float>{v.x, v.y, v.z}; }
EventValue floats(const vec4& v) { return std::vector<float>{v.x, v.y, v.z, v.w}; }
EventValue integer(std::uint32_t value) { return std::int64_t{value}; }

std::string flagsText(std::uint32_t flags) {
  std::string text;
  for (const auto& [bit, name] : kRayFlags) {
    if ((flags & bit) == 0) continue;
    text += (text.empty() ? "" : " ") + std::string(name);
    flags &= ~bit;
  }
  if (flags != 0) text += fmt::format("{}0x{:x}", text.empty() ? "" : " ", flags);
  return text;
}

EventValue hitKind(std::uint32_t kind) {
  if (kind == kHitKindFront) return std::string("front-facing triangle");
  if (kind == kHitKindBack) return std::string("back-facing triangle");
  return integer(kind);
}

template <class T>
T numberAt(std::span<const std::uint32_t> words, std::size_t at) {
  return std::bit_cast<T>(words[at]);
}

// The value of a field in logged words.
EventValue fieldValue(const spirv::DataField& field, std::span<const std::uint32_t> words) {
  using Kind = spirv::DataField::Kind;
  std::vector<float> numbers;
  std::vector<std::int64_t> integers;
  for (std::uint32_t i = 0; i < field.components; ++i) {
    const std::size_t at = field.firstWord + i * field.width / 32;
    const std::uint64_t wide =
        field.width == 64 ? words[at] | std::uint64_t{words[at + 1]} << 32 : std::uint64_t{words[at]};
    switch (field.kind) {
      case Kind::floating:
        numbers.push_back(field.width == 64 ? static_cast<float>(std::bit_cast<double>(wide))
                                            : numberAt<float>(words, at));
        break;
      case Kind::signedInteger:
        integers.push_back(field.width == 64 ? static_cast<std::int64_t>(wide) : numberAt<std::int32_t>(words, at));
        break;
      default: integers.push_back(static_cast<std::int64_t>(wide));
    }
  }
  if (field.components == 1) {
    if (field.kind == Kind::boolean) return integers[0] != 0;
    return field.kind == Kind::floating ? EventValue(numbers[0]) : EventValue(integers[0]);
  }
  return field.kind == Kind::floating ? EventValue(std::move(numbers)) : EventValue(std::move(integers));
}

class Builder {
 public:
  Builder(const program::RunnableProgram& program, const SceneNames& names, uvec2 pixel)
      : runnable_(program),
        program_(program.description),
        misses_(program::missShaders(program.description)),
        names_(names),
        pixel_(pixel) {
    open_.emplace_back();  // the root
  }

  void add(std::uint32_t kind, std::span<const std::uint32_t> words) {
    using namespace shared;
    switch (kind) {
      case kLogRay: return read<ExplainRay>(words, [&](const auto& r) { begin(ray(r)); });
      case kLogRayEnd: return read<ExplainRayEnd>(words, [&](const auto& r) { endRay(r.traced != 0); });
      case kLogCall: return read<ExplainCall>(words, [&](const auto& r) { begin(call(r)); });
      case kLogCallEnd: end(kCall); return;
      case kLogData: return addData(words);
      case kLogStage: return read<ExplainStage>(words, [&](const auto& r) { begin(stage(r.stage)); });
      case kLogHit: return read<ExplainHit>(words, [&](const auto& r) { begin(hit(r)); });
      case kLogBox: return read<ExplainBox>(words, [&](const auto& r) { begin(box(r)); });
      case kLogStageEnd: return read<ExplainStageEnd>(words, [&](const auto& r) { endStage(r.result); });
      case kLogReport:
        return read<ExplainReport>(words, [&](const auto& r) {
          append({"report", {{"t", r.t}, {"hitKind", integer(r.hitKind)}, {"accepted", r.accepted != 0}}, {}});
        });
      case kLogStore: return read<ExplainStore>(words, [&](const auto& r) { append(store(r)); });
      default: return addSampling(kind, words);
    }
  }

  std::vector<ExplainedEvent> finish() {
    while (open_.size() > 1) close();
    return std::move(open_.front().children);
  }

 private:
  // Facts that a program states (quintet/explain_hooks.glsl).
  void addSampling(std::uint32_t kind, std::span<const std::uint32_t> words) {
    using namespace shared;
    switch (kind) {
      case kLogCamera:
        return read<ExplainCamera>(words, [&](const auto& r) {
          append({"camera", {{"film", floats(r.film)}, {"lens", floats(r.lens)}}, {}});
        });
      case kLogSurface: return read<ExplainSurface>(words, [&](const auto& r) { append(surface(r)); });
      case kLogShading: return read<ExplainShading>(words, [&](const auto& r) { append(shading(r)); });
      case kLogLobe:
        return read<ExplainLobe>(words, [&](const auto& r) {
          append({"bsdf", {{"lobe", nameIn(kLobes, r.lobe)}, {"probability", r.probability}}, {}});
        });
      case kLogLightChoice: return read<ExplainLightChoice>(words, [&](const auto& r) { append(lightChoice(r)); });
      case kLogLightSample: return read<ExplainLightSample>(words, [&](const auto& r) { addLightSample(r); });
      case kLogLightRoulette: return read<ExplainLightRoulette>(words, [&](const auto& r) { addLightRoulette(r); });
      case kLogVisibility:
        return read<ExplainVisibility>(words, [&](const auto& r) { addVisibility(r.transmittance); });
      case kLogBsdfSample: return read<ExplainBsdfSample>(words, [&](const auto& r) { addBsdfSample(r); });
      case kLogRoulette:
        return read<ExplainRoulette>(words, [&](const auto& r) {
          append({"roulette",
                  {{"survival", r.survival},
                   {"u", r.u},
                   {"survived", r.u < r.survival},
                   {"throughput", floats(r.throughput)}},
                  {}});
        });
      case kLogEmission:
        return read<ExplainEmission>(words, [&](const auto& r) {
          append({"emission",
                  {{"source", nameIn(kSources, r.source)},
                   {"radiance", floats(r.radiance)},
                   {"throughput", floats(r.throughput)},
                   {"bsdfPdf", r.bsdfPdf},
                   {"lightPdf", r.lightPdf},
                   {"misWeight", r.misWeight}},
                  {}});
        });
      case kLogContribution: return read<ExplainContribution>(words, [&](const auto& r) { append(contribution(r)); });
      case kLogPathEnd:
        return read<ExplainPathEnd>(words, [&](const auto& r) {
          append({"end", {{"reason", nameIn(kReasons, r.reason)}}, {}});
        });
      default: return;  // not of an explanation
    }
  }

  template <class T, class Use>
  static void read(std::span<const std::uint32_t> words, const Use& use) {
    if (words.size() * sizeof(std::uint32_t) != sizeof(T)) return;
    T record;
    std::memcpy(&record, words.data(), sizeof(T));
    use(record);
  }

  ExplainedEvent& parent() { return open_.back(); }
  void append(ExplainedEvent event) { parent().children.push_back(std::move(event)); }
  void begin(ExplainedEvent event) { open_.push_back(std::move(event)); }
  void close() {
    ExplainedEvent event = std::move(open_.back());
    open_.pop_back();
    append(std::move(event));
  }
  // Closes the innermost open event of these types, and what is open in it.
  void end(std::span<const std::string_view> types) {
    if (std::ranges::none_of(open_, [&](const ExplainedEvent& event) { return matches(types, event); })) return;
    while (!matches(types, open_.back())) close();
    close();
  }
  static bool matches(std::span<const std::string_view> types, const ExplainedEvent& event) {
    return std::ranges::find(types, event.type) != types.end();
  }

  std::string stageName(std::uint32_t index) const {
    const auto& stages = runnable_.compiled.stages;
    return index < stages.size() ? stages[index].file : fmt::format("{}", index);
  }
  template <class Names>
  static std::string nameOf(const Names& names, std::uint32_t index) {
    return index < names.size() ? std::string(names[index]) : fmt::format("{}", index);
  }

  ExplainedEvent ray(const shared::ExplainRay& r) const {
    const std::size_t count = program_.rays.size();
    ExplainedEvent event{"ray", {}, {}};
    event.set("stage", stageName(r.stage));
    event.set("line", integer(r.line));
    // With one ray type, the stride only matters for instances with several geometries.
    if ((r.recordStride == count || count == 1) && r.recordOffset < count)
      event.set("rayType", program_.rays[r.recordOffset].name);
    else
      event.set("records", fmt::format("offset {}, stride {}", r.recordOffset, r.recordStride));
    event.set("flags", flagsText(r.flags));
    event.set("cullMask", integer(r.mask & 0xFFu));
    event.set("missIndex", integer(r.missIndex));
    if (r.missIndex < misses_.size()) event.set("missShader", misses_[r.missIndex].file);
    event.set("origin", floats(r.origin));
    event.set("tmin", r.tmin);
    event.set("direction", floats(r.direction));
    event.set("tmax", r.tmax);
    return event;
  }

  void endRay(bool traced) {
    const auto openRay = std::find_if(open_.rbegin(), open_.rend(), [](const auto& e) { return e.type == "ray"; });
    if (openRay == open_.rend()) return;
    const auto isHit = [](const ExplainedEvent& e) { return e.type == "closest-hit" || e.type == "hit"; };
    const bool found = std::ranges::any_of(openRay->children, isHit);
    openRay->set("result", std::string(!traced ? "not traced" : found ? "hit" : "miss"));
    // A trace without an interval and without instances means "no ray" in the library (traceVisible).
    if (openRay->integer("cullMask") == 0 && openRay->number("tmax") == 0.0f && &*openRay == &open_.back()) {
      open_.pop_back();
      droppedRay_ = true;
      return;
    }
    droppedRay_ = false;
    end(kRay);
  }

  ExplainedEvent call(const shared::ExplainCall& r) const {
    ExplainedEvent event{"call", {}, {}};
    event.set("stage", stageName(r.stage));
    event.set("line", integer(r.line));
    event.set("index", integer(r.index));
    if (r.index < program_.callables.size()) {
      const program::Callable& callable = program_.callables[r.index];
      event.set("callable", callable.name.empty() ? callable.file : callable.name);
    }
    return event;
  }

  ExplainedEvent stage(std::uint32_t index) const {
    const auto& stages = runnable_.compiled.stages;
    const bool miss = index < stages.size() && stages[index].kind == shader::Stage::miss;
    return {miss ? "miss" : "callable", {{"stage", stageName(index)}}, {}};
  }

  ExplainedEvent hit(const shared::ExplainHit& r) const {
    const auto& stages = runnable_.compiled.stages;
    const bool runs = r.runsProgram != 0 && r.stage < stages.size();
    ExplainedEvent event{!runs                                           ? "hit"
                         : stages[r.stage].kind == shader::Stage::anyHit ? "any-hit"
                                                                         : "closest-hit",
                         {},
                         {}};
    if (runs) event.set("stage", stageName(r.stage));
    event.set("instance", integer(r.instance));
    event.set("instanceName", nameOf(names_.instances, r.instance));
    event.set("geometry", integer(r.geometry));
    event.set("primitive", integer(r.primitive));
    const bool triangle = r.geometryKind == shared::kGeometryTriangles;
    if (r.geometryKind != shared::kGeometryCsg) event.set("material", nameOf(names_.materials, r.material));
    event.set("hitKind", hitKind(r.hitKind));
    event.set("t", r.t);
    if (!triangle) return event;
    event.set("barycentrics", floats(r.barycentric));
    event.set("uv", floats(r.uv));
    event.set("geometricNormal", floats(r.geometricNormal));
    event.set("shadingNormal", floats(r.shadingNormal));
    return event;
  }

  ExplainedEvent box(const shared::ExplainBox& r) const {
    return {"intersection",
            {{"stage", stageName(r.stage)},
             {"instance", integer(r.instance)},
             {"instanceName", nameOf(names_.instances, r.instance)},
             {"geometry", integer(r.geometry)},
             {"primitive", integer(r.primitive)},
             {"tmin", r.tmin},
             {"tmax", r.tmax}},
            {}};
  }

  void endStage(std::uint32_t result) {
    const auto stage =
        std::find_if(open_.rbegin(), open_.rend(), [&](const ExplainedEvent& e) { return matches(kStages, e); });
    if (stage == open_.rend()) return;
    if (stage->type == "any-hit") stage->set("result", nameIn(kResults, result));
    end(kStages);
  }

  void addData(std::span<const std::uint32_t> words) {
    if (words.empty()) return;
    const std::uint32_t number = words[0];
    const std::size_t stage = number / program::kCallsPerStage, index = number % program::kCallsPerStage;
    const auto& stages = runnable_.compiled.stages;
    if (stage >= stages.size() || index >= stages[stage].calls.size()) return;
    const spirv::CallSite& site = stages[stage].calls[index];
    ExplainedEvent& caller = parent();
    const bool ray = caller.type == "ray";
    if (!ray && caller.type != "call") return;
    if (!site.location.file.empty()) {
      caller.set("file", site.location.file);
      caller.set("line", integer(static_cast<std::uint32_t>(site.location.line)));
    }
    ExplainedEvent event{ray ? "payload" : "data", {}, {}};
    const bool again =
        std::ranges::any_of(caller.children, [&](const auto& child) { return child.type == event.type; });
    event.set("when", std::string(again ? "after" : "before"));
    event.set("variable", site.variable);
    event.set("dataType", site.type);
    if (!site.complete) event.set("complete", false);
    for (const spirv::DataField& field : site.fields) {
      if (1 + field.firstWord + field.wordCount() > words.size()) break;
      // The name of a variable without members could be that of a field.
      event.set(field.name == site.variable ? "value" : field.name, fieldValue(field, words.subspan(1)));
    }
    append(std::move(event));
  }

  ExplainedEvent store(const shared::ExplainStore& r) const {
    ExplainedEvent event{"store", {}, {}};
    event.set("stage", stageName(r.stage));
    event.set("line", integer(r.line));
    event.set("output", r.slot < program_.outputs.size() ? program_.outputs[r.slot].name : fmt::format("{}", r.slot));
    event.set("mode", std::string(r.mode == shared::kExplainAdded ? "add" : "store"));
    if (r.mode == shared::kExplainCoverage)
      event.set("id", integer(std::bit_cast<std::uint32_t>(r.value.x)));
    else
      event.set("value", floats(r.value));
    if (r.pixel != pixel_) event.set("pixel", std::vector<std::int64_t>{r.pixel.x, r.pixel.y});
    return event;
  }

  ExplainedEvent surface(const shared::ExplainSurface& r) const {
    return {"surface",
            {{"position", floats(r.position)},
             {"geometricNormal", floats(r.geometricNormal)},
             {"shadingNormal", floats(r.shadingNormal)},
             {"uv", floats(r.uv)},
             {"material", nameOf(names_.materials, r.material)},
             {"side", std::string(r.frontFace != 0 ? "front" : "back")}},
            {}};
  }

  static ExplainedEvent shading(const shared::ExplainShading& r) {
    return {"shading",
            {{"normal", floats(r.normal)},
             {"baseColor", floats(r.baseColor)},
             {"metallic", r.metallic},
             {"roughness", std::sqrt(r.alpha)},
             {"transmission", r.transmission},
             {"ior", r.ior},
             {"clearcoat", r.clearcoat},
             {"sheenColor", floats(r.sheenColor)},
             {"sheenRoughness", std::sqrt(r.sheenAlpha)},
             {"diffuseTransmission", r.diffuseTransmission},
             {"anisotropy", r.anisotropy},
             {"iridescence", r.iridescence},
             {"iridescenceThickness", r.iridescenceThickness},
             {"dispersion", r.dispersion},
             {"emission", floats(r.emission)},
             {"unlit", r.unlit != 0}},
            {}};
  }

  ExplainedEvent lightChoice(const shared::ExplainLightChoice& r) const {
    ExplainedEvent event{"light", {}, {}};
    if (r.light == shared::kNoLight) {
      event.set("light", std::string("none"));
      return event;
    }
    const bool ofInstance = r.type == shared::kLightTriangle || r.type == shared::kLightSolid;
    std::string name = r.type == shared::kLightEnvironment ? "environment" : nameOf(names_.lights, r.light);
    if (ofInstance) name = nameOf(names_.instances, r.instance);
    event.set("light", std::move(name));
    event.set("lightType", nameIn(kLightTypes, r.type));
    if (ofInstance) {
      event.set("instance", integer(r.instance));
      event.set("geometry", integer(r.geometry));
      event.set("primitive", integer(r.primitive));
    }
    event.set("probability", r.probability);
    return event;
  }

  // The latest event of this type in the innermost open one, or a new one.
  ExplainedEvent& latest(const char* type) {
    std::vector<ExplainedEvent>& children = parent().children;
    for (auto child = children.rbegin(); child != children.rend() && child->type != "ray"; ++child)
      if (child->type == type) return *child;
    return children.emplace_back(ExplainedEvent{type, {}, {}});
  }

  void addLightSample(const shared::ExplainLightSample& r) {
    ExplainedEvent& light = latest("light");
    light.set("direction", floats(r.direction));
    light.set("distance", r.distance);
    light.set("radiance", floats(r.radiance));
    light.set("pdf", r.pdf);
    light.set("delta", r.delta != 0);
    light.set("bsdf", floats(r.bsdf));
    light.set("bsdfPdf", r.bsdfPdf);
    light.set("misWeight", r.misWeight);
    light.set("throughput", floats(r.throughput));
  }

  void addLightRoulette(const shared::ExplainLightRoulette& r) {
    ExplainedEvent& light = latest("light");
    light.set("survival", r.survival);
    light.set("u", r.u);
    light.set("survived", r.u < r.survival);
  }

  void addVisibility(const vec3& transmittance) {
    std::vector<ExplainedEvent>& children = parent().children;
    if (!droppedRay_ && !children.empty() && children.back().type == "ray")
      children.back().set("transmittance", floats(transmittance));
    droppedRay_ = false;
  }

  void addBsdfSample(const shared::ExplainBsdfSample& r) {
    ExplainedEvent& bsdf = latest("bsdf");
    bsdf.set("useful", r.useful != 0);
    if (r.useful == 0) return;
    bsdf.set("direction", floats(r.direction));
    bsdf.set("pdf", r.pdf);
    bsdf.set("weight", floats(r.weight));
    bsdf.set("delta", r.delta != 0);
    bsdf.set("transmitted", r.transmitted != 0);
    bsdf.set("straight", r.straight != 0);
  }

  static ExplainedEvent contribution(const shared::ExplainContribution& r) {
    ExplainedEvent event{
        "contribution",
        {{"source", nameIn(kSources, r.source)}, {"scatterings", integer(r.scatterings)}, {"value", floats(r.value)}},
        {}};
    if (r.value != r.unclamped) event.set("unclamped", floats(r.unclamped));
    return event;
  }

  const program::RunnableProgram& runnable_;
  const program::Program& program_;
  const std::vector<program::MissShader> misses_;
  const SceneNames& names_;
  const uvec2 pixel_;
  std::vector<ExplainedEvent> open_;  // from the root to the innermost event
  bool droppedRay_ = false;           // the latest ray was dropped, and its visibility follows
};

}  // namespace

std::vector<ExplainedEvent> buildEvents(const render::LogContents& log, const program::RunnableProgram& program,
                                        const SceneNames& names, uvec2 pixel) {
  Builder builder(program, names, pixel);
  for (const render::LogRecord& record : log.records) builder.add(record.kind, log.wordsOf(record));
  return builder.finish();
}

}  // namespace quintet::job
