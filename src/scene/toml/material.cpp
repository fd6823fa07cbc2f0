// SPDX-License-Identifier: Apache-2.0
// [[material]]: all members of scene::Material, with textures and keyframes. The keys are the names of the members in
// snake_case.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/normal_float.h"
#include "scene/model/limits.h"
#include "scene/toml/context.h"
#include "scene/toml/keyframes.h"

namespace quintet::scene {
namespace {

constexpr NumberRange kAtLeastOne{1.0};
constexpr NumberRange kColorAboveZero{0.0, 1.0, true};

// Loads each image once per path, and creates one texture per image and sampler.
class TextureReader {
 public:
  explicit TextureReader(SceneTomlContext& context) : context_(context) {}

  // key = "image.png" or { image, uv_set, offset, scale, rotation, wrap, filter }.
  TextureUse operator()(TomlReader& material, const std::string& key, const TextureUse& fallback) {
    const TomlValue* value = material.find(key);
    if (!value) return fallback;
    TextureUse use;
    if (value->kind == TomlValue::Kind::text) {
      const int image = loadImage(*value, value->text);
      if (image != kNone) use.texture = texture(image, {});
      return use;
    }
    TomlReader reader(material.toTable(*value, key), fmt::format("'{}' of {}", key, material.what()), context_.file);
    const TomlValue& path = reader.require("image");
    const int image = loadImage(path, reader.toText(path, "image"));
    use.uvSet = static_cast<int>(reader.integer("uv_set", 0, 0, kMaxUvSets - 1));
    use.offset = reader.pair("offset", use.offset);
    use.scale = reader.pair("scale", use.scale);
    use.rotation = glm::radians(reader.number("rotation", 0.0f));
    Sampler sampler;
    const std::vector<std::string> wraps{"repeat", "mirrored_repeat", "clamp_to_edge"};
    const std::size_t wrap = reader.choice("wrap", wraps, 0);
    sampler.wrapU = static_cast<Wrap>(reader.choice("wrap_u", wraps, wrap));
    sampler.wrapV = static_cast<Wrap>(reader.choice("wrap_v", wraps, wrap));
    sampler.filter = static_cast<Filter>(reader.choice("filter", {"linear", "nearest"}, 0));
    reader.rejectUnknownKeys();
    if (image == kNone) return {};
    use.texture = texture(image, sampler);
    return use;
  }

 private:
  // kNone, with a line in the report, for an image that is missing or invalid if the options allow it.
  int loadImage(const TomlValue& at, const std::string& path) {
    try {
      return readImage(at, path);
    } catch (const FileError& error) {
      if (context_.options.missingTextures == MissingTextures::error || context_.options.strict) throw;
      const std::string inside =
          error.file() == context_.file ? error.problem() : fmt::format("{}: {}", path, error.problem());
      context_.scene.report.ignored.push_back(
          fmt::format("line {}: {}; rendered without the texture", at.line, inside));
      return kNone;
    }
  }

  int readImage(const TomlValue& at, const std::string& path) {
    const std::filesystem::path file = context_.resolvePath(at, path).lexically_normal();
    const auto known = images_.find(file.string());
    if (known != images_.end()) return known->second;
    std::vector<NamedImage>& images = context_.scene.images;
    images.push_back({file.string(), context_.readImage(file)});
    return images_.emplace(file.string(), static_cast<int>(images.size()) - 1).first->second;
  }

  int texture(int image, const Sampler& sampler) {
    std::vector<Texture>& textures = context_.scene.textures;
    for (std::size_t i = 0; i < textures.size(); ++i)
      if (textures[i].image == image && textures[i].sampler == sampler) return static_cast<int>(i);
    textures.push_back({std::string(), image, sampler});
    return static_cast<int>(textures.size()) - 1;
  }

  SceneTomlContext& context_;
  std::map<std::string, int> images_;
};

// The keys that keyframes can change.
struct MaterialKeys {
  Material values;  // without the emission
  vec3 emissive{0.0f};
  float emissiveStrength = 1.0f;
};

void readBaseColor(TomlReader& reader, Material& m) {
  const TomlValue* value = reader.find("base_color");
  if (value && value->kind == TomlValue::Kind::array && value->elements.size() == 4) {
    const std::vector<float> n = reader.toNumbers(*value, "base_color", 4, kUnit);
    m.baseColor = {n[0], n[1], n[2], n[3]};
  } else if (value) {
    m.baseColor = vec4(toColor(reader, *value, "base_color", kUnit), m.baseColor.a);
  }
  m.baseColor.a = reader.number("alpha", m.baseColor.a, kUnit);
}

void readEmission(TomlReader& reader, MaterialKeys& keys) {
  keys.emissive = readColor(reader, "emissive", keys.emissive, kNotNegative);
  keys.emissiveStrength = reader.number("emissive_strength", keys.emissiveStrength, kNotNegative);
  const vec3 product = keys.emissive * keys.emissiveStrength;
  if (!(std::max({product.x, product.y, product.z}) <= kMaxRadiance))
    reader.fail(fmt::format("the emission of {} is too large; at most {:g}", reader.what(), kMaxRadiance));
}

// Transmission and the volume inside.
void readTransmission(TomlReader& reader, Material& m) {
  m.ior = reader.number("ior", m.ior, kAtLeastOne);
  m.transmission = reader.number("transmission", m.transmission, kUnit);
  m.diffuseTransmission = reader.number("diffuse_transmission", m.diffuseTransmission, kUnit);
  m.diffuseTransmissionColor = readColor(reader, "diffuse_transmission_color", m.diffuseTransmissionColor, kUnit);
  m.thickness = reader.number("thickness", m.thickness, kNotNegative);
  if (const TomlValue* const distance = reader.find("attenuation_distance"))
    m.attenuationDistance = distanceOrInfinity(reader.toNumber(*distance, "attenuation_distance", kPositive));
  m.attenuationColor = readColor(reader, "attenuation_color", m.attenuationColor, kColorAboveZero);
  m.dispersion = reader.number("dispersion", m.dispersion, kNotNegative);
  m.multiscatterColor = readColor(reader, "multiscatter_color", m.multiscatterColor, kUnit);
  m.scatterAnisotropy = reader.number("scatter_anisotropy", m.scatterAnisotropy, {-1.0, 1.0, true, true});
}

void readLayers(TomlReader& reader, Material& m) {
  m.specular = reader.number("specular", m.specular, kUnit);
  m.specularColor = readColor(reader, "specular_color", m.specularColor, kNotNegative);
  m.clearcoat = reader.number("clearcoat", m.clearcoat, kUnit);
  m.clearcoatRoughness = reader.number("clearcoat_roughness", m.clearcoatRoughness, kUnit);
  m.clearcoatNormalScale = reader.number("clearcoat_normal_scale", m.clearcoatNormalScale);
  m.sheenColor = readColor(reader, "sheen_color", m.sheenColor, kUnit);
  m.sheenRoughness = reader.number("sheen_roughness", m.sheenRoughness, kUnit);
  m.anisotropy = reader.number("anisotropy", m.anisotropy, kUnit);
  m.anisotropyRotation = glm::radians(reader.number("anisotropy_rotation", glm::degrees(m.anisotropyRotation)));
  m.iridescence = reader.number("iridescence", m.iridescence, kUnit);
  m.iridescenceIor = reader.number("iridescence_ior", m.iridescenceIor, kAtLeastOne);
  m.iridescenceThicknessMinimum =
      reader.number("iridescence_thickness_minimum", m.iridescenceThicknessMinimum, kNotNegative);
  m.iridescenceThicknessMaximum =
      reader.number("iridescence_thickness_maximum", m.iridescenceThicknessMaximum, kNotNegative);
}

// Reads the keys of a material or of one of its keyframes. Missing ones keep their values.
MaterialKeys readKeys(TomlReader& reader, MaterialKeys keys) {
  Material& m = keys.values;
  readBaseColor(reader, m);
  m.metallic = reader.number("metallic", m.metallic, kUnit);
  m.roughness = reader.number("roughness", m.roughness, kUnit);
  m.normalScale = reader.number("normal_scale", m.normalScale);
  m.alphaCutoff = reader.number("alpha_cutoff", m.alphaCutoff, kNotNegative);
  readEmission(reader, keys);
  readTransmission(reader, m);
  readLayers(reader, m);
  return keys;
}

// The keys that do not change with the time, except textures.
void readModes(TomlReader& reader, Material& m) {
  m.occlusionStrength = reader.number("occlusion_strength", m.occlusionStrength, kUnit);
  m.alphaMode = static_cast<AlphaMode>(
      reader.choice("alpha_mode", {"opaque", "mask", "blend"}, static_cast<std::size_t>(m.alphaMode)));
  m.doubleSided = reader.boolean("double_sided", m.doubleSided);
  m.unlit = reader.boolean("unlit", m.unlit);
  m.dielectricPriority = reader.number("dielectric_priority", m.dielectricPriority);
}

void readTextures(TomlReader& reader, TextureReader& texture, Material& m) {
  constexpr std::pair<const char*, TextureUse Material::*> kKeys[] = {
      {"base_color_texture", &Material::baseColorTexture},
      {"metallic_roughness_texture", &Material::metallicRoughnessTexture},
      {"normal_texture", &Material::normalTexture},
      {"occlusion_texture", &Material::occlusionTexture},
      {"emissive_texture", &Material::emissiveTexture},
      {"transmission_texture", &Material::transmissionTexture},
      {"diffuse_transmission_texture", &Material::diffuseTransmissionTexture},
      {"diffuse_transmission_color_texture", &Material::diffuseTransmissionColorTexture},
      {"specular_texture", &Material::specularTexture},
      {"specular_color_texture", &Material::specularColorTexture},
      {"clearcoat_texture", &Material::clearcoatTexture},
      {"clearcoat_roughness_texture", &Material::clearcoatRoughnessTexture},
      {"clearcoat_normal_texture", &Material::clearcoatNormalTexture},
      {"sheen_color_texture", &Material::sheenColorTexture},
      {"sheen_roughness_texture", &Material::sheenRoughnessTexture},
      {"anisotropy_texture", &Material::anisotropyTexture},
      {"iridescence_texture", &Material::iridescenceTexture},
      {"iridescence_thickness_texture", &Material::iridescenceThicknessTexture},
  };
  for (const auto& [key, use] : kKeys) m.*use = texture(reader, key, m.*use);
}

std::vector<KeyTrack> tracksOf(const std::vector<MaterialKeys>& states) {
  constexpr std::pair<const char*, float Material::*> kNumbers[] = {
      {"metallic", &Material::metallic},
      {"roughness", &Material::roughness},
      {"normal_scale", &Material::normalScale},
      {"alpha_cutoff", &Material::alphaCutoff},
      {"ior", &Material::ior},
      {"transmission", &Material::transmission},
      {"diffuse_transmission", &Material::diffuseTransmission},
      {"thickness", &Material::thickness},
      {"attenuation_distance", &Material::attenuationDistance},
      {"dispersion", &Material::dispersion},
      {"scatter_anisotropy", &Material::scatterAnisotropy},
      {"specular", &Material::specular},
      {"clearcoat", &Material::clearcoat},
      {"clearcoat_roughness", &Material::clearcoatRoughness},
      {"clearcoat_normal_scale", &Material::clearcoatNormalScale},
      {"sheen_roughness", &Material::sheenRoughness},
      {"anisotropy", &Material::anisotropy},
      {"iridescence", &Material::iridescence},
      {"iridescence_ior", &Material::iridescenceIor},
      {"iridescence_thickness_minimum", &Material::iridescenceThicknessMinimum},
      {"iridescence_thickness_maximum", &Material::iridescenceThicknessMaximum},
  };
  constexpr std::pair<const char*, vec3 Material::*> kColors[] = {
      {"diffuse_transmission_color", &Material::diffuseTransmissionColor},
      {"attenuation_color", &Material::attenuationColor},
      {"multiscatter_color", &Material::multiscatterColor},
      {"specular_color", &Material::specularColor},
      {"sheen_color", &Material::sheenColor},
  };
  constexpr int kEmission = 1;  // the scene has the product of color and strength
  std::vector<KeyTrack> tracks;
  const auto add = [&](const char* key, auto value, int group = 0, float unit = 1.0f) {
    KeyTrack& track = tracks.emplace_back(KeyTrack{.key = key, .property = *findMaterialKey(key)});
    for (const MaterialKeys& keys : states) track.values.push_back(value(keys));
    track.group = group;
    track.unit = unit;
  };
  add("base_color", [](const MaterialKeys& k) { return vec4(vec3(k.values.baseColor), 0.0f); });
  add("alpha", [](const MaterialKeys& k) { return vec4(k.values.baseColor.a, vec3(0.0f)); });
  add(
      "emissive", [](const MaterialKeys& k) { return vec4(k.emissive, 0.0f); }, kEmission);
  add(
      "emissive_strength", [](const MaterialKeys& k) { return vec4(k.emissiveStrength, vec3(0.0f)); }, kEmission);
  add(
      "anisotropy_rotation",
      [](const MaterialKeys& k) { return vec4(glm::degrees(k.values.anisotropyRotation), vec3(0.0f)); }, 0,
      glm::radians(1.0f));
  for (const auto& [key, number] : kNumbers)
    add(key, [number = number](const MaterialKeys& k) { return vec4(k.values.*number, vec3(0.0f)); });
  for (const auto& [key, color] : kColors)
    add(key, [color = color](const MaterialKeys& k) { return vec4(k.values.*color, 0.0f); });
  return tracks;
}

void readMaterial(SceneTomlContext& context, TextureReader& texture, const TomlValue& table) {
  TomlReader reader(table, describeTable("material", table), context.file);
  const TomlValue& nameValue = reader.require("name");
  const std::string name = reader.toText(nameValue, "name");
  context.checkName(nameValue, name);
  MaterialKeys start;
  start.values.metallic = 0.0f;
  if (const TomlValue* like = reader.find("like"))
    start.values = context.scene.materials[static_cast<std::size_t>(context.findMaterial(*like))];
  start.emissive = start.values.emissive;
  const MaterialKeys keys = readKeys(reader, start);
  Material m = keys.values;
  m.name = name;
  m.emissive = keys.emissive * keys.emissiveStrength;
  readModes(reader, m);
  readTextures(reader, texture, m);
  KeyframeList list(reader, context.options.framesPerSecond);
  reader.rejectUnknownKeys();
  const auto index = static_cast<int>(context.scene.materials.size());
  if (!context.materials.emplace(name, index).second)
    context.fail(nameValue, fmt::format("second material '{}'", name));
  std::vector<MaterialKeys> states;
  for (std::size_t i = 0; i < list.size(); ++i)
    states.push_back(readKeys(list.table(i), i == 0 ? keys : states.back()));
  std::vector<AnimatedValue> values = addTracks(context, reader, list, tracksOf(states));
  if (!values.empty()) context.animation.materials.push_back({index, std::move(values)});
  context.scene.materials.push_back(std::move(m));
}

}  // namespace

void readMaterials(SceneTomlContext& context, TomlReader& root) {
  TextureReader texture(context);
  for (const TomlValue& table : root.tables("material")) readMaterial(context, texture, table);
}

}  // namespace quintet::scene
