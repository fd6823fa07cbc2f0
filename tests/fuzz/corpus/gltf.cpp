// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/gltf_animation.h"
#include "scene/gltf_samples.h"
#include "seeds.h"

namespace quintet::fuzz {
namespace {

using test::GltfBuilder;
using test::Json;

std::vector<std::byte> bytesOf(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

// A textured triangle whose material has the extension.
GltfBuilder withMaterialExtension(const std::string& name, const Json& extension) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  builder.primitive()["material"] = 0;
  builder.add("images", {{"bufferView", builder.addView(test::tinyPng())}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials", {{"extensions", {{name, extension}}}});
  builder.root["extensionsUsed"] = {name};
  return builder;
}

std::vector<std::pair<std::string, Json>> materialExtensions() {
  const Json texture = {{"index", 0}};
  return {
      {"KHR_materials_unlit", Json::object()},
      {"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}},
      {"KHR_materials_ior", {{"ior", 1.4}}},
      {"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", texture}}},
      {"KHR_materials_volume",
       {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {1, 0.5, 0.25}}}},
      {"KHR_materials_specular",
       {{"specularFactor", 0.5},
        {"specularTexture", texture},
        {"specularColorFactor", {1, 1, 2}},
        {"specularColorTexture", texture}}},
      {"KHR_materials_clearcoat",
       {{"clearcoatFactor", 1}, {"clearcoatRoughnessTexture", texture}, {"clearcoatNormalTexture", texture}}},
      {"KHR_materials_sheen", {{"sheenColorFactor", {1, 0, 0}}, {"sheenRoughnessTexture", texture}}},
      {"KHR_materials_diffuse_transmission",
       {{"diffuseTransmissionFactor", 0.5}, {"diffuseTransmissionColorTexture", texture}}},
      {"KHR_materials_anisotropy",
       {{"anisotropyStrength", 0.5}, {"anisotropyRotation", 1}, {"anisotropyTexture", texture}}},
      {"KHR_materials_iridescence", {{"iridescenceFactor", 1}, {"iridescenceThicknessTexture", texture}}},
      {"KHR_materials_dispersion", {{"dispersion", 0.1}}},
      {"KHR_materials_pbrSpecularGlossiness",
       {{"diffuseTexture", texture}, {"specularGlossinessTexture", texture}, {"glossinessFactor", 0.5}}},
  };
}

// Nodes that are not visible, variants, metadata, orthographic camera, point light, triangle fan.
GltfBuilder withOtherExtensions() {
  GltfBuilder builder;
  builder.addTriangle();
  builder.primitive()["mode"] = 6;
  builder.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}}};
  builder.root["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "Red"}}};
  builder.add("materials", {{"alphaMode", "MASK"}, {"alphaCutoff", 0.4}});
  builder.add("materials", {{"alphaMode", "BLEND"}, {"doubleSided", true}});
  builder.add("cameras",
              {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}});
  builder.add("nodes", {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 2, 1, 1}},
                        {"camera", 0},
                        {"extensions",
                         {{"KHR_node_visibility", {{"visible", false}}}, {"KHR_lights_punctual", {{"light", 0}}}}}});
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "point"}, {"range", 4}, {"intensity", 9}}});
  builder.root["extensions"]["KHR_xmp_json_ld"]["packets"] =
      Json::array({{{"@context", {{"dc", "http://purl.org/dc/elements/1.1/"}}}, {"dc:title", {{"@set", {"A"}}}}}});
  builder.root["asset"]["extensions"]["KHR_xmp_json_ld"]["packet"] = 0;
  builder.root["scenes"] = Json::array({{{"nodes", {0}}, {"name", "First"}}, {{"nodes", {0, 1}}}});
  builder.root["scene"] = 1;
  return builder;
}

GltfBuilder animated(const std::string& interpolation) {
  test::AnimationBuilder builder = test::bendingStrip();
  const bool cubic = interpolation == "CUBICSPLINE";
  const std::vector<float> keys{0, 0, 0, 1, 2, 3};
  std::vector<float> values;
  for (std::size_t key = 0; key < 2; ++key)
    for (std::size_t part = 0; part < (cubic ? 3u : 1u); ++part)
      values.insert(values.end(), keys.begin() + static_cast<std::ptrdiff_t>(3 * key),
                    keys.begin() + static_cast<std::ptrdiff_t>(3 * key) + 3);
  builder.addChannel(1, "translation", {0, 2}, values, interpolation);
  return builder;
}

// Buffer and image are in files beside the scene (scene_target.h).
std::string withNeighbors() {
  return R"({"asset":{"version":"2.0"},"buffers":[{"uri":"data.bin","byteLength":256}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":64,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],
"images":[{"uri":"image.png"}],"textures":[{"source":0}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],"nodes":[{"mesh":0}]})";
}

}  // namespace

void addGltfSeeds(Corpora& corpora) {
  const auto add = [&](const std::string& name, const GltfBuilder& builder) {
    corpora["gltf"].push_back({name + ".gltf", bytesOf(builder.gltf())});
    corpora["glb"].push_back({name + ".glb", builder.glb()});
  };
  add("everything", test::sceneWithEverything());
  add("draco", test::DracoBuilder());
  add("meshopt", test::MeshoptBuilder());
  add("meshopt_version_1", test::stripInVersion1());
  add("other_extensions", withOtherExtensions());
  add("morphed", test::morphingTriangle());
  for (const char* interpolation : {"LINEAR", "STEP", "CUBICSPLINE"})
    add(std::string("animated_") + interpolation, animated(interpolation));
  for (const auto& [name, extension] : materialExtensions()) add(name, withMaterialExtension(name, extension));
  corpora["gltf"].push_back({"neighbors.gltf", bytesOf(withNeighbors())});
}

}  // namespace quintet::fuzz
