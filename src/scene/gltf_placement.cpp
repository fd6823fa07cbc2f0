#include "scene/gltf_placement.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/repair.h"

namespace quintet::scene {
namespace {

vec3 directionOr(const vec3& v, const vec3& fallback) {
  const float length = glm::length(v);
  return std::isfinite(length) && length > 0.0f ? v / length : fallback;
}

void readSpot(const tinygltf::Light& from, const std::string& place, Light& light, Report& report) {
  const auto outer = static_cast<float>(from.spot.outerConeAngle), inner = static_cast<float>(from.spot.innerConeAngle);
  light.outerConeAngle = std::clamp(outer, 1e-4f, kPi / 2.0f);
  light.innerConeAngle = std::clamp(inner, 0.0f, light.outerConeAngle);
  if (light.outerConeAngle != outer && outer < kPi / 2.0f + 1e-4f && outer > 0.0f) return;  // rounding of π/2
  if (light.outerConeAngle != outer || light.innerConeAngle != inner)
    report.repaired.push_back(fmt::format("{}/spot: cone angles {} and {} clamped to {} and {}", place, inner, outer,
                                          light.innerConeAngle, light.outerConeAngle));
}

}  // namespace

mat4 rigidFrame(const mat4& m) {
  const vec3 z = directionOr(vec3(m[2]), vec3(0, 0, 1));
  vec3 x = glm::cross(directionOr(vec3(m[1]), vec3(0, 1, 0)), z);
  x = glm::length(x) > 1e-4f ? glm::normalize(x) : anyPerpendicular(z);
  return {vec4(x, 0.0f), vec4(glm::cross(z, x), 0.0f), vec4(z, 0.0f), vec4(vec3(m[3]), 1.0f)};
}

Camera placeCamera(const Document& document, int index, const tinygltf::Node& node, const mat4& worldFromNode) {
  const tinygltf::Camera& from = document.model.cameras[static_cast<std::size_t>(index)];
  const std::string place = fmt::format("/cameras/{}/{}", index, from.type);
  Camera camera;
  camera.name = from.name.empty() ? node.name : from.name;
  camera.worldFromCamera = rigidFrame(worldFromNode);
  if (from.type == "perspective") {
    camera.verticalFov = static_cast<float>(from.perspective.yfov);
    if (!(camera.verticalFov > 0.0f && camera.verticalFov < kPi))
      document.fail(place + "/yfov", fmt::format("{} is no angle between 0 and π", from.perspective.yfov));
    camera.aspect = std::max(0.0f, static_cast<float>(from.perspective.aspectRatio));
  } else {
    camera.orthographic = true;
    camera.orthographicHalfSize = glm::abs(vec2(from.orthographic.xmag, from.orthographic.ymag));
    if (!(camera.orthographicHalfSize.x > 0.0f && camera.orthographicHalfSize.y > 0.0f))
      document.fail(place, "xmag and ymag must not be zero");
    camera.aspect = camera.orthographicHalfSize.x / camera.orthographicHalfSize.y;
  }
  return camera;
}

void placeLight(const Document& document, int index, const tinygltf::Node& node, const mat4& worldFromNode,
                Scene& scene) {
  const tinygltf::Light& from = document.model.lights[static_cast<std::size_t>(index)];
  const std::string place = fmt::format("/extensions/KHR_lights_punctual/lights/{}", index);
  Light light;
  if (from.type == "spot") {
    light.type = LightType::spot;
  } else if (from.type == "directional") {
    light.type = LightType::directional;
  } else if (from.type != "point") {
    scene.report.ignored.push_back(fmt::format("{}: type \"{}\" is not known", place, from.type.substr(0, 40)));
    return;
  }
  light.name = from.name.empty() ? node.name : from.name;
  const vec3 color = from.color.empty() ? vec3(1.0f) : vec3(from.color[0], from.color[1], from.color[2]);
  light.intensity = glm::max(static_cast<float>(from.intensity) * color, vec3(0.0f));
  light.position = vec3(worldFromNode[3]);
  light.direction = directionOr(-vec3(worldFromNode[2]), vec3(0, 0, -1));
  if (from.range > 0.0) light.range = static_cast<float>(from.range);
  if (light.type == LightType::spot) readSpot(from, place, light, scene.report);
  scene.lights.push_back(std::move(light));
}

}  // namespace quintet::scene
