// SPDX-License-Identifier: Apache-2.0
// [[material]]: all members of scene::Material, with textures. The keys are the names of the members in snake_case.
#include <fmt/format.h>

#include "base/error.h"
#include "scene/toml/context.h"

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

void readEmission(TomlReader& reader, TextureReader& texture, Material& m) {
  m.emissive =
      readColor(reader, "emissive", m.emissive, kNotNegative) * reader.number("emissive_strength", 1.0f, kNotNegative);
  if (!isFinite(m.emissive)) reader.fail(reader.table(), fmt::format("the emission of {} is too large", reader.what()));
  m.emissiveTexture = texture(reader, "emissive_texture", m.emissiveTexture);
}

// Transmission and the volume inside.
void readTransmission(TomlReader& reader, TextureReader& texture, Material& m) {
  m.ior = reader.number("ior", m.ior, kAtLeastOne);
  m.transmission = reader.number("transmission", m.transmission, kUnit);
  m.transmissionTexture = texture(reader, "transmission_texture", m.transmissionTexture);
  m.diffuseTransmission = reader.number("diffuse_transmission", m.diffuseTransmission, kUnit);
  m.diffuseTransmissionTexture = texture(reader, "diffuse_transmission_texture", m.diffuseTransmissionTexture);
  m.diffuseTransmissionColor = readColor(reader, "diffuse_transmission_color", m.diffuseTransmissionColor, kUnit);
  m.diffuseTransmissionColorTexture =
      texture(reader, "diffuse_transmission_color_texture", m.diffuseTransmissionColorTexture);
  m.thickness = reader.number("thickness", m.thickness, kNotNegative);
  m.attenuationDistance = reader.number("attenuation_distance", m.attenuationDistance, kPositive);
  m.attenuationColor = readColor(reader, "attenuation_color", m.attenuationColor, kColorAboveZero);
  m.dispersion = reader.number("dispersion", m.dispersion, kNotNegative);
  m.multiscatterColor = readColor(reader, "multiscatter_color", m.multiscatterColor, kUnit);
  m.scatterAnisotropy = reader.number("scatter_anisotropy", m.scatterAnisotropy, {-1.0, 1.0, true, true});
  m.dielectricPriority = reader.number("dielectric_priority", m.dielectricPriority);
}

void readLayers(TomlReader& reader, TextureReader& texture, Material& m) {
  m.specular = reader.number("specular", m.specular, kUnit);
  m.specularTexture = texture(reader, "specular_texture", m.specularTexture);
  m.specularColor = readColor(reader, "specular_color", m.specularColor, kNotNegative);
  m.specularColorTexture = texture(reader, "specular_color_texture", m.specularColorTexture);
  m.clearcoat = reader.number("clearcoat", m.clearcoat, kUnit);
  m.clearcoatTexture = texture(reader, "clearcoat_texture", m.clearcoatTexture);
  m.clearcoatRoughness = reader.number("clearcoat_roughness", m.clearcoatRoughness, kUnit);
  m.clearcoatRoughnessTexture = texture(reader, "clearcoat_roughness_texture", m.clearcoatRoughnessTexture);
  m.clearcoatNormalTexture = texture(reader, "clearcoat_normal_texture", m.clearcoatNormalTexture);
  m.clearcoatNormalScale = reader.number("clearcoat_normal_scale", m.clearcoatNormalScale);
  m.sheenColor = readColor(reader, "sheen_color", m.sheenColor, kUnit);
  m.sheenColorTexture = texture(reader, "sheen_color_texture", m.sheenColorTexture);
  m.sheenRoughness = reader.number("sheen_roughness", m.sheenRoughness, kUnit);
  m.sheenRoughnessTexture = texture(reader, "sheen_roughness_texture", m.sheenRoughnessTexture);
}

void readAnisotropy(TomlReader& reader, TextureReader& texture, Material& m) {
  m.anisotropy = reader.number("anisotropy", m.anisotropy, kUnit);
  m.anisotropyRotation = glm::radians(reader.number("anisotropy_rotation", glm::degrees(m.anisotropyRotation)));
  m.anisotropyTexture = texture(reader, "anisotropy_texture", m.anisotropyTexture);
}

void readIridescence(TomlReader& reader, TextureReader& texture, Material& m) {
  m.iridescence = reader.number("iridescence", m.iridescence, kUnit);
  m.iridescenceTexture = texture(reader, "iridescence_texture", m.iridescenceTexture);
  m.iridescenceIor = reader.number("iridescence_ior", m.iridescenceIor, kAtLeastOne);
  m.iridescenceThicknessMinimum =
      reader.number("iridescence_thickness_minimum", m.iridescenceThicknessMinimum, kNotNegative);
  m.iridescenceThicknessMaximum =
      reader.number("iridescence_thickness_maximum", m.iridescenceThicknessMaximum, kNotNegative);
  m.iridescenceThicknessTexture = texture(reader, "iridescence_thickness_texture", m.iridescenceThicknessTexture);
}

void readMaterial(SceneTomlContext& context, TextureReader& texture, const TomlValue& table) {
  TomlReader reader(table, describeTable("material", table), context.file);
  const TomlValue& nameValue = reader.require("name");
  const std::string name = reader.toText(nameValue, "name");
  context.checkName(nameValue, name);
  Material m;
  m.metallic = 0.0f;
  if (const TomlValue* like = reader.find("like"))
    m = context.scene.materials[static_cast<std::size_t>(context.findMaterial(*like))];
  m.name = name;
  readBaseColor(reader, m);
  m.baseColorTexture = texture(reader, "base_color_texture", m.baseColorTexture);
  m.metallic = reader.number("metallic", m.metallic, kUnit);
  m.roughness = reader.number("roughness", m.roughness, kUnit);
  m.metallicRoughnessTexture = texture(reader, "metallic_roughness_texture", m.metallicRoughnessTexture);
  m.normalTexture = texture(reader, "normal_texture", m.normalTexture);
  m.normalScale = reader.number("normal_scale", m.normalScale);
  m.occlusionTexture = texture(reader, "occlusion_texture", m.occlusionTexture);
  m.occlusionStrength = reader.number("occlusion_strength", m.occlusionStrength, kUnit);
  readEmission(reader, texture, m);
  m.alphaMode = static_cast<AlphaMode>(
      reader.choice("alpha_mode", {"opaque", "mask", "blend"}, static_cast<std::size_t>(m.alphaMode)));
  m.alphaCutoff = reader.number("alpha_cutoff", m.alphaCutoff, kNotNegative);
  m.doubleSided = reader.boolean("double_sided", m.doubleSided);
  m.unlit = reader.boolean("unlit", m.unlit);
  readTransmission(reader, texture, m);
  readLayers(reader, texture, m);
  readAnisotropy(reader, texture, m);
  readIridescence(reader, texture, m);
  reader.rejectUnknownKeys();
  if (!context.materials.emplace(name, static_cast<int>(context.scene.materials.size())).second)
    context.fail(nameValue, fmt::format("second material '{}'", name));
  context.scene.materials.push_back(std::move(m));
}

}  // namespace

void readMaterials(SceneTomlContext& context, TomlReader& root) {
  TextureReader texture(context);
  for (const TomlValue& table : root.tables("material")) readMaterial(context, texture, table);
}

}  // namespace quintet::scene
