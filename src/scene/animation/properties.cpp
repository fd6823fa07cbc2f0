// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/properties.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "base/normal_float.h"
#include "scene/defaults/auto_camera.h"
#include "scene/geometry/repair.h"
#include "scene/model/limits.h"
#include "scene/model/material_textures.h"

namespace quintet::scene {
namespace {

constexpr float kHuge = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::min();

template <class Object>
struct Row {
  std::string_view pointer;  // empty if the object of glTF does not have the property
  std::size_t size;
  void (*set)(Object&, const vec4& value);
  std::string_view key = {};  // in scene files; empty if they cannot animate the property
};

// Setters of members with a range.
template <auto member, int low, int high>
void setNumber(Material& material, const vec4& value) {
  material.*member = std::clamp(value.x, static_cast<float>(low), high < 0 ? kHuge : static_cast<float>(high));
}
template <auto member, int high>
void setColor(Material& material, const vec4& value) {
  material.*member = glm::clamp(vec3(value), 0.0f, high < 0 ? kHuge : static_cast<float>(high));
}
constexpr int kUnlimited = -1;

constexpr auto kMaterialRows = std::to_array<Row<Material>>({
    {"pbrMetallicRoughness/baseColorFactor", 4,
     [](Material& m, const vec4& v) { m.baseColor = glm::clamp(v, 0.0f, 1.0f); }},
    {"pbrMetallicRoughness/metallicFactor", 1, setNumber<&Material::metallic, 0, 1>, "metallic"},
    {"pbrMetallicRoughness/roughnessFactor", 1, setNumber<&Material::roughness, 0, 1>, "roughness"},
    {"normalTexture/scale", 1, [](Material& m, const vec4& v) { m.normalScale = v.x; }, "normal_scale"},
    {"alphaCutoff", 1, setNumber<&Material::alphaCutoff, 0, kUnlimited>, "alpha_cutoff"},
    {"emissiveFactor", 3, [](Material& m, const vec4& v) { m.emissive = glm::clamp(vec3(v), 0.0f, kMaxRadiance); },
     "emissive"},
    {"extensions/KHR_materials_emissive_strength/emissiveStrength", 1,
     [](Material& m, const vec4& v) { m.emissive = glm::min(m.emissive * std::clamp(v.x, 0.0f, kHuge), kMaxRadiance); },
     "emissive_strength"},
    {"extensions/KHR_materials_ior/ior", 1,
     [](Material& m, const vec4& v) { m.ior = v.x == 0.0f ? 0.0f : std::clamp(v.x, 1.0f, kHuge); }, "ior"},
    {"extensions/KHR_materials_transmission/transmissionFactor", 1, setNumber<&Material::transmission, 0, 1>,
     "transmission"},
    {"extensions/KHR_materials_volume/thicknessFactor", 1, setNumber<&Material::thickness, 0, kUnlimited>, "thickness"},
    {"extensions/KHR_materials_volume/attenuationDistance", 1,
     [](Material& m, const vec4& v) { m.attenuationDistance = distanceOrInfinity(std::max(v.x, kSmallest)); },
     "attenuation_distance"},
    {"extensions/KHR_materials_volume/attenuationColor", 3,
     [](Material& m, const vec4& v) { m.attenuationColor = glm::clamp(vec3(v), 1e-6f, 1.0f); }, "attenuation_color"},
    {"extensions/KHR_materials_volume_scatter/multiscatterColor", 3, setColor<&Material::multiscatterColor, 1>,
     "multiscatter_color"},
    {"extensions/KHR_materials_volume_scatter/scatterAnisotropy", 1,
     [](Material& m, const vec4& v) { m.scatterAnisotropy = std::clamp(v.x, -0.999f, 0.999f); }, "scatter_anisotropy"},
    {"extensions/KHR_materials_specular/specularFactor", 1, setNumber<&Material::specular, 0, 1>, "specular"},
    {"extensions/KHR_materials_specular/specularColorFactor", 3, setColor<&Material::specularColor, kUnlimited>,
     "specular_color"},
    {"extensions/KHR_materials_clearcoat/clearcoatFactor", 1, setNumber<&Material::clearcoat, 0, 1>, "clearcoat"},
    {"extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", 1, setNumber<&Material::clearcoatRoughness, 0, 1>,
     "clearcoat_roughness"},
    {"extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale", 1,
     [](Material& m, const vec4& v) { m.clearcoatNormalScale = v.x; }, "clearcoat_normal_scale"},
    {"extensions/KHR_materials_sheen/sheenColorFactor", 3, setColor<&Material::sheenColor, 1>, "sheen_color"},
    {"extensions/KHR_materials_sheen/sheenRoughnessFactor", 1, setNumber<&Material::sheenRoughness, 0, 1>,
     "sheen_roughness"},
    {"extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", 1,
     setNumber<&Material::diffuseTransmission, 0, 1>, "diffuse_transmission"},
    {"extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", 3,
     setColor<&Material::diffuseTransmissionColor, 1>, "diffuse_transmission_color"},
    {"extensions/KHR_materials_anisotropy/anisotropyStrength", 1, setNumber<&Material::anisotropy, 0, 1>, "anisotropy"},
    {"extensions/KHR_materials_anisotropy/anisotropyRotation", 1,
     [](Material& m, const vec4& v) { m.anisotropyRotation = v.x; }, "anisotropy_rotation"},
    {"extensions/KHR_materials_iridescence/iridescenceFactor", 1, setNumber<&Material::iridescence, 0, 1>,
     "iridescence"},
    {"extensions/KHR_materials_iridescence/iridescenceIor", 1, setNumber<&Material::iridescenceIor, 1, kUnlimited>,
     "iridescence_ior"},
    {"extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", 1,
     setNumber<&Material::iridescenceThicknessMinimum, 0, kUnlimited>, "iridescence_thickness_minimum"},
    {"extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", 1,
     setNumber<&Material::iridescenceThicknessMaximum, 0, kUnlimited>, "iridescence_thickness_maximum"},
    {"extensions/KHR_materials_dispersion/dispersion", 1, setNumber<&Material::dispersion, 0, kUnlimited>,
     "dispersion"},
    {"", 3, [](Material& m, const vec4& v) { m.baseColor = vec4(glm::clamp(vec3(v), 0.0f, 1.0f), m.baseColor.a); },
     "base_color"},
    {"", 1, [](Material& m, const vec4& v) { m.baseColor.a = std::clamp(v.x, 0.0f, 1.0f); }, "alpha"},
});

// The textures of kMaterialTextures without the occlusion texture, which no shader reads.
constexpr auto kTexturePointers = std::to_array<std::string_view>({
    "pbrMetallicRoughness/baseColorTexture",
    "pbrMetallicRoughness/metallicRoughnessTexture",
    "normalTexture",
    "emissiveTexture",
    "extensions/KHR_materials_transmission/transmissionTexture",
    "extensions/KHR_materials_specular/specularTexture",
    "extensions/KHR_materials_specular/specularColorTexture",
    "extensions/KHR_materials_clearcoat/clearcoatTexture",
    "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
    "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
    "extensions/KHR_materials_sheen/sheenColorTexture",
    "extensions/KHR_materials_sheen/sheenRoughnessTexture",
    "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture",
    "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture",
    "extensions/KHR_materials_anisotropy/anisotropyTexture",
    "extensions/KHR_materials_iridescence/iridescenceTexture",
    "extensions/KHR_materials_iridescence/iridescenceThicknessTexture",
});
static_assert(kTexturePointers.size() + 1 == kMaterialTextures.size());

constexpr std::string_view kTransform = "/extensions/KHR_texture_transform/";
constexpr auto kTransformRows = std::to_array<Row<TextureUse>>({
    {"offset", 2, [](TextureUse& t, const vec4& v) { t.offset = vec2(v); }},
    {"rotation", 1, [](TextureUse& t, const vec4& v) { t.rotation = v.x; }},
    {"scale", 2, [](TextureUse& t, const vec4& v) { t.scale = vec2(v); }},
});

constexpr auto kLightRows = std::to_array<Row<Light>>({
    {"color", 3, [](Light& l, const vec4& v) { l.intensity = glm::clamp(vec3(v), 0.0f, kMaxRadiance); }, "color"},
    {"intensity", 1,
     [](Light& l, const vec4& v) { l.intensity = glm::min(l.intensity * std::clamp(v.x, 0.0f, kHuge), kMaxRadiance); },
     "intensity"},
    {"range", 1,
     [](Light& l, const vec4& v) {
       if (l.type != LightType::directional) l.range = v.x > 0.0f ? distanceOrInfinity(v.x) : Light().range;
     },
     "range"},
    {"spot/outerConeAngle", 1,
     [](Light& l, const vec4& v) {
       l.outerConeAngle = std::clamp(v.x, 1e-4f, kPi / 2.0f);
       l.innerConeAngle = std::min(l.innerConeAngle, l.outerConeAngle);
     },
     "outer_angle"},
    {"spot/innerConeAngle", 1,
     [](Light& l, const vec4& v) { l.innerConeAngle = std::clamp(v.x, 0.0f, l.outerConeAngle); }, "inner_angle"},
    {"", 3,
     [](Light& l, const vec4& v) {
       if (isFinite(vec3(v))) l.position = vec3(v);
     },
     "position"},
    {"", 3, [](Light& l, const vec4& v) { l.direction = directionOr(vec3(v), l.direction); }, "direction"},
    {"", 3, [](Light& l, const vec4& v) { l.direction = directionOr(vec3(v) - l.position, l.direction); }, "target"},
});

constexpr float kSmallestAngle = 1e-4f;

// Sets the z axis of the frame; `up` makes the frame rigid.
void setLookAt(Camera& camera, const vec4& value) {
  const vec3 toTarget = vec3(value) - vec3(camera.worldFromCamera[3]);
  const float distance = glm::length(toTarget);
  if (!std::isfinite(distance) || !(distance > 0.0f)) return;
  camera.worldFromCamera[2] = vec4(toTarget / -distance, 0.0f);
  camera.focusDistance = distance;
}

void setUp(Camera& camera, const vec4& value) {
  const vec3 back = directionOr(vec3(camera.worldFromCamera[2]), vec3(0, 0, 1));
  const vec3 up = directionOr(vec3(value), vec3(camera.worldFromCamera[1]));
  camera.worldFromCamera = lookingFrame(vec3(camera.worldFromCamera[3]), -back, up);
}

constexpr auto kCameraRows = std::to_array<Row<Camera>>({
    {"perspective/yfov", 1,
     [](Camera& c, const vec4& v) { c.verticalFov = std::clamp(v.x, kSmallestAngle, kPi - kSmallestAngle); }, "fov"},
    {"orthographic/xmag", 1,
     [](Camera& c, const vec4& v) { c.orthographicHalfSize.x = std::max(std::abs(v.x), kSmallest); }},
    {"orthographic/ymag", 1,
     [](Camera& c, const vec4& v) { c.orthographicHalfSize.y = std::max(std::abs(v.x), kSmallest); }},
    {"", 2, [](Camera& c, const vec4& v) { c.orthographicHalfSize = glm::clamp(vec2(v), kSmallest, kHuge); },
     "orthographic"},
    {"", 3,
     [](Camera& c, const vec4& v) {
       if (isFinite(vec3(v))) c.worldFromCamera[3] = vec4(vec3(v), 1.0f);
     },
     "look_from"},
    {"", 3, setLookAt, "look_at"},
    {"", 3, setUp, "up"},
    {"", 1, [](Camera& c, const vec4& v) { c.focusDistance = std::clamp(v.x, kSmallest, kHuge); }, "focus"},
    {"", 1, [](Camera& c, const vec4& v) { c.apertureRadius = std::clamp(v.x, 0.0f, kHuge); }, "aperture"},
});

constexpr auto kEnvironmentRows = std::to_array<Row<Environment>>({
    {"", 1,
     [](Environment& e, const vec4& v) { e.intensity = std::clamp(v.x * e.animatedIntensityFactor, 0.0f, kHuge); },
     "intensity"},
    {"", 1,
     [](Environment& e, const vec4& v) {
       if (std::isfinite(v.x)) e.rotation = v.x + e.animatedRotationOffset;
     },
     "rotation"},
});

template <class Object>
std::optional<PropertyInfo> find(std::span<const Row<Object>> rows, std::string_view name,
                                 std::string_view Row<Object>::*column = &Row<Object>::pointer) {
  const auto found = std::ranges::find(rows, name, column);
  if (name.empty() || found == rows.end()) return std::nullopt;
  return PropertyInfo{static_cast<std::size_t>(found - rows.begin()), found->size};
}

}  // namespace

std::optional<PropertyInfo> findMaterialProperty(std::string_view pointer) {
  const std::size_t at = pointer.find(kTransform);
  if (at == std::string_view::npos) return find<Material>(kMaterialRows, pointer);
  const auto texture = std::ranges::find(kTexturePointers, pointer.substr(0, at));
  const std::optional<PropertyInfo> row = find<TextureUse>(kTransformRows, pointer.substr(at + kTransform.size()));
  if (texture == kTexturePointers.end() || !row) return std::nullopt;
  const auto k = static_cast<std::size_t>(texture - kTexturePointers.begin());
  return PropertyInfo{kMaterialRows.size() + k * kTransformRows.size() + row->index, row->size,
                      kMaterialTextures[k].use};
}

std::optional<PropertyInfo> findLightProperty(std::string_view pointer) { return find<Light>(kLightRows, pointer); }
std::optional<PropertyInfo> findCameraProperty(std::string_view pointer) { return find<Camera>(kCameraRows, pointer); }

std::optional<PropertyInfo> findMaterialKey(std::string_view key) {
  return find<Material>(kMaterialRows, key, &Row<Material>::key);
}
std::optional<PropertyInfo> findLightKey(std::string_view key) {
  return find<Light>(kLightRows, key, &Row<Light>::key);
}
std::optional<PropertyInfo> findCameraKey(std::string_view key) {
  return find<Camera>(kCameraRows, key, &Row<Camera>::key);
}
std::optional<PropertyInfo> findEnvironmentKey(std::string_view key) {
  return find<Environment>(kEnvironmentRows, key, &Row<Environment>::key);
}

void setMaterialValue(Material& material, std::size_t property, const vec4& value) {
  if (property < kMaterialRows.size()) return kMaterialRows[property].set(material, value);
  const std::size_t transform = property - kMaterialRows.size();
  kTransformRows[transform % kTransformRows.size()].set(
      material.*kMaterialTextures[transform / kTransformRows.size()].use, value);
}

void setLightValue(Light& light, std::size_t property, const vec4& value) { kLightRows[property].set(light, value); }
void setCameraValue(Camera& camera, std::size_t property, const vec4& value) {
  kCameraRows[property].set(camera, value);
}
void setEnvironmentValue(Environment& environment, std::size_t property, const vec4& value) {
  kEnvironmentRows[property].set(environment, value);
}

}  // namespace quintet::scene
