// SPDX-License-Identifier: Apache-2.0
// Skinned meshes whose joints mirror: the outside stays outside, at rest and in animations. References: closed forms, and the same
// mesh without a skin below the same node.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "harness.h"
#include "rendered_image.h"
#include "scene/gltf_animation.h"

namespace quintet::test {
namespace {

// Nodes of the files below.
constexpr int kMeshNode = 0, kJoint = 1, kOtherJoint = 2, kArmature = 3;

Json attributesOf(GltfBuilder& builder, const scene::Geometry& geometry) {
  const auto floats = [](const auto& values) {
    std::vector<float> result;
    for (const auto& v : values)
      for (glm::length_t c = 0; c < v.length(); ++c) result.push_back(v[c]);
    return result;
  };
  Json attributes = {{"POSITION", builder.addAccessor(floats(geometry.positions), "VEC3")}};
  if (!geometry.normals.empty()) attributes["NORMAL"] = builder.addAccessor(floats(geometry.normals), "VEC3");
  if (!geometry.tangents.empty()) attributes["TANGENT"] = builder.addAccessor(floats(geometry.tangents), "VEC4");
  if (!geometry.uvs[0].empty()) attributes["TEXCOORD_0"] = builder.addAccessor(floats(geometry.uvs[0]), "VEC2");
  return attributes;
}

// A primitive whose vertices follow one joint each; without joints, none.
Json primitiveOf(GltfBuilder& builder, const scene::Geometry& geometry, const std::vector<std::uint8_t>& joints) {
  Json attributes = attributesOf(builder, geometry);
  if (!joints.empty()) {
    std::vector<std::uint8_t> indices;
    std::vector<float> weights;
    for (const std::uint8_t joint : joints) {
      indices.insert(indices.end(), {joint, 0, 0, 0});
      weights.insert(weights.end(), {1, 0, 0, 0});
    }
    attributes["JOINTS_0"] = builder.addAccessor(indices, "VEC4");
    attributes["WEIGHTS_0"] = builder.addAccessor(weights, "VEC4");
  }
  std::vector<std::uint32_t> indices;
  for (const uvec3& t : geometry.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
  return {{"attributes", attributes}, {"indices", builder.addAccessor(indices, "SCALAR")}, {"material", 0}};
}

// The mesh and two joints below an armature, which does not mirror yet.
void addArmature(GltfBuilder& builder, const Json& primitives) {
  builder.add("meshes", {{"primitives", primitives}});
  builder.add("nodes", {{"mesh", 0}, {"skin", 0}});
  builder.add("nodes", {{"name", "joint"}});
  builder.add("nodes", {{"name", "other joint"}});
  builder.add("nodes", {{"name", "armature"}, {"children", {kMeshNode, kJoint, kOtherJoint}}});
  builder.add("skins", {{"joints", {kJoint, kOtherJoint}}});
}

scene::Geometry joinedGeometry(scene::Geometry a, const scene::Geometry& b) {
  const auto count = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  for (const uvec3& t : b.triangles) a.triangles.push_back(t + count);
  return a;
}

// Three boxes of 2 m in a row. The first two are one primitive and follow a joint each; the third has no joints.
AnimationBuilder threeBoxes() {
  AnimationBuilder builder;
  builder.add("materials",
              {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
               {"extensions",
                {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                 {"KHR_materials_ior", {{"ior", 1}}},
                 {"KHR_materials_volume",
                  {{"thicknessFactor", 1}, {"attenuationColor", {0.5, 0.25, 1}}, {"attenuationDistance", 2}}}}}});
  const scene::Geometry left = box({-5, -1, -1}, {-3, 1, 1});
  std::vector<std::uint8_t> joints(left.positions.size(), 0);
  joints.resize(2 * joints.size(), 1);
  const Json first = primitiveOf(builder, joinedGeometry(left, box({-1, -1, -1}, {1, 1, 1})), joints);
  const Json second = primitiveOf(builder, box({3, -1, -1}, {5, 1, 1}), {});
  addArmature(builder, Json::array({first, second}));
  return builder;
}

// Expects that light passes 2 m of each box, from both sides.
void expectFilled(const scene::Scene& scene, const std::vector<double>& frames, const std::string& what) {
  constexpr std::array kExpected{0.5f, 0.25f, 1.0f};
  SceneBuilder source;
  source.sky(vec3(1.0f));
  render::DeviceScene device(testContext(), scene::Scene(scene), source.environment, {.compiler = &testCompiler()});
  ImageOptions options;
  options.width = options.height = 2;
  for (const double frame : frames) {
    device.setFrame(frame);
    for (const float x : {-4.0f, 0.0f, 4.0f})
      for (const float z : {5.0f, -5.0f}) {
        const scene::Camera camera = orthographic({x, 0, z}, {x, 0, 0}, 0.5f);
        render::Renderer renderer = makeRenderer(device, options.program, settingsFor(camera, options));
        renderer.renderBatch();
        const io::Image image = renderer.image();
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(image.pixel<float>(0, 0)[c], kExpected[c], 2e-4f)
              << what << ", frame " << frame << ", box at " << x << " from " << z << ", channel " << c;
      }
  }
}

using Scales = std::vector<std::pair<int, std::vector<float>>>;  // of nodes

struct Mirrored {
  std::string what;
  Scales scales;
};

std::vector<Mirrored> mirroredRigs() {
  const std::vector<float> z{1, 1, -1};
  return {{"nothing", {}},
          {"the armature", {{kArmature, z}}},
          {"the mesh's node", {{kMeshNode, z}}},
          {"a joint", {{kJoint, z}}},
          {"the other joint and the node", {{kOtherJoint, z}, {kMeshNode, z}}},
          {"both joints", {{kJoint, z}, {kOtherJoint, {1, -1, 1}}}},
          {"all twice", {{kArmature, z}, {kJoint, {1, -1, 1}}, {kOtherJoint, z}, {kMeshNode, z}}}};
}

TEST(MirroredSkin, AtRestStaysFilled) {
  for (const Mirrored& rig : mirroredRigs()) {
    AnimationBuilder builder = threeBoxes();
    for (const auto& [node, scale] : rig.scales) builder.root["nodes"][static_cast<std::size_t>(node)]["scale"] = scale;
    expectFilled(builder.load(), {0}, rig.what);
  }
}

// The inverse bind matrix of a rig that was bound while it was mirrored: the vertices are not mirrored.
TEST(MirroredSkin, DependsOnTheInverseBindMatrices) {
  AnimationBuilder builder = threeBoxes();
  builder.root["nodes"][kArmature]["scale"] = {1, 1, -1};
  std::vector<float> bind;
  for (int joint = 0; joint < 2; ++joint) bind.insert(bind.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1});
  builder.root["skins"][0]["inverseBindMatrices"] = builder.addAccessor(bind, "MAT4");
  expectFilled(builder.load(), {0}, "bound mirrored");
}

// From the first frame on, and from 0.5 s on.
TEST(MirroredSkin, InAnAnimationStaysFilled) {
  for (const Mirrored& rig : mirroredRigs()) {
    AnimationBuilder builder = threeBoxes();
    builder.addChannel(kJoint, "translation", {0, 1}, {0, 0, 0, 0, 0, 0});
    AnimationBuilder later = builder;
    for (const auto& [node, scale] : rig.scales) {
      builder.root["nodes"][static_cast<std::size_t>(node)]["scale"] = scale;
      std::vector<float> scales{1, 1, 1};
      scales.insert(scales.end(), scale.begin(), scale.end());
      later.addChannel(node, "scale", {0, 0.5f}, scales, "STEP");
    }
    expectFilled(builder.loadAnimated(), {0, 12}, rig.what);
    expectFilled(later.loadAnimated(), {24, 6, 13}, rig.what + ", later");
  }
}

// Two nodes share the mesh; one of their skins mirrors.
TEST(MirroredSkin, SharesMeshes) {
  for (const bool animated : {false, true}) {
    AnimationBuilder builder = threeBoxes();
    const int joint = builder.add("nodes", {{"scale", {1, 1, -1}}});
    const int skin = builder.add("skins", {{"joints", {joint, joint}}});
    builder.add("nodes", {{"mesh", 0}, {"skin", skin}, {"scale", {1, 1, -1}}, {"translation", {0, 0, 20}}});
    builder.root["nodes"][static_cast<std::size_t>(joint)]["translation"] = {0, 0, 20};
    if (animated) builder.addChannel(kJoint, "translation", {0, 1}, {0, 0, 0, 0, 0, 0});
    if (animated) builder.addChannel(joint, "translation", {0, 1}, {0, 0, 20, 0, 0, 20});
    const scene::Scene scene = animated ? builder.loadAnimated() : builder.load();
    SceneBuilder source;
    source.sky(vec3(1.0f));
    render::DeviceScene device(testContext(), scene::Scene(scene), source.environment, {.compiler = &testCompiler()});
    ImageOptions options;
    options.width = options.height = 2;
    options.set = {"roulette_start=1000"};  // a path passes four surfaces
    for (const float x : {-4.0f, 0.0f, 4.0f}) {
      const scene::Camera camera = orthographic({x, 0, 40}, {x, 0, 0}, 0.5f);
      render::Renderer renderer = makeRenderer(device, options.program, settingsFor(camera, options));
      renderer.renderBatch();
      EXPECT_NEAR(renderer.image().pixel<float>(1, 1)[1], 0.0625f, 1e-4f) << animated << " " << x;
    }
  }
}

// A bumpy, anisotropic, coated square that follows a joint. `tangents`: of the file, else generated.
AnimationBuilder bumpySquare(bool tangents) {
  AnimationBuilder builder;
  scene::Geometry geometry = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  geometry.normals.assign(4, vec3(0, 0, 1));
  geometry.uvs[0] = {{0, 0}, {0.8f, 0.2f}, {0.8f, 1}, {0, 0.9f}};
  if (tangents) geometry.tangents.assign(4, vec4(0.8f, 0.6f, 0, -1));
  const int view = builder.addView(std::vector<std::byte>(tinyPng()));
  builder.add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add(
      "materials",
      {{"pbrMetallicRoughness", {{"metallicFactor", 0.5}, {"roughnessFactor", 0.5}}},
       {"normalTexture", {{"index", 0}}},
       {"extensions",
        {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.8}, {"anisotropyRotation", 0.6}}},
         {"KHR_materials_clearcoat",
          {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", 0.3}, {"clearcoatNormalTexture", {{"index", 0}}}}}}}});
  addArmature(builder, Json::array({primitiveOf(builder, geometry, {0, 0, 0, 0})}));
  return builder;
}

std::vector<vec4> renderBumps(const scene::Scene& scene, double frame) {
  SceneBuilder source;
  scene::Light lamp;
  lamp.type = scene::LightType::directional;
  lamp.direction = glm::normalize(vec3(-0.8f, -0.5f, -1.0f));
  lamp.intensity = vec3(3.0f);
  source.scene = scene;
  io::Image& map = source.scene.images.at(0).image;
  map = io::makeImage(2, 2, 3, io::PixelType::u8, io::ColorEncoding::linear);
  const std::array<std::uint8_t, 12> normals{190, 150, 220, 90, 170, 230, 160, 70, 225, 100, 110, 240};
  std::ranges::copy(normals, map.samples<std::uint8_t>().begin());
  source.light(lamp);
  render::DeviceScene device(testContext(), std::move(source.scene), scene::Environment{},
                             {.compiler = &testCompiler()});
  device.setFrame(frame);
  ImageOptions options;
  options.set = {"bounces=1"};
  const scene::Camera camera = orthographic({1, 0.5f, 3}, {0, 0, 0}, 0.8f);
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(camera, options));
  renderer.renderBatch();
  return renderer.film().downloadBatch(0);
}

double largestColorDifference(const std::vector<vec4>& a, const std::vector<vec4>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (glm::length_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(double{a[i][c]} - double{b[i][c]}));
  return largest;
}

TEST(MirroredSkin, HasTheTangentFramesOfAMirroredObject) {
  for (const bool tangents : {false, true}) {
    AnimationBuilder skinned = bumpySquare(tangents);
    skinned.root["nodes"][kArmature]["scale"] = {-1, 1, 1};
    AnimationBuilder rigid = skinned, plain = bumpySquare(tangents), animated = skinned;
    rigid.root["nodes"][kMeshNode].erase("skin");
    const std::vector<vec4> expected = renderBumps(rigid.load(), 0);
    EXPECT_GT(largestColorDifference(renderBumps(plain.load(), 0), expected), 0.1) << "symmetric";
    EXPECT_LT(largestColorDifference(renderBumps(skinned.load(), 0), expected), 1e-3) << tangents;
    animated.addChannel(kJoint, "translation", {0, 1}, {0, 0, 0, 0, 0, 0});
    EXPECT_LT(largestColorDifference(renderBumps(animated.loadAnimated(), 12), expected), 1e-3) << tangents;
    AnimationBuilder later = bumpySquare(tangents);
    later.addChannel(kArmature, "scale", {0, 0.5f}, {1, 1, 1, -1, 1, 1}, "STEP");
    EXPECT_LT(largestColorDifference(renderBumps(later.loadAnimated(), 13), expected), 1e-3) << tangents;
  }
}

}  // namespace
}  // namespace quintet::test
