// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_samples.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cstring>
#include <memory>
#include <random>
#include <span>
#include <utility>

#include "scene/meshopt_writer.h"

namespace quintet::test {
namespace {

// A fan of triangles around the origin, with texture coordinates.
std::vector<std::byte> dracoStream(int triangles, int* positionId, int* uvId) {
  draco::TriangleSoupMeshBuilder soup;
  soup.Start(triangles);
  const int positions = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uvs = soup.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (int i = 0; i < triangles; ++i) {
    const float a[3] = {0, 0, 0}, b[3] = {1, static_cast<float>(i), 0}, c[3] = {1, static_cast<float>(i + 1), 0};
    const float u[2] = {0, 0}, v[2] = {1, 0.25f}, w[2] = {1, 0.5f};
    soup.SetAttributeValuesForFace(positions, draco::FaceIndex(static_cast<std::uint32_t>(i)), a, b, c);
    soup.SetAttributeValuesForFace(uvs, draco::FaceIndex(static_cast<std::uint32_t>(i)), u, v, w);
  }
  const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
  *positionId = static_cast<int>(mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION)->unique_id());
  *uvId = static_cast<int>(mesh->GetNamedAttribute(draco::GeometryAttribute::TEX_COORD)->unique_id());
  draco::Encoder encoder;  // without quantization, so that floats are exact
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

GltfBuilder sceneWithEverything() {
  GltfBuilder b;
  const int positions = b.addAccessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
  const int normals = b.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int uvs = b.addAccessor<std::uint16_t>({0, 0, 65535, 0, 0, 65535, 65535, 65535}, "VEC2", true);
  const int colors =
      b.addAccessor<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 9, 9, 9}, "VEC4", true);
  const int joints = b.addAccessor<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4");
  const int weights = b.addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, .5f, .5f, 0, 0, 1, 0, 0, 0}, "VEC4");
  const int indices = b.addAccessor<std::uint16_t>({0, 1, 2, 2, 1, 3}, "SCALAR");
  const int target = b.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int sparseIndices = b.addView<std::uint8_t>({1, 3}), sparseValues = b.addView<float>({1, 0, 0, 1, 1, 1});
  b.root["accessors"][static_cast<std::size_t>(target)]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", sparseIndices}, {"componentType", kUnsignedByte}}},
      {"values", {{"bufferView", sparseValues}}}};
  const int bind = b.addAccessor<float>(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4");
  const int translations = b.addAccessor<float>({0, 0, 0, 5, 0, 0}, "VEC3");
  const Json base = {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}, {"COLOR_0", colors}};
  Json skinned = base;
  skinned["JOINTS_0"] = joints, skinned["WEIGHTS_0"] = weights;
  b.add("meshes", {{"primitives", Json::array({{{"attributes", skinned}, {"indices", indices}, {"material", 0}}})}});
  b.add("meshes", {{"primitives", Json::array({{{"attributes", base},
                                                {"mode", 5},
                                                {"material", 0},
                                                {"targets", Json::array({{{"POSITION", target}}})}}})},
                   {"weights", {0.5}}});
  b.add("images", {{"bufferView", b.addView(tinyPng())}, {"mimeType", "image/png"}});
  b.add("samplers", {{"wrapS", 33071}});
  b.add("textures", {{"source", 0}, {"sampler", 0}});
  b.add("materials",
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}}}},
         {"normalTexture", {{"index", 0}}},
         {"extensions",
          {{"KHR_materials_ior", {{"ior", 1.4}}}, {"KHR_materials_volume", {{"attenuationDistance", 2}}}}}});
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
  b.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", bind}});
  b.root["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "spot"}, {"spot", {{"outerConeAngle", 0.4}}}}});
  b.add("nodes", {{"mesh", 0}, {"skin", 0}});
  b.add("nodes", {{"children", {2}}, {"scale", {1, 2, 1}}});
  b.add("nodes", {{"translation", {0, 1, 0}}, {"camera", 0}});
  b.add("nodes", {{"mesh", 1},
                  {"extensions",
                   {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translations}}}}},
                    {"KHR_lights_punctual", {{"light", 0}}}}}});
  b.root["scenes"] = Json::array({{{"nodes", {0, 1, 3}}}});
  b.root["scene"] = 0;
  b.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_texture_transform", "EXT_mesh_gpu_instancing"};
  return b;
}

DracoBuilder::DracoBuilder() {
  int positionId = 0, uvId = 0;
  const int view = addView(dracoStream(2, &positionId, &uvId));
  root["extensionsUsed"] = root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const Json floats = {{"componentType", kFloat}, {"count", 4}};
  Json position = floats, uv = floats;
  position["type"] = "VEC3", uv["type"] = "VEC2";
  const int positions = add("accessors", position), uvs = add("accessors", uv);
  const int indices = add("accessors", {{"componentType", kUnsignedShort}, {"count", 6}, {"type", "SCALAR"}});
  addMesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
           {"indices", indices},
           {"extensions",
            {{"KHR_draco_mesh_compression",
              {{"bufferView", view}, {"attributes", {{"POSITION", positionId}, {"TEXCOORD_0", uvId}}}}}}}});
}

MeshoptBuilder::MeshoptBuilder(std::string name) : extension(std::move(name)) {
  std::vector<vec3> positions;
  for (int i = 0; i < 20; ++i) positions.emplace_back(i / 2, i % 2, 0);
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i + 2 < 20; ++i) indices.insert(indices.end(), {i, i + 1 + i % 2, i + 2 - i % 2});

  std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(20, 12));
  encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), positions.data(), 20, 12));
  addCompressed(encoded, 20, 12, "ATTRIBUTES");
  root["bufferViews"][0]["byteStride"] = 12;
  std::vector<unsigned char> encodedIndices(meshopt_encodeIndexBufferBound(indices.size(), 20));
  encodedIndices.resize(
      meshopt_encodeIndexBuffer(encodedIndices.data(), encodedIndices.size(), indices.data(), indices.size()));
  addCompressed(encodedIndices, indices.size(), 2, "TRIANGLES");

  const int p = add("accessors", {{"bufferView", 0}, {"componentType", kFloat}, {"count", 20}, {"type", "VEC3"}});
  const int i =
      add("accessors",
          {{"bufferView", 1}, {"componentType", kUnsignedShort}, {"count", indices.size()}, {"type", "SCALAR"}});
  addMesh({{"attributes", {{"POSITION", p}}}, {"indices", i}});
  root["extensionsUsed"] = root["extensionsRequired"] = {extension};
  // Buffer 1 is the fallback buffer, without data.
  root["buffers"] = {{{"byteLength", binary.size()}},
                     {{"byteLength", 1000}, {"extensions", {{extension, {{"fallback", true}}}}}}};
}

void MeshoptBuilder::addCompressed(const std::vector<unsigned char>& data, std::size_t count, std::size_t stride,
                                   const char* mode) {
  const int view = addView(data);
  const Json inside = root["bufferViews"][static_cast<std::size_t>(view)];
  root["bufferViews"][static_cast<std::size_t>(view)] = {{"buffer", 1},
                                                         {"byteLength", count * stride},
                                                         {"extensions",
                                                          {{extension,
                                                            {{"buffer", 0},
                                                             {"byteOffset", inside["byteOffset"]},
                                                             {"byteLength", inside["byteLength"]},
                                                             {"byteStride", stride},
                                                             {"count", count},
                                                             {"mode", mode}}}}}};
}

MeshoptBuilder stripInVersion1() {
  MeshoptBuilder builder("KHR_meshopt_compression");
  std::mt19937 random(3);
  std::vector<unsigned char> elements(20 * sizeof(vec3)), colors;
  for (std::size_t i = 0; i < 20; ++i) {
    const vec3 position(i / 2, i % 2, 0);
    std::memcpy(elements.data() + i * sizeof position, &position, sizeof position);
    for (const int value : {100, 20, 226, 0x80 | 0x7F}) colors.push_back(static_cast<unsigned char>(value));
  }
  builder.addCompressed(writeMeshoptVersion1(elements, 12, {0x82, 1, 0}, random), 20, 12, "ATTRIBUTES");
  builder.addCompressed(writeMeshoptVersion1(colors, 4, {0}, random), 20, 4, "ATTRIBUTES");
  builder.meshopt(3)["filter"] = "COLOR";
  builder.root["buffers"][0]["byteLength"] = builder.binary.size();
  builder.root["accessors"][0]["bufferView"] = 2;
  const int view = builder.add(
      "accessors", {{"bufferView", 3}, {"componentType", 5121}, {"normalized", true}, {"count", 20}, {"type", "VEC4"}});
  builder.primitive()["attributes"]["COLOR_0"] = view;
  return builder;
}

}  // namespace quintet::test
