// SPDX-License-Identifier: Apache-2.0
// Multiple importance sampling through panes, alpha and bubbles, against BSDF sampling alone (`naive`): Welch's t-test
// per pixel and channel and on the whole image, at level 0.01. The test itself is tested, too: it must reject path
// tracers with wrong weights, tints or bounce counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>

#include "io/image.h"
#include "pane_scenes.h"
#include "program/load.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kSize = 8;

// A glossy floor and a diffuse wall under a small panel and a dim sky.
SceneBuilder paneRoom() {
  SceneBuilder scene;
  scene::Material floor = lambert({0.7f, 0.6f, 0.5f});
  floor.specular = 1.0f;
  floor.roughness = 0.35f;
  scene.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), floor);
  scene.add(quad({-2, 0, -1.2f}, {4, 0, 0}, {0, 3, 0}), lambert({0.5f, 0.6f, 0.7f}));
  scene.add(quad({-1.2f, 2.4f, -1.1f}, {2.4f, 0, 0}, {0, 0, 2.4f}), emitter({3.0f, 2.5f, 2.0f}));
  scene.sky(vec3(0.2f, 0.3f, 0.4f)).camera(perspective({0.6f, 1.1f, 3.2f}, {0, 0.5f, 0}, 42.0f));
  return scene;
}

// A sheet between panel and floor, rotated about x. The camera sees a part of the floor through it.
scene::Geometry sheet(float height, float degrees) {
  scene::Geometry g = quad({-1.3f, 0, 1.1f}, {2.6f, 0, 0}, {0, 0, -2.2f});
  const mat4 m = glm::rotate(glm::translate(mat4(1.0f), vec3(0, height, 0)), glm::radians(degrees), vec3(1, 0, 0));
  for (vec3& p : g.positions) p = m * vec4(p, 1.0f);
  g.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return g;
}

int addTexture(SceneBuilder& scene, std::uint32_t columns, const std::vector<std::uint8_t>& rgba, bool sRgb) {
  const auto rows = static_cast<std::uint32_t>(rgba.size() / 4 / columns);
  io::Image image =
      io::makeImage(columns, rows, 4, io::PixelType::u8, sRgb ? io::ColorEncoding::sRgb : io::ColorEncoding::linear);
  std::ranges::copy(rgba, image.samples<std::uint8_t>().begin());
  const int index = static_cast<int>(scene.scene.textures.size());
  scene.scene.images.push_back({"image", std::move(image)});
  scene.scene.textures.push_back({"texture", index, {}});
  return index;
}

SceneBuilder onePane() {
  SceneBuilder scene = paneRoom();
  return scene.add(sheet(0.9f, 8.0f), pane({0.35f, 0.9f, 0.5f}));
}

SceneBuilder twoPanes() {
  SceneBuilder scene = paneRoom();
  return scene.add(sheet(0.9f, 8.0f), pane({0.35f, 0.9f, 0.5f})).add(sheet(1.25f, -5.0f), pane({0.9f, 0.5f, 0.4f}));
}

// Stained glass with textures for color, normal, roughness and transmission.
SceneBuilder texturedPane() {
  SceneBuilder scene = paneRoom();
  scene::Material glass = pane(vec3(1.0f));
  glass.baseColorTexture.texture =
      addTexture(scene, 2, {255, 60, 40, 255, 40, 255, 90, 255, 80, 90, 255, 255, 250, 250, 120, 255}, true);
  glass.normalTexture.texture =
      addTexture(scene, 2, {160, 128, 250, 255, 128, 90, 250, 255, 128, 128, 255, 255, 100, 150, 250, 255}, false);
  glass.transmissionTexture.texture = addTexture(scene, 1, {255, 0, 0, 255, 100, 0, 0, 255}, false);
  glass.metallicRoughnessTexture.texture = addTexture(scene, 2, {0, 0, 0, 255, 0, 200, 0, 255}, false);
  glass.metallicRoughnessTexture.scale = {3.0f, 1.0f};
  glass.roughness = 1.0f;
  return scene.add(sheet(0.9f, 8.0f), glass);
}

// Partially transmissive glass with a rough coat: light samples at the pane and through it.
SceneBuilder paintedPane() {
  SceneBuilder scene = paneRoom();
  scene::Material glass = pane({0.4f, 0.8f, 0.9f});
  glass.transmission = 0.6f;
  glass.clearcoat = 0.7f;
  glass.clearcoatRoughness = 0.4f;
  glass.emissive = {0.05f, 0.1f, 0.02f};
  return scene.add(sheet(0.9f, 8.0f), glass);
}

// A blended sheet, and a lattice with holes.
SceneBuilder alpha() {
  SceneBuilder scene = paneRoom();
  scene::Material lattice = veil(lambert(vec3(0.4f)), 1.0f, scene::AlphaMode::mask);
  lattice.baseColorTexture.texture =
      addTexture(scene, 2, {255, 255, 255, 255, 255, 255, 255, 0, 255, 255, 255, 0, 255, 255, 255, 255}, true);
  lattice.baseColorTexture.scale = vec2(3.0f);
  return scene.add(sheet(0.9f, 8.0f), veil(lambert({0.9f, 0.5f, 0.2f}), 0.4f, scene::AlphaMode::blend))
      .add(sheet(1.25f, 0.0f), lattice);
}

// The panel in a bubble, a second bubble on the floor, and a blended sheet of glass.
SceneBuilder bubbles() {
  SceneBuilder scene = paneRoom();
  addBubble(scene, pane({0.9f, 0.7f, 0.4f}), {0, 2.4f, 0}, 1.0f, true);
  addBubble(scene, pane({0.4f, 0.9f, 0.5f}), {-0.5f, 0.5f, 0.3f}, 0.45f, false);
  return scene.add(sheet(0.7f, 8.0f), veil(pane({0.5f, 0.6f, 1.0f}), 0.5f, scene::AlphaMode::blend));
}

// Any-hit shaders do not run for this instance, so it blocks shadow rays.
SceneBuilder forcedOpaque() {
  SceneBuilder scene = onePane();
  scene.scene.instances.back().flags |= scene::kInstanceForceOpaque;
  return scene;
}

// A lamp in a block of rough absorbing glass: light samples at its surface go into the glass.
SceneBuilder lampInRoughGlass() {
  SceneBuilder scene = paneRoom();
  scene::Material glass = clearGlass(1.3f, 1.0f);
  glass.roughness = 0.6f;
  glass.attenuationColor = {0.2f, 0.5f, 0.8f};
  glass.attenuationDistance = 0.5f;
  scene.add(box({-0.8f, 0.05f, -0.6f}, {0.8f, 1.2f, 0.8f}), glass);
  return scene.add(quad({-0.4f, 0.5f, 0.0f}, {0.8f, 0, 0}, {0, 0.5f, 0.1f}), emitter({9.0f, 7.0f, 5.0f}));
}

struct PaneCase {
  const char* name;
  SceneBuilder (*make)();
  int bounces;
  std::uint32_t batches, naiveBatches;
};

void PrintTo(const PaneCase& c, std::ostream* out) { *out << c.name; }

RenderedImage renderPanes(const PaneCase& c, program::Program program, std::uint32_t batches) {
  ImageOptions options;
  options.program = std::move(program);
  options.set = {"bounces=" + std::to_string(c.bounces)};
  options.width = options.height = kSize;
  options.batches = batches;
  return renderImage(c.make(), options);
}

// Returns the reference image, which is rendered once for all tests.
const RenderedImage& naiveOf(const PaneCase& c) {
  static std::map<std::string, RenderedImage> images;
  const auto known = images.find(c.name);
  return known != images.end()
             ? known->second
             : images.emplace(c.name, renderPanes(c, program::loadProgram("naive"), c.naiveBatches)).first->second;
}

struct Verdict {
  bool same = true;
  std::string text;
};

// Half of the level is for the pixels, and half for their sum.
Verdict compareImages(const RenderedImage& a, const RenderedImage& b) {
  std::ostringstream where;
  double smallest = 1.0, whole = 1.0, noise = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    double difference = 0.0, variance = 0.0, sum = 0.0;
    for (std::uint32_t y = 0; y < kSize; ++y) {
      for (std::uint32_t x = 0; x < kSize; ++x) {
        const Moments &ma = a.at(x, y, c), &mb = b.at(x, y, c);
        const double p = pValue(ma, mb, 1e-5 * mb.mean());
        if (p < smallest) {
          smallest = p;
          where.str({});
          where << "pixel " << x << "," << y << " channel " << c << ": " << ma.mean() << " ± " << ma.standardError()
                << " against " << mb.mean() << " ± " << mb.standardError();
        }
        difference += ma.mean() - mb.mean();
        variance += ma.standardError() * ma.standardError() + mb.standardError() * mb.standardError();
        sum += mb.mean();
      }
    }
    whole = std::min(whole, studentTwoSided(difference / std::sqrt(variance), 1e6));
    noise = std::max(noise, std::sqrt(variance) / sum);
  }
  std::ostringstream text;
  text << "smallest p " << smallest << " at " << where.str() << "; whole image p " << whole << ", its error "
       << 100.0 * noise << " %";
  return {smallest >= sidak(0.005, 3 * kSize * kSize) && whole >= sidak(0.005, 3) && noise < 0.01, text.str()};
}

class PaneWeights : public testing::TestWithParam<PaneCase> {};

TEST_P(PaneWeights, AgreeWithBruteForce) {
  const PaneCase& c = GetParam();
  const Verdict v = compareImages(renderPanes(c, program::loadProgram("pathtracer"), c.batches), naiveOf(c));
  std::printf("%s: %s\n", c.name, v.text.c_str());
  EXPECT_TRUE(v.same) << v.text;
}

constexpr PaneCase kOnePane{"OnePane", onePane, 3, 96, 896}, kOneBounce{"TwoPanesOneBounce", twoPanes, 1, 96, 896};

INSTANTIATE_TEST_SUITE_P(Scenes, PaneWeights,
                         testing::Values(kOnePane, PaneCase{"OnePaneOneBounce", onePane, 1, 96, 896},
                                         PaneCase{"TwoPanes", twoPanes, 3, 96, 896}, kOneBounce,
                                         PaneCase{"TexturedPane", texturedPane, 3, 96, 896},
                                         PaneCase{"PaintedPane", paintedPane, 3, 96, 896},
                                         PaneCase{"Alpha", alpha, 3, 96, 896}, PaneCase{"Bubbles", bubbles, 3, 96, 896},
                                         PaneCase{"ForcedOpaque", forcedOpaque, 2, 96, 896},
                                         PaneCase{"LampInRoughGlass", lampInRoughGlass, 3, 96, 896}),
                         [](const auto& test) { return std::string(test.param.name); });

// Returns pathtracer with `from` replaced by `to` in its ray generation shader.
program::Program changed(const std::string& from, const std::string& to) {
  program::Program program = program::loadProgram("pathtracer");
  std::string& text = program.files.at("pathtracer.rgen");
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "pathtracer.rgen has changed: adapt this test";
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return program;
}

// Returns pathtracer with a different any-hit shader for shadow rays and panes.
program::Program shadowed(const std::string& file, const std::string& text) {
  program::Program program = program::loadProgram("pathtracer");
  if (!text.empty()) program.files[file] = text;
  const auto group = std::ranges::find(program.hitGroups, "thin", &program::HitGroup::name);
  EXPECT_NE(group, program.hitGroups.end());
  group->shaders.at("shadow").anyHit = file;
  return program;
}

TEST(PaneWeights, RejectsWrongWeights) {
  const std::string keep =
      "if ((InstanceArray(frame.instances).at[hit.instance].flags & kInstanceOpaque) != 0u) path.bsdfPdf = 0.0;";
  const std::string twice =
      "#version 460\n#extension GL_EXT_ray_tracing : require\n#include <quintet/alpha.glsl>\n#include "
      "<quintet/transmittance.glsl>\n"
      "layout(location = 1) rayPayloadInEXT ShadowPayload payload;\nhitAttributeEXT vec2 baryCoord;\n"
      "void main() {\n  HitPayload hit = hitOf(hitGeometry(), raySeed(payload));\n  hit.barycentric = baryCoord;\n"
      "  const vec3 passed = candidateTransmittance(hit, hitGeometry().material, 1.0, gl_WorldRayDirectionEXT);\n"
      "  if (!blocksRay(payload, passed * passed)) ignoreIntersectionEXT;\n}\n";
  const std::pair<const char*, program::Program> wrong[] = {
      {"full weight behind panes", changed(keep, "path.bsdfPdf = 0.0;")},
      {"panes are scattering vertices", changed(keep, "path.lightContext.position = surface.position;")},
      {"shadow rays stop at panes", shadowed("", "")},
      {"shadow rays are tinted twice", shadowed("twice.rahit", twice)},
      {"weights of 1.3", changed("return a / (a + b);", "return a / (a + 0.7 * b);")},
  };
  const RenderedImage& naive = naiveOf(kOnePane);
  for (const auto& [name, program] : wrong) {
    const Verdict v = compareImages(renderPanes(kOnePane, program, kOnePane.batches), naive);
    std::printf("%s: %s\n", name, v.text.c_str());
    EXPECT_FALSE(v.same) << name << ": " << v.text;
  }
  const Verdict v =
      compareImages(renderPanes(kOneBounce, changed(keep, "path.depth++;"), kOneBounce.batches), naiveOf(kOneBounce));
  EXPECT_FALSE(v.same) << "panes are bounces: " << v.text;
}

}  // namespace
}  // namespace quintet::test
