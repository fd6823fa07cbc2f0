// SPDX-License-Identifier: Apache-2.0
// The compute passes that deform vertices and measure trees, against the functions of the host.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "deformed_scene.h"
#include "harness.h"
#include "render/compute_pass.h"
#include "render/scene/device_scene.h"
#include "rendered_image.h"
#include "scene/animation/pose.h"

namespace quintet::test {
namespace {

struct DeviceVertex {
  vec3 position, normal;
  vec4 tangent;
};

// The vertices of all geometries on the device, in the order of the scene. Absent attributes are 0.
std::vector<DeviceVertex> readVertices(const render::DeviceScene& device, const scene::Scene& scene) {
  std::vector<uvec2> inputs;  // geometry and vertex
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    for (std::uint32_t i = 0; i < scene.meshes[m].geometries[0].positions.size(); ++i) inputs.push_back({m, i});
  ComputeOptions options;
  options.addresses[0] = device.frameTemplate().geometries;
  return runCompute<DeviceVertex>(R"(
    #include <quintet/shared/frame.h>
    layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Geometries { GeometryData at[]; };
    layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vec3s { vec3 at[]; };
    layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vec4s { vec4 at[]; };
    #define In uvec2
    struct Out { vec3 position; vec3 normal; vec4 tangent; };
    Out run(uint index, In value) {
      const GeometryData g = Geometries(testAddress(0)).at[value.x];
      Out result = Out(Vec3s(g.positions).at[value.y], vec3(0.0), vec4(0.0));
      if (g.normals != 0ul) result.normal = Vec3s(g.normals).at[value.y];
      if (g.tangents != 0ul) result.tangent = Vec4s(g.tangents).at[value.y];
      return result;
    }
  )",
                                  inputs, inputs.size(), options);
}

// The triangles of all geometries on the device, in the order of the scene.
std::vector<uvec3> readTriangles(const render::DeviceScene& device, const scene::Scene& scene) {
  std::vector<uvec2> inputs;  // geometry and triangle
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    for (std::uint32_t i = 0; i < scene.meshes[m].geometries[0].triangles.size(); ++i) inputs.push_back({m, i});
  ComputeOptions options;
  options.addresses[0] = device.frameTemplate().geometries;
  return runCompute<uvec3>(R"(
    #include <quintet/shared/frame.h>
    layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Geometries { GeometryData at[]; };
    layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Uvec3s { uvec3 at[]; };
    #define In uvec2
    #define Out uvec3
    Out run(uint index, In value) { return Uvec3s(Geometries(testAddress(0)).at[value.x].triangles).at[value.y]; }
  )",
                           inputs, inputs.size(), options);
}

std::vector<uvec3> trianglesOf(const scene::Scene& scene) {
  std::vector<uvec3> all;
  for (const scene::Mesh& mesh : scene.meshes)
    all.insert(all.end(), mesh.geometries[0].triangles.begin(), mesh.geometries[0].triangles.end());
  return all;
}

// The largest differences of all vertices.
struct Differences {
  double position = 0;  // relative to 1 + the length
  double normal = 0, tangent = 0;
};

Differences differences(const std::vector<DeviceVertex>& vertices, const scene::Scene& scene,
                        const scene::Scene& undeformed) {
  Differences largest;
  std::size_t next = 0;
  double moved = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Geometry& expected = scene.meshes[m].geometries[0];
    for (std::size_t i = 0; i < expected.positions.size(); ++i) {
      const DeviceVertex& vertex = vertices[next++];
      const vec3& p = expected.positions[i];
      largest.position = std::max(largest.position, double{glm::length(vertex.position - p) / (1.0f + glm::length(p))});
      const vec3 normal = expected.normals.empty() ? vec3(0.0f) : expected.normals[i];
      const vec4 tangent = expected.tangents.empty() ? vec4(0.0f) : expected.tangents[i];
      EXPECT_LT(glm::length(vertex.normal - normal), 1e-3f) << "mesh " << m << ", vertex " << i;
      EXPECT_LT(glm::length(vertex.tangent - tangent), 1e-3f) << "mesh " << m << ", vertex " << i;
      largest.normal = std::max(largest.normal, double{glm::length(vertex.normal - normal)});
      largest.tangent = std::max(largest.tangent, double{glm::length(vertex.tangent - tangent)});
      moved = std::max(moved, double{glm::length(p - undeformed.meshes[m].geometries[0].positions[i])});
    }
  }
  EXPECT_EQ(next, vertices.size());
  EXPECT_GT(moved, 0.1) << "nothing has moved";
  return largest;
}

// Shows frames in any order, and compares the vertices of each with those of the host.
void expectHostVertices(const scene::Scene& scene) {
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{}, {.compiler = &testCompiler()});
  for (const double frame : {24.0, 7.0, 15.5}) {
    device.setFrame(frame);
    scene::Scene posed = scene;
    scene::applyPose(posed, scene::poseAt(scene.nodeAnimation.get(), frame));
    const Differences found = differences(readVertices(device, scene), posed, scene);
    EXPECT_LT(found.position, 2e-5) << frame;
    EXPECT_LT(found.normal, 1e-4) << frame;
    EXPECT_LT(found.tangent, 1e-4) << frame;
    EXPECT_EQ(readTriangles(device, scene), trianglesOf(posed)) << frame;
  }
}

// Morph targets and skins in all combinations of attributes.
TEST(Deformation, EqualsThatOfTheHost) {
  DeformedScene scene(1);
  const int skins[] = {scene.addSkin(3, vec3(1.0f)), scene.addSkin(5, vec3(-0.7f, 1.3f, 1.0f)),
                       scene.addSkin(300, vec3(-1.0f, -1.2f, -0.8f))};
  for (const std::size_t targets : {0, 1, 4})
    for (const std::size_t skinSets : {0, 1, 3})
      for (int attributes = 0; attributes < 4; ++attributes) {
        DeformedMeshOptions options{.targets = targets, .skinSets = skinSets};
        options.skin = skinSets == 0 && targets > 0 ? -1 : skins[static_cast<std::size_t>(attributes) % 3];
        options.normals = attributes > 0;
        options.tangents = attributes > 1;
        options.faceNormals = attributes == 3;
        options.targetNormals = targets > 0 && attributes > 0;
        options.targetTangents = targets > 0 && attributes > 1;
        scene.addMesh(options);
      }
  expectHostVertices(scene.build());
}

// Joints that mirror at some time, or a part of the mesh: the winding and the handedness of tangents change with the frame.
TEST(Deformation, TurnsMirroredPartsAsTheHost) {
  DeformedScene scene(6);
  const vec3 plain(1.0f), mirrored(1.0f, -1.0f, 1.0f);
  const int skins[] = {scene.addSkin(4, {plain, plain}, mirrored), scene.addSkin(4, {mirrored, mirrored}, plain),
                       scene.addSkin(6, {plain, mirrored}, plain), scene.addSkin(6, {mirrored, plain}, mirrored)};
  for (const int skin : skins) {
    scene.addMesh({.skin = skin, .skinSets = 1, .tangents = true});
    scene.addMesh({.targets = 1, .skin = skin, .skinSets = 2, .normals = false});
    scene.addMesh({.skin = skin, .skinSets = 1, .faceNormals = true});
  }
  const scene::Scene built = scene.build();
  const std::vector<uvec3> atStart = trianglesOf(built);
  std::size_t turned = 0;
  scene::Scene posed = built;
  scene::applyPose(posed, scene::poseAt(built.nodeAnimation.get(), 24.0));
  const std::vector<uvec3> atEnd = trianglesOf(posed);
  for (std::size_t i = 0; i < atStart.size(); ++i) turned += atStart[i] != atEnd[i];
  EXPECT_GT(turned, atStart.size() / 2);
  EXPECT_LT(turned, atStart.size());
  expectHostVertices(built);
}

// Targets displace attributes that the geometry does not have, and the other way round.
TEST(Deformation, IgnoresDisplacementsOfAbsentAttributes) {
  DeformedScene scene(2);
  const int skin = scene.addSkin(4, vec3(1.0f, -1.0f, 1.0f));
  scene.addMesh({.targets = 3, .targetNormals = true, .targetTangents = true, .normals = false});
  scene.addMesh({.targets = 3, .targetTangents = true, .skin = skin, .skinSets = 2});
  scene.addMesh({.targets = 3, .skin = skin, .skinSets = 2, .tangents = true});
  expectHostVertices(scene.build());
}

// Values that are not finite, weights without a sum, and normals and tangents without a direction.
TEST(Deformation, RepairsAsTheHost) {
  DeformedScene scene(3);
  const int skin = scene.addSkin(6, vec3(1.0f));
  DeformedMeshOptions options{
      .targets = 3, .targetNormals = true, .targetTangents = true, .tangents = true, .broken = true};
  scene.addMesh(options);
  options.skin = skin;
  options.skinSets = 2;
  scene.addMesh(options);
  options.normals = options.tangents = options.targetNormals = options.targetTangents = false;
  scene.addMesh(options);
  expectHostVertices(scene.build());
}

// Vectors along one axis, and those whose square overflows or underflows. The others stay as they are.
TEST(Deformation, NormalizesTinyAndHugeDirections) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const std::vector<vec3> vectors{{3, 0, 0},
                                  {0, 3, 0},
                                  {0, 0, -3},
                                  {1e30f, -2e30f, 1e25f},
                                  {-1e-30f, 3e-30f, 2e-30f},
                                  {0, 0, 0},
                                  {0, kInf, 0},
                                  {1, 0, std::numeric_limits<float>::quiet_NaN()}};
  const auto answers = runCompute<vec4>(R"(
    #include <quintet/passes/deform.glsl>
    #define In vec3
    #define Out vec4
    Out run(uint index, In v) { return vec4(normalizeDirection(v) ? 1.0 : 0.0, v); }
  )",
                                        vectors, vectors.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const vec3 got(answers[i].y, answers[i].z, answers[i].w);
    EXPECT_EQ(answers[i].x, i < 5 ? 1.0f : 0.0f) << i;
    if (i < 5) {
      EXPECT_LT(glm::length(glm::dvec3(got) - glm::normalize(glm::dvec3(vectors[i]))), 1e-6) << i;
    } else if (i == 5) {
      EXPECT_EQ(got, vec3(0.0f));
    }
  }
}

// Joints with a scale of 0 move all vertices onto a line. The rounding of the device decides which of the perpendicular
// directions become normals.
TEST(Deformation, GivesCollapsedMeshesDirections) {
  DeformedScene source(4);
  const int flat = source.addSkin(2, vec3(0.0f));
  source.addMesh({.skin = flat, .skinSets = 1, .tangents = true});
  const scene::Scene scene = source.build();
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{}, {.compiler = &testCompiler()});
  device.setFrame(7.0);
  scene::Scene posed = scene;
  scene::applyPose(posed, scene::poseAt(scene.nodeAnimation.get(), 7.0));
  const std::vector<vec3>& positions = posed.meshes[0].geometries[0].positions;
  const std::vector<DeviceVertex> vertices = readVertices(device, scene);
  ASSERT_EQ(vertices.size(), positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const vec3 tangent(vertices[i].tangent);
    EXPECT_LT(glm::length(vertices[i].position - positions[i]), 1e-5f) << i;
    EXPECT_NEAR(glm::length(vertices[i].normal), 1.0f, 1e-5f) << i;
    EXPECT_NEAR(glm::length(tangent), 1.0f, 1e-5f) << i;
    EXPECT_NEAR(glm::dot(vertices[i].normal, tangent), 0.0f, 1e-5f) << i;
  }
}

// ---- Quality of trees ----

// The root of the tree that TreeCost computes for moved vertices.
shared::TreeCostNode rootOf(const render::TreeCost& cost) {
  const auto pass = render::makePass(testContext(), testSet(), testCompiler(), "tree_cost");
  const gpu::Buffer result(testContext(), {.size = sizeof(shared::TreeCostNode), .name = "root"});
  testContext().submitAndWait([&](gpu::Commands& commands) {
    for (std::size_t level = 0; level < cost.levelCount(); ++level) {
      cost.record(commands, *pass, level, result.address());
      commands.barrier(gpu::Stage::compute, gpu::Stage::compute);
    }
  });
  return result.downloadAs<shared::TreeCostNode>(1)[0];
}

struct SomeTriangles {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  gpu::Buffer positionBuffer, triangleBuffer;
};

SomeTriangles someTriangles(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto vector = [&] { return vec3(uniform(random), uniform(random), uniform(random)); };
  SomeTriangles mesh;
  for (std::uint32_t t = 0; t < count; ++t) {
    const vec3 center = vector();
    for (int c = 0; c < 3; ++c) mesh.positions.push_back(center + 0.1f * vector());
    mesh.triangles.push_back({3 * t, 3 * t + 2, 3 * t + 1});
  }
  return mesh;
}

TEST(TreeCost, EqualsThatOfTheHost) {
  std::mt19937 random(4);
  for (const auto& [first, second] : std::vector<std::pair<std::size_t, std::size_t>>{
           {1, 0}, {2, 0}, {1, 2}, {63, 0}, {64, 0}, {60, 5}, {1000, 7}, {3, 4093}, {4097, 1}}) {
    std::vector<SomeTriangles> meshes;
    meshes.push_back(someTriangles(first, random));
    if (second > 0) meshes.push_back(someTriangles(second, random));
    rt::BlasInput built, moved;
    std::vector<shared::TreeCostGeometry> geometries;
    for (const SomeTriangles& mesh : meshes)
      built.geometries.push_back({.positions = mesh.positions, .triangles = mesh.triangles});
    const rt::RefitQuality quality(built);
    std::vector<std::vector<vec3>> shaken;
    std::uint32_t before = 0;
    for (SomeTriangles& mesh : meshes) {
      std::vector<vec3>& positions = shaken.emplace_back(mesh.positions);
      for (vec3& p : positions) p += vec3(p.y * p.y, 2.0f * p.x * p.z, -p.x);
      mesh.positionBuffer = gpu::makeBufferOf(testContext(), positions, 0, "moved");
      mesh.triangleBuffer = gpu::makeBufferOf(testContext(), mesh.triangles, 0, "triangles");
      geometries.push_back({mesh.positionBuffer.address(), mesh.triangleBuffer.address(), before, 0});
      before += static_cast<std::uint32_t>(mesh.triangles.size());
    }
    for (std::size_t g = 0; g < meshes.size(); ++g)
      moved.geometries.push_back({.positions = shaken[g], .triangles = meshes[g].triangles});
    const render::TreeCost cost(testContext(), built, geometries);
    const shared::TreeCostNode root = rootOf(cost);
    Bounds3 bounds;
    for (const std::vector<vec3>& positions : shaken)
      for (const vec3& p : positions) bounds.extend(p);
    EXPECT_EQ(root.low, bounds.min) << first << " and " << second;
    EXPECT_EQ(root.high, bounds.max) << first << " and " << second;
    const double expected = quality.growth(moved);
    EXPECT_NEAR(cost.growth(root), expected, 1e-4 * expected) << first << " and " << second;
  }
}

// ---- Frames ----

// The memory of the device is the same after every frame.
TEST(Deformation, TakesNoMemoryPerFrame) {
  DeformedScene builder(5);
  const int skin = builder.addSkin(8, vec3(1.0f));
  for (int i = 0; i < 3; ++i)
    builder.addMesh({.targets = 2, .targetNormals = true, .skin = skin, .skinSets = 2, .tangents = true});
  render::DeviceScene device(testContext(), builder.build(), scene::Environment{}, {.compiler = &testCompiler()});
  device.prepareFor(2);
  const auto heldAfter = [&](int firstFrame) {
    for (int frame = firstFrame; frame < firstFrame + 6; ++frame) device.setFrame(frame);
    testContext().submitAndWait([](gpu::Commands&) {});  // frees what the frames have used
    std::uint64_t sum = 0;
    for (const std::uint64_t bytes : testContext().memory().held) sum += bytes;
    return sum;
  };
  heldAfter(1);
  const std::uint64_t before = heldAfter(7);
  EXPECT_EQ(heldAfter(13), before);
}

}  // namespace
}  // namespace quintet::test
