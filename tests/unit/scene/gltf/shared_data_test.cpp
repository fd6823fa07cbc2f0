// SPDX-License-Identifier: Apache-2.0
// Sample models of Khronos and invalid files of the glTF validator, in the folder $QUINTET_SHARED/data. tests/reference/run sets
// the variable; without it, the tests are skipped, and valid_files_test.cpp tests with files of our own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "scene/geometry/tangents.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"
#include "scene/model/validate.h"

namespace quintet::test {
namespace {

namespace fs = std::filesystem;

// The folder of the data; empty without it.
fs::path dataFolder() {
  const char* shared = std::getenv("QUINTET_SHARED");
  return shared ? fs::path(shared) / "data" : fs::path();
}

struct Expected {
  const char* file;
  std::size_t meshes, instances, materials, images, cameras;
  std::uint64_t stored, instanced;
  vec3 low, high;
};

// Counts are from an independent reading of the JSON. Bounds are from min and max of the accessors, transformed by hand
// through the nodes, if the file has no skin.
const Expected kExpected[] = {
    {"AlphaBlendModeTest.glb", 9, 9, 6, 4, 0, 61, 61, {-4.3f, -0.1f, -0.75f}, {4.3f, 2.29953f, 0.55f}},
    {"BoxTextured.glb", 1, 1, 1, 1, 0, 12, 12, vec3(-0.5f), vec3(0.5f)},
    {"CesiumMan.glb", 1, 1, 1, 1, 0, 4672, 4672, {-0.56914f, 0, -0.131f}, {0.56914f, 1.50655f, 0.18095f}},
    {"DamagedHelmet.glb", 1, 1, 1, 5, 0, 15452, 15452, {-0.94746f, -0.90097f, -1.18716f}, {0.94249f, 0.901f, 0.81284f}},
    {"Duck.glb", 1, 1, 1, 1, 1, 4212, 4212, {-0.69299f, 0.09929f, -0.61328f}, {0.9618f, 1.6397f, 0.53925f}},
    {"Duck-Draco/Duck.gltf", 1, 1, 1, 1, 1, 4212, 4212, {-0.69299f, 0.09929f, -0.61328f}, {0.9618f, 1.6397f, 0.53925f}},
    {"Duck-Quantized/Duck.gltf",
     1,
     1,
     1,
     1,
     1,
     4212,
     4212,
     {-0.69299f, 0.09929f, -0.61328f},
     {0.9618f, 1.6397f, 0.53925f}},
    {"Fox.glb", 1, 1, 1, 1, 0, 576, 576, {-12.593f, -0.1217f, -88.095f}, {12.593f, 78.907f, 66.625f}},
    {"MeshPrimitiveModes/MeshPrimitiveModes.gltf", 3, 3, 0, 0, 0, 16, 16, {-2.866f, -4, 0}, {2.866f, -2, 0}},
    {"MetalRoughSpheresNoTextures.glb",
     102,
     102,
     98,
     0,
     0,
     1040409,
     1040409,
     {-9.2432e-4f, -1.0105e-3f, -3.34996e-3f},
     {6.47656e-3f, 6.49414e-3f, 3.49959e-4f}},
    {"NegativeScaleTest.glb", 8, 11, 6, 2, 0, 3884, 7724, {-5.16167f, -4.45354f, -0.5f}, {5.16167f, 4.45354f, 0.5f}},
    {"SimpleInstancing.glb", 1, 125, 0, 0, 0, 12, 1500, vec3(-1.66667f), vec3(12.7317f)},
    {"SimpleSparseAccessor/SimpleSparseAccessor.gltf", 1, 1, 0, 0, 0, 12, 12, {0, 0, 0}, {6, 4, 0}},
};

TEST(SharedData, LoadsModelsWithTheExpectedContents) {
  if (dataFolder().empty()) GTEST_SKIP() << "QUINTET_SHARED is not set";
  for (const Expected& e : kExpected) {
    SCOPED_TRACE(e.file);
    ASSERT_TRUE(fs::exists(dataFolder() / "models" / e.file));
    const scene::Scene s = scene::loadGltf(dataFolder() / "models" / e.file);
    EXPECT_NO_THROW(scene::validate(s));
    EXPECT_EQ(s.meshes.size(), e.meshes);
    EXPECT_EQ(s.instances.size(), e.instances);
    EXPECT_EQ(s.materials.size(), e.materials);
    EXPECT_EQ(s.images.size(), e.images);
    EXPECT_EQ(s.cameras.size(), e.cameras);
    EXPECT_EQ(scene::countTriangles(s).stored, e.stored);
    EXPECT_EQ(scene::countTriangles(s).instanced, e.instanced);
    const Bounds3 bounds = scene::worldBounds(s);
    EXPECT_LT(glm::distance(bounds.min, e.low), 1e-3f * glm::length(e.high - e.low));
    EXPECT_LT(glm::distance(bounds.max, e.high), 1e-3f * glm::length(e.high - e.low));
  }
}

TEST(SharedData, LoadsEveryModel) {
  if (dataFolder().empty()) GTEST_SKIP() << "QUINTET_SHARED is not set";
  for (const auto& entry : fs::recursive_directory_iterator(dataFolder() / "models")) {
    if (entry.path().extension() != ".glb" && entry.path().extension() != ".gltf") continue;
    SCOPED_TRACE(entry.path().string());
    EXPECT_NO_THROW({
      const scene::Scene s = scene::loadGltf(entry.path());
      scene::validate(s);
      EXPECT_FALSE(s.instances.empty());
      for (const scene::Mesh& mesh : s.meshes)
        for (const scene::Geometry& g : mesh.geometries)
          for (const vec3& n : g.normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-4f);
    });
  }
}

// Files with tangents that Blender has computed with MikkTSpace, for the texture coordinates that were active there.
// Triangles almost without area in the texture are left out: whether they have one depends on the rounding, and on two of
// them, of a swatch with one color, w in VertexColorTest contradicts the texture coordinates.
TEST(SharedData, GeneratedTangentsAgreeWithThoseOfFiles) {
  if (dataFolder().empty()) GTEST_SKIP() << "QUINTET_SHARED is not set";
  for (const auto& [file, uvSet] :
       {std::pair("AlphaBlendModeTest.glb", 0), std::pair("MultiUVTest.glb", 1), std::pair("VertexColorTest.glb", 0)}) {
    const scene::Scene s = scene::loadGltf(dataFolder() / "models" / file);
    std::size_t corners = 0, different = 0;
    for (const scene::Mesh& mesh : s.meshes) {
      for (const scene::Geometry& g : mesh.geometries) {
        if (g.tangents.empty()) continue;
        scene::Geometry generated = g;
        generated.tangents.clear();
        scene::generateTangents(generated, scene::TextureUse{.uvSet = uvSet});
        for (std::size_t t = 0; t < g.triangles.size(); ++t) {
          const std::vector<vec2>& uvs = g.uvs[static_cast<std::size_t>(uvSet)];
          const uvec3& v = g.triangles[t];
          const vec2 d1 = uvs[v.y] - uvs[v.x], d2 = uvs[v.z] - uvs[v.x];
          if (std::abs(d1.x * d2.y - d1.y * d2.x) < 1e-3f) continue;
          for (std::size_t c = 0; c < 3; ++c) {
            const vec4 &a = g.tangents[g.triangles[t][c]], &b = generated.tangents[generated.triangles[t][c]];
            ++corners;
            if (a.w != b.w || glm::dot(vec3(a), vec3(b)) < std::cos(glm::radians(2.0f))) ++different;
          }
        }
      }
    }
    EXPECT_GT(corners, 0u) << file;
    EXPECT_EQ(different, 0u) << file << ", of " << corners;
  }
}

// Errors of the validator that leave the data unambiguous. Files with these errors load.
const std::set<std::string> kTolerated = {"ACCESSOR_INVALID_FLOAT",
                                          "ACCESSOR_MATRIX_ALIGNMENT",
                                          "ACCESSOR_NORMALIZED_INVALID",
                                          "ACCESSOR_OFFSET_ALIGNMENT",
                                          "ACCESSOR_TOTAL_OFFSET_ALIGNMENT",
                                          "BUFFER_VIEW_INVALID_BYTE_STRIDE",
                                          "BUFFER_VIEW_TARGET_OVERRIDE",
                                          "EMPTY_ENTITY",
                                          "GLB_CHUNK_LENGTH_UNALIGNED",
                                          "GLB_UNEXPECTED_BIN_CHUNK",
                                          "MESH_PRIMITIVE_ACCESSOR_UNALIGNED",
                                          "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE",
                                          "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT",
                                          "MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY",
                                          "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE",
                                          "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
                                          "MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH",
                                          "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR",
                                          "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
                                          "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS",
                                          "NODE_MATRIX_TRS",
                                          "NODE_SKIN_WITH_NON_SKINNED_MESH",
                                          "ROTATION_NON_UNIT",
                                          "UNSATISFIED_DEPENDENCY"};

// Whether a file that the validator accepts has values that it does not need: those of a buffer without bytes, or a name
// that glTF does not define, which is a warning.
bool lacksContent(const fs::path& file, const Json& report) {
  for (const Json& message : report["issues"]["messages"])
    if (message["code"] == "VALUE_NOT_IN_LIST") return true;
  if (file.extension() != ".gltf") return false;
  const Json document = Json::parse(readTextFile(file));
  return std::ranges::any_of(document.value("buffers", Json::array()),
                             [](const Json& buffer) { return !buffer.contains("uri"); });
}

TEST(SharedData, ReportsMalformedFilesOnOneLine) {
  if (dataFolder().empty()) GTEST_SKIP() << "QUINTET_SHARED is not set";
  for (const auto& entry : fs::recursive_directory_iterator(dataFolder() / "malformed")) {
    const fs::path& file = entry.path();
    if (file.extension() != ".glb" && file.extension() != ".gltf") continue;
    SCOPED_TRACE(file.string());
    const Json report = Json::parse(readTextFile(file.string() + ".report.json"));
    std::string fatal;
    if (file.filename() == "bom.glb") continue;  // a byte order mark is accepted
    for (const Json& message : report["issues"]["messages"])
      if (message["severity"] == 0 && !kTolerated.contains(message["code"].get<std::string>()))
        fatal += message["code"].get<std::string>() + " ";
    try {
      scene::validate(scene::loadGltf(file));
      EXPECT_EQ(fatal, "") << "loaded";
    } catch (const FileError& error) {
      EXPECT_TRUE(fatal != "" || lacksContent(file, report)) << "a valid file is rejected: " << error.what();
      EXPECT_EQ(error.file(), file);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace quintet::test
