// SPDX-License-Identifier: Apache-2.0
#include "shader/stage_builtins.h"

#include <algorithm>
#include <array>

namespace quintet::shader {
namespace {

constexpr unsigned bit(Stage stage) { return 1u << static_cast<unsigned>(stage); }
constexpr unsigned kRayGeneration = bit(Stage::rayGeneration);
constexpr unsigned kIntersection = bit(Stage::intersection);
constexpr unsigned kAnyHit = bit(Stage::anyHit);
constexpr unsigned kClosestHit = bit(Stage::closestHit);
constexpr unsigned kMiss = bit(Stage::miss);
constexpr unsigned kCallable = bit(Stage::callable);

constexpr unsigned kHit = kAnyHit | kClosestHit;
constexpr unsigned kPrimitive = kIntersection | kHit;
constexpr unsigned kRay = kPrimitive | kMiss;
constexpr unsigned kAll = kRay | kRayGeneration | kCallable;

constexpr StageBuiltIn kBuiltIns[] = {
    {"executeCallableEXT", kRayGeneration | kClosestHit | kMiss | kCallable, true},
    {"gl_GeometryIndexEXT", kPrimitive},
    {"gl_HitKindEXT", kHit},
    {"gl_HitTEXT", kHit},
    {"gl_IncomingRayFlagsEXT", kRay},
    {"gl_InstanceCustomIndexEXT", kPrimitive},
    {"gl_InstanceID", kPrimitive},
    {"gl_LaunchIDEXT", kAll},
    {"gl_LaunchSizeEXT", kAll},
    {"gl_ObjectRayDirectionEXT", kPrimitive},
    {"gl_ObjectRayOriginEXT", kPrimitive},
    {"gl_ObjectToWorld3x4EXT", kPrimitive},
    {"gl_ObjectToWorldEXT", kPrimitive},
    {"gl_PrimitiveID", kPrimitive},
    {"gl_RayTmaxEXT", kRay},
    {"gl_RayTminEXT", kRay},
    {"gl_WorldRayDirectionEXT", kRay},
    {"gl_WorldRayOriginEXT", kRay},
    {"gl_WorldToObject3x4EXT", kPrimitive},
    {"gl_WorldToObjectEXT", kPrimitive},
    {"ignoreIntersectionEXT", kAnyHit, true},
    {"reportIntersectionEXT", kIntersection, true},
    {"terminateRayEXT", kAnyHit, true},
    {"traceRayEXT", kRayGeneration | kClosestHit | kMiss, true},
};

constexpr std::array kRayTracingStages{Stage::rayGeneration, Stage::intersection, Stage::anyHit,
                                       Stage::closestHit,    Stage::miss,         Stage::callable};

// Returns the name that a message starts with: "gl_HitTEXT" for "'gl_HitTEXT' : undeclared identifier".
std::string_view quotedName(std::string_view message) {
  if (!message.starts_with('\'')) return {};
  const std::size_t close = message.find('\'', 1);
  return close == message.npos ? std::string_view{} : message.substr(1, close - 1);
}

std::string withArticle(Stage stage) {
  const std::string name(stageName(stage));
  const bool vowel = name.starts_with('a') || name.starts_with('i');
  return (vowel ? "an " : "a ") + name + " shader";
}

bool isMissing(std::string_view message) {
  return message.find("' : undeclared identifier") != message.npos ||
         message.find("' : no matching overloaded function found") != message.npos ||
         message.find("' : not supported in this stage") != message.npos;
}

}  // namespace

std::span<const StageBuiltIn> stageBuiltIns() { return kBuiltIns; }

const StageBuiltIn* findStageBuiltIn(std::string_view name) {
  const auto* found = std::ranges::lower_bound(kBuiltIns, name, {}, &StageBuiltIn::name);
  return found != std::end(kBuiltIns) && found->name == name ? found : nullptr;
}

std::string stagesWith(const StageBuiltIn& builtIn) {
  std::vector<std::string_view> names;
  for (const Stage stage : kRayTracingStages)
    if (builtIn.availableIn(stage)) names.push_back(stageName(stage));
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

void explainMissingBuiltIns(std::vector<Diagnostic>& diagnostics, Stage stage) {
  for (Diagnostic& d : diagnostics) {
    if (d.severity != Severity::error || !isMissing(d.text)) continue;
    const std::string name(quotedName(d.text));
    if (name == "hitAttributeEXT") {
      d.id = "Q204";
      d.text = "hitAttributeEXT in " + withArticle(stage) +
               "; hit attributes exist only in intersection, any-hit and closest-hit shaders";
      continue;
    }
    const StageBuiltIn* builtIn = findStageBuiltIn(name);
    if (builtIn == nullptr || std::ranges::find(kRayTracingStages, stage) == kRayTracingStages.end() ||
        builtIn->availableIn(stage))
      continue;
    d.id = "Q706";
    d.text = name + (builtIn->function ? " cannot be used in " : " does not exist in ") + withArticle(stage) +
             "; available in " + stagesWith(*builtIn) + " shaders";
  }
}

}  // namespace quintet::shader
