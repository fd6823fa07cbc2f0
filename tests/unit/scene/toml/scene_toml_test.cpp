// SPDX-License-Identifier: Apache-2.0
// Scene files: materials, meshes, glTF files, lights, cameras and environment.
#include "scene/toml/scene_toml.h"

#include <gmock/gmock.h>

#include <stdlib.h>

#include <map>

#include "base/error.h"
#include "base/file.h"
#include "base/file_roots.h"
#include "io/codec.h"
#include "scene/gltf_builder.h"
#include "scene/toml/parse.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

using scene::Scene;

TEST(SceneToml, ReadsAnEmptyFile) {
  const Scene s = parse("# nothing\n");
  EXPECT_TRUE(s.meshes.empty());
  EXPECT_EQ(s.name, "test.scene.toml");
  EXPECT_FALSE(s.environment.present);
}

TEST(SceneToml, ReadsMaterials) {
  const Scene s = parse(R"(
[[material]]
name = "a"
base_color = "#ff8000"
alpha = 0.5
metallic = 0.25
roughness = 0.75
emissive = [1, 2, 3]
emissive_strength = 2
ior = 1.33
transmission = 1
thickness = 0.1
attenuation_distance = 2
attenuation_color = [0.5, 0.25, 1]
specular = 0.5
specular_color = [1, 2, 0.5]
clearcoat = 0.3
clearcoat_roughness = 0.2
sheen_color = [1, 0.5, 0.25]
sheen_roughness = 0.4
diffuse_transmission = 0.6
diffuse_transmission_color = [0.5, 1, 0.25]
anisotropy = 0.7
anisotropy_rotation = 90
iridescence = 0.8
iridescence_ior = 1.6
iridescence_thickness_minimum = 150
iridescence_thickness_maximum = 550
dispersion = 0.36
multiscatter_color = [0.25, 0.5, 1]
scatter_anisotropy = -0.75
dielectric_priority = -2.5
alpha_mode = "mask"
alpha_cutoff = 0.3
double_sided = true
unlit = true
[[material]]
name = "b"
like = "a"
roughness = 0
base_color = [0.1, 0.2, 0.3, 0.4]
[[material]]
name = "c"
)");
  ASSERT_EQ(s.materials.size(), 3u);
  const scene::Material& a = s.materials[0];
  expectNear(vec3(a.baseColor), {1, 0.2158605f, 0});  // IEC 61966-2-1: 128/255 is 0.2158605
  EXPECT_EQ(a.baseColor.a, 0.5f);
  EXPECT_EQ(a.metallic, 0.25f);
  EXPECT_EQ(a.roughness, 0.75f);
  EXPECT_EQ(a.emissive, vec3(2, 4, 6));
  EXPECT_EQ(a.ior, 1.33f);
  EXPECT_EQ(a.transmission, 1);
  EXPECT_EQ(a.thickness, 0.1f);
  EXPECT_EQ(a.attenuationDistance, 2);
  EXPECT_EQ(a.attenuationColor, vec3(0.5f, 0.25f, 1));
  EXPECT_EQ(a.specular, 0.5f);
  EXPECT_EQ(a.specularColor, vec3(1, 2, 0.5f));
  EXPECT_EQ(a.clearcoat, 0.3f);
  EXPECT_EQ(a.clearcoatRoughness, 0.2f);
  EXPECT_EQ(a.sheenColor, vec3(1, 0.5f, 0.25f));
  EXPECT_EQ(a.sheenRoughness, 0.4f);
  EXPECT_EQ(a.diffuseTransmission, 0.6f);
  EXPECT_EQ(a.diffuseTransmissionColor, vec3(0.5f, 1, 0.25f));
  EXPECT_EQ(a.anisotropy, 0.7f);
  EXPECT_FLOAT_EQ(a.anisotropyRotation, kPi / 2);
  EXPECT_EQ(a.iridescence, 0.8f);
  EXPECT_EQ(a.iridescenceIor, 1.6f);
  EXPECT_EQ(a.iridescenceThicknessMinimum, 150);
  EXPECT_EQ(a.iridescenceThicknessMaximum, 550);
  EXPECT_EQ(a.dispersion, 0.36f);
  EXPECT_EQ(a.multiscatterColor, vec3(0.25f, 0.5f, 1));
  EXPECT_EQ(a.scatterAnisotropy, -0.75f);
  EXPECT_EQ(a.dielectricPriority, -2.5f);
  EXPECT_EQ(a.alphaMode, scene::AlphaMode::mask);
  EXPECT_EQ(a.alphaCutoff, 0.3f);
  EXPECT_TRUE(a.doubleSided && a.unlit);
  const scene::Material& b = s.materials[1];
  EXPECT_EQ(b.roughness, 0);
  EXPECT_EQ(b.baseColor, vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(b.ior, 1.33f);
  EXPECT_FLOAT_EQ(b.anisotropyRotation, kPi / 2);
  EXPECT_EQ(s.materials[2].metallic, 0);
  EXPECT_EQ(s.materials[2].roughness, 1);
}

TEST(SceneToml, ReadsEachTextureOnce) {
  TempFolder folder;
  writeFile(folder / "p.png", io::encodePng(io::makeImage(2, 3, 3, io::PixelType::u8, io::ColorEncoding::sRgb)));
  const std::string text = R"(
[[material]]
name = "a"
base_color_texture = "p.png"
normal_texture = "p.png"
roughness = 0.5
diffuse_transmission_texture = "p.png"
diffuse_transmission_color_texture = { image = "p.png", uv_set = 1 }
metallic_roughness_texture = { image = "./p.png", uv_set = 1, offset = [0.1, 0.2], scale = [2, 3], rotation = 90, wrap = "clamp_to_edge", wrap_v = "mirrored_repeat", filter = "nearest" }
[[mesh]]
shape = "quad"
material = "a"
)";
  const Scene s = scene::parseSceneToml(text, folder / "x.scene.toml");
  ASSERT_EQ(s.images.size(), 1u);
  EXPECT_EQ(s.images[0].image.height, 3u);
  ASSERT_EQ(s.textures.size(), 2u);
  const scene::TextureUse& use = s.materials[0].metallicRoughnessTexture;
  EXPECT_EQ(s.materials[0].baseColorTexture.texture, s.materials[0].normalTexture.texture);
  EXPECT_EQ(s.materials[0].diffuseTransmissionTexture, s.materials[0].baseColorTexture);
  EXPECT_EQ(s.materials[0].diffuseTransmissionColorTexture.texture, s.materials[0].baseColorTexture.texture);
  EXPECT_EQ(s.materials[0].diffuseTransmissionColorTexture.uvSet, 1);
  EXPECT_EQ(use.uvSet, 1);
  EXPECT_EQ(use.offset, vec2(0.1f, 0.2f));
  EXPECT_EQ(use.scale, vec2(2, 3));
  EXPECT_NEAR(use.rotation, kPi / 2, 1e-6f);
  const scene::Sampler& sampler = s.textures[static_cast<std::size_t>(use.texture)].sampler;
  EXPECT_EQ(sampler.wrapU, scene::Wrap::clampToEdge);
  EXPECT_EQ(sampler.wrapV, scene::Wrap::mirroredRepeat);
  EXPECT_EQ(sampler.filter, scene::Filter::nearest);
  EXPECT_EQ(s.meshes[0].geometries[0].tangents.size(), 4u);  // the normal map needs them
  EXPECT_EQ(s.report.files.size(), 2u);
}

// Checks that the triangles face outwards and enclose `volume` (divergence theorem), and that every edge has an
// opposite edge, with equal positions joined.
void expectClosedSurface(const scene::Geometry& g, double volume) {
  double sum = 0.0;
  std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> edges;
  const auto key = [&](std::uint32_t i) {
    return std::array<float, 3>{g.positions[i].x, g.positions[i].y, g.positions[i].z};
  };
  for (const uvec3& t : g.triangles) {
    const glm::dvec3 a(g.positions[t.x]), b(g.positions[t.y]), c(g.positions[t.z]);
    sum += glm::dot(a, glm::cross(b, c)) / 6.0;
    for (int i = 0; i < 3; ++i) {
      ++edges[{key(t[i]), key(t[(i + 1) % 3])}];
      --edges[{key(t[(i + 1) % 3]), key(t[i])}];
      EXPECT_GT(glm::dot(g.normals[t[i]], vec3(glm::cross(b - a, c - a))), 0.0f);
    }
  }
  EXPECT_NEAR(sum, volume, 1e-6 * volume);
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
}

TEST(SceneToml, CreatesShapes) {
  const auto geometry = [](const std::string& body) {
    return parse("[[mesh]]\n" + body).meshes.at(0).geometries.at(0);
  };
  expectClosedSurface(geometry("shape = 'cube'"), 8);
  expectClosedSurface(geometry("shape = 'cube'\nsize = [1, 2, 3]\nsegments = 3"), 6);
  expectClosedSurface(geometry("shape = 'cube'\nscale = [1, 2, -3]"), 48);  // mirrored, still facing outwards
  expectClosedSurface(geometry("shape = 'tetrahedron'"), 8 * std::sqrt(3.0) / 27);
  // 4 columns and 2 rows are an octahedron.
  expectClosedSurface(geometry("shape = 'uv_sphere'\nsegments = [4, 2]"), 4.0 / 3.0);
  const scene::Geometry sphere = geometry("shape = 'uv_sphere'\nradius = 2\nsegments = [200, 100]");
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) EXPECT_NEAR(glm::length(sphere.positions[i]), 2, 1e-6f);
  // Frusta of regular polygons of 200 sides.
  double volume = 0.0;
  const auto areaAt = [](double theta) {
    return 100 * std::pow(2 * std::sin(theta), 2) * std::sin(glm::pi<double>() / 100);
  };
  for (int i = 0; i < 100; ++i) {
    const double a = glm::pi<double>() * i / 100, b = glm::pi<double>() * (i + 1) / 100;
    volume += 2 * (std::cos(a) - std::cos(b)) / 3 * (areaAt(a) + areaAt(b) + std::sqrt(areaAt(a) * areaAt(b)));
  }
  expectClosedSurface(sphere, volume);
  const scene::Geometry plane = geometry("shape = 'plane'\nsize = [4, 6]\nsegments = [2, 3]");
  EXPECT_EQ(plane.triangles.size(), 12u);
  EXPECT_EQ(plane.positions.front(), vec3(-2, 0, -3));
  EXPECT_EQ(plane.positions.back(), vec3(2, 0, 3));
  for (const vec3& n : plane.normals) EXPECT_EQ(n, vec3(0, 1, 0));
  const scene::Geometry quad = geometry("shape = 'quad'\ntranslate = [0, 0, 5]");
  EXPECT_EQ(quad.positions.front(), vec3(-1, 1, 5));
  EXPECT_EQ(quad.uvs[0].front(), vec2(0, 0));
  for (const vec3& n : quad.normals) EXPECT_EQ(n, vec3(0, 0, 1));
  EXPECT_TRUE(geometry("shape = 'cube'\nflat = true").normals.empty());
}

TEST(SceneToml, ReadsInlineTriangles) {
  const Scene s = parse(R"(
[[mesh]]
name = "t"
positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
indices = [0, 1, 2, 2, 1, 3]
normals = [[0, 0, 2], [0, 0, 1], [0, 0, 1], [0, 0, 1]]
uvs = [[0, 1], [1, 1], [0, 0], [1, 0]]
colors = [[1, 0, 0], [0, 1, 0, 0.5], "#0000ff", [1, 1, 1]]
[[mesh]]
positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
)");
  const scene::Geometry& g = s.meshes[0].geometries[0];
  EXPECT_EQ(g.triangles, (std::vector<uvec3>{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(g.normals[0], vec3(0, 0, 1));
  EXPECT_EQ(g.uvs[0][0], vec2(0, 1));
  EXPECT_EQ(g.colors[1], vec4(0, 1, 0, 0.5f));
  EXPECT_EQ(g.colors[2], vec4(0, 0, 1, 1));
  EXPECT_EQ(s.meshes[1].geometries[0].triangles.size(), 1u);
  ASSERT_EQ(s.materials.size(), 1u);  // both meshes use the default
  EXPECT_EQ(s.materials[0].name, "default");
  EXPECT_EQ(g.material, 0);
  EXPECT_EQ(s.instances.size(), 2u);
}

TEST(SceneToml, ReadsLightsCamerasAndEnvironment) {
  const Scene s = parse(R"(
[[light]]
name = "l"
type = "spot"
position = [0, 3, 0]
target = [0, 0, 0]
color = [1, 0.5, 0.25]
intensity = 8
outer_angle = 30
inner_angle = 20
[[light]]
type = "directional"
direction = [0, -2, 0]
[[camera]]
name = "c"
look_from = [0, 0, 5]
look_at = [0, 0, 1]
fov = 60
aperture = 0.1
[[camera]]
look_from = [0, 5, 0]
look_at = [0, 0, 0]
orthographic = [4, 2]
focus = 3
[environment]
color = "#ffffff"
intensity = 0.5
rotation = 90
)");
  ASSERT_EQ(s.lights.size(), 2u);
  EXPECT_EQ(s.lights[0].intensity, vec3(8, 4, 2));
  EXPECT_EQ(s.lights[0].direction, vec3(0, -1, 0));
  EXPECT_NEAR(s.lights[0].outerConeAngle, glm::radians(30.0f), 1e-6f);
  EXPECT_NEAR(s.lights[0].innerConeAngle, glm::radians(20.0f), 1e-6f);
  EXPECT_EQ(s.lights[1].direction, vec3(0, -1, 0));
  ASSERT_EQ(s.cameras.size(), 2u);
  EXPECT_NEAR(s.cameras[0].verticalFov, glm::radians(60.0f), 1e-6f);
  EXPECT_EQ(s.cameras[0].focusDistance, 4);
  EXPECT_EQ(s.cameras[0].apertureRadius, 0.1f);
  expectNear(vec3(s.cameras[0].worldFromCamera[3]), {0, 0, 5});
  expectNear(vec3(s.cameras[0].worldFromCamera[2]), {0, 0, 1});
  EXPECT_TRUE(s.cameras[1].orthographic);
  EXPECT_EQ(s.cameras[1].orthographicHalfSize, vec2(2, 1));
  EXPECT_EQ(s.cameras[1].focusDistance, 3);
  EXPECT_TRUE(s.environment.present);
  EXPECT_EQ(s.environment.constant, vec3(1));
  EXPECT_NEAR(s.environment.rotation, kPi / 2, 1e-6f);
  EXPECT_TRUE(parse("[environment]\nnone = true\n").environment.present);
  EXPECT_FALSE(parse("[environment]\ndefault = true\n").environment.image.empty());
}

TEST(SceneToml, ReadsNoFileOutsideOfTheRoots) {
  TempFolder folder;
  std::filesystem::create_directories(folder / "project/scenes");
  writeFile(folder / "p.png", io::encodePng(io::makeImage(2, 3, 3, io::PixelType::u8, io::ColorEncoding::sRgb)));
  writeFile(folder / "p.hdr", io::encodeHdr(io::makeImage(4, 2, 3, io::PixelType::f32, io::ColorEncoding::linear)));
  GltfBuilder builder;
  builder.addTriangle();
  writeFile(folder / "t.glb", builder.glb());
  for (const char* name : {"p.png", "p.hdr", "t.glb"}) {
    std::filesystem::copy_file(folder / name, folder / "project" / name);
    std::filesystem::create_symlink(folder / name, folder / "project/scenes" / name);
  }
  const auto errorOf = [&](const std::string& path) -> std::string {
    const std::string quoted = "'" + path + "'\n", extension = std::filesystem::path(path).extension();
    std::string text = "[[material]]\nname = 'a'\nbase_color_texture = " + quoted;
    if (extension == ".hdr") text = "[environment]\nimage = " + quoted;
    if (extension == ".glb") text = "[[file]]\nname = 'f'\npath = " + quoted;
    try {
      scene::parseSceneToml(text, folder / "project/scenes/x.scene.toml");
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  for (const std::string name : {"p.png", "p.hdr", "t.glb"}) {
    for (const std::string& path : {"../../" + name, (folder / name).string(), name}) {
      EXPECT_EQ(errorOf(path), "none") << path;
      addFileRoot(folder / "project");
      EXPECT_THAT(errorOf(path), testing::HasSubstr("is outside of the project"));
      EXPECT_THAT(errorOf("../../missing" + name), testing::HasSubstr("is outside of the project"))
          << "the message does not reveal which files exist";
      EXPECT_EQ(errorOf("../" + name), "none");
      ::unsetenv("QUINTET_INCLUDE_ROOTS");
    }
  }
}

TEST(SceneToml, MakesThePartsOfFilesAvailable) {
  TempFolder folder;
  GltfBuilder builder;
  const int positions = builder.addAccessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  builder.add("materials", {{"name", "Gold"}, {"pbrMetallicRoughness", {{"roughnessFactor", 0.25}}}});
  builder.add("meshes", {{"name", "Tri"},
                         {"primitives", Json::array({{{"attributes", {{"POSITION", positions}}}, {"material", 0}}})}});
  builder.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}, {"name", "Cam"}});
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}, {"name", "Lamp"}}});
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.add("nodes", {{"mesh", 0},
                        {"name", "N"},
                        {"translation", {1, 0, 0}},
                        {"camera", 0},
                        {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  builder.root["scenes"] = Json::array({{{"nodes", {0}}}});
  writeFile(folder / "t.glb", builder.glb());
  const std::string file = "[[file]]\nname = 'f'\npath = 't.glb'\n";
  const auto load = [&](const std::string& text) { return scene::parseSceneToml(text, folder / "x.scene.toml"); };

  const Scene alone = load(file);
  ASSERT_EQ(alone.instances.size(), 1u);
  EXPECT_EQ(alone.instances[0].worldFromObject[3].x, 1);
  EXPECT_EQ(alone.cameras.at(0).name, "f/Cam");
  EXPECT_EQ(alone.lights.at(0).position, vec3(1, 0, 0));

  const Scene twice = load(file + R"(
[[spheres]]
items = [{}]
material = "f/Gold"
[[material]]
name = "mine"
like = "f/Gold"
metallic = 0.5
[[instance]]
of = "f"
translate = [0, 2, 0]
keyframes = [ { frame = 0 }, { frame = 2, translate = [0, 4, 0], scale = 3 } ]
[[instance]]
of = "f/Tri"
)");
  ASSERT_EQ(twice.instances.size(), 3u);
  expectNear(vec3(twice.instances[0].worldFromObject[3]), {1, 2, 0});
  expectNear(vec3(twice.instances[0].animatedFromObject[3]), {1, 0, 0});  // applied before the keyframe
  EXPECT_EQ(twice.instances[1].worldFromObject, mat4(1.0f));              // the mesh without the transform of its node
  EXPECT_EQ(twice.lights.size(), 1u);
  EXPECT_EQ(twice.lights[0].position, vec3(1, 2, 0));
  EXPECT_EQ(twice.materials[1].roughness, 0.25f);
  EXPECT_EQ(twice.materials[1].metallic, 0.5f);
  EXPECT_EQ(twice.meshes[1].primitiveSets[0].primitives[0].material, 0);

  EXPECT_TRUE(load("[[file]]\nname = 'f'\npath = 't.glb'\nplace = false\nlights = false\n").instances.empty());
  try {
    load(file + "[[instance]]\nof = 'f/Try'\n");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.problem(), testing::HasSubstr("'f/Try' (did you mean 'f/Tri'?)"));
  }
}

}  // namespace
}  // namespace quintet::test
