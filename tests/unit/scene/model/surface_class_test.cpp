// SPDX-License-Identifier: Apache-2.0
// Classes of surfaces: alpha-tested, pane, shadow-tinting.
#include "scene/model/surface_class.h"

#include <gtest/gtest.h>

#include <cmath>

namespace quintet::test {
namespace {

using scene::AlphaMode;
using scene::Material;

// A scene whose only geometry and only solid have this material.
scene::Scene withMaterial(const Material& material) {
  scene::Scene s;
  s.materials = {material};
  scene::Geometry g;
  g.material = 0;
  s.meshes.emplace_back().geometries = {g};
  scene::PrimitiveSet set;
  set.primitives.resize(1);
  set.primitives[0].material = 0;
  s.meshes.emplace_back().primitiveSets = {set};
  return s;
}

struct Class {
  bool alpha, pane, tints;
  bool operator==(const Class&) const = default;
};

// Checks that the geometry and the set are in the same classes.
Class classOf(const scene::Scene& s) {
  const scene::Geometry& g = s.meshes[0].geometries[0];
  const scene::PrimitiveSet& set = s.meshes[1].primitiveSets[0];
  const Class result{scene::needsAlphaTest(s, g), scene::isPane(s, g), scene::tintsShadows(s, g)};
  EXPECT_EQ(result, (Class{scene::needsAlphaTest(s, set), scene::isPane(s, set), scene::tintsShadows(s, set)}));
  return result;
}

TEST(SurfaceClass, DependsOnAlphaModeAndAlpha) {
  Material m;
  EXPECT_EQ(classOf(withMaterial(m)), (Class{false, false, false}));
  m.baseColor.a = 0.5f;
  EXPECT_EQ(classOf(withMaterial(m)), (Class{false, false, false}));
  m.alphaMode = AlphaMode::mask;
  EXPECT_EQ(classOf(withMaterial(m)), (Class{true, false, false}));
  m.alphaMode = AlphaMode::blend;
  EXPECT_EQ(classOf(withMaterial(m)), (Class{true, false, true}));
  m.baseColor.a = 1.0f;
  EXPECT_EQ(classOf(withMaterial(m)), (Class{false, false, false}));
}

// No alpha reaches a cutoff above 1, so the surface is missing. An alpha equal to the cutoff is visible.
TEST(SurfaceClass, DependsOnTheCutoff) {
  Material m;
  m.alphaMode = AlphaMode::mask;
  m.alphaCutoff = 1.0f;
  EXPECT_EQ(classOf(withMaterial(m)), (Class{false, false, false}));
  EXPECT_FALSE(scene::isInvisible(m));
  m.alphaCutoff = std::nextafter(1.0f, 2.0f);
  EXPECT_EQ(classOf(withMaterial(m)), (Class{true, false, false}));
  EXPECT_TRUE(scene::isInvisible(m));
  scene::Scene animated = withMaterial(Material{m});
  animated.materials[0].alphaCutoff = 0.5f;
  EXPECT_FALSE(classOf(animated).alpha);
  animated.materialStates = {{m}};
  EXPECT_TRUE(classOf(animated).alpha) << "at some time";
  m.alphaMode = AlphaMode::opaque;
  EXPECT_EQ(classOf(withMaterial(m)), (Class{false, false, false}));
  EXPECT_FALSE(scene::isInvisible(m));
}

TEST(SurfaceClass, InvisibleMaterialsCoverNothing) {
  Material m;
  m.alphaMode = AlphaMode::blend;
  m.baseColor.a = 0.01f;
  EXPECT_FALSE(scene::isInvisible(m));
  m.baseColor.a = 0.0f;
  EXPECT_TRUE(scene::isInvisible(m));
  m.alphaMode = AlphaMode::mask;
  m.alphaCutoff = 0.0f;
  EXPECT_FALSE(scene::isInvisible(m)) << "0 is not below 0";
  m.alphaCutoff = 0.01f;
  EXPECT_TRUE(scene::isInvisible(m));
  m.baseColor.a = 0.01f;
  EXPECT_FALSE(scene::isInvisible(m));
}

TEST(SurfaceClass, DependsOnTheAlphaChannelOfTheTexture) {
  Material m;
  m.alphaMode = AlphaMode::mask;
  m.baseColorTexture.texture = 0;
  scene::Scene s = withMaterial(m);
  s.textures.push_back({"", 0, {}});
  s.images.push_back({"", io::makeImage(1, 1, 3, io::PixelType::u8, io::ColorEncoding::sRgb)});
  EXPECT_FALSE(classOf(s).alpha);
  s.images[0].image = io::makeImage(1, 1, 4, io::PixelType::u8, io::ColorEncoding::sRgb);
  EXPECT_TRUE(classOf(s).alpha);
}

TEST(SurfaceClass, DependsOnTheAlphaOfVertexColors) {
  Material m;
  m.alphaMode = AlphaMode::blend;
  scene::Scene s = withMaterial(m);
  scene::Geometry& g = s.meshes[0].geometries[0];
  g.colors = {vec4(1), vec4(1, 1, 1, 0.5f)};
  EXPECT_TRUE(scene::needsAlphaTest(s, g));
  EXPECT_TRUE(scene::tintsShadows(s, g));
}

TEST(SurfaceClass, PanesAreThinSmoothAndTransmissive) {
  Material pane;
  pane.transmission = 1.0f;
  pane.roughness = 0.0f;
  pane.metallic = 0.0f;
  EXPECT_EQ(classOf(withMaterial(pane)), (Class{false, true, true}));
  Material other = pane;
  other.thickness = 0.1f;
  EXPECT_FALSE(classOf(withMaterial(other)).pane);
  other = pane;
  other.roughness = 0.3f;
  EXPECT_FALSE(classOf(withMaterial(other)).pane);
  other.metallicRoughnessTexture.texture = 0;  // parts can be smooth
  EXPECT_TRUE(scene::isPane(other));
  other = pane;
  other.metallic = 1.0f;
  EXPECT_FALSE(classOf(withMaterial(other)).pane);
  other = pane;
  other.unlit = true;
  EXPECT_FALSE(classOf(withMaterial(other)).pane);
}

TEST(SurfaceClass, CustomSetsAreNeverPanes) {
  Material pane;
  pane.transmission = 1.0f;
  pane.roughness = 0.0f;
  pane.metallic = 0.0f;
  scene::Scene s = withMaterial(pane);
  scene::PrimitiveSet custom;
  custom.kind = scene::PrimitiveSetKind::custom;
  custom.material = 0;
  EXPECT_FALSE(scene::isPane(s, custom));
  EXPECT_FALSE(scene::tintsShadows(s, custom));
}

}  // namespace
}  // namespace quintet::test
