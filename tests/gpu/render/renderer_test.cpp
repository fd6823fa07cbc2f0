// SPDX-License-Identifier: Apache-2.0
// Properties of a renderer besides correct images: bytes that do not depend on how the work is divided, regions,
// cancellation, and the location of errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "harness.h"
#include "job/device_limits.h"
#include "job/runnable_program.h"
#include "program/load.h"
#include "rendered_image.h"

namespace quintet::test {
namespace {

using testing::HasSubstr;

// A scene with glass, metal, alpha, two kinds of lights, and the sky.
SceneBuilder variedScene() {
  SceneBuilder scene;
  scene::Material metal, veil = unlit({0.2f, 0.9f, 0.4f}, 0.5f);
  metal.roughness = 0.4f;
  veil.alphaMode = scene::AlphaMode::blend;
  scene.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), lambert({0.6f, 0.5f, 0.4f}));
  scene.add(sphere({-0.6f, 0.5f, 0}, 0.5f, 2), metal).add(sphere({0.6f, 0.5f, 0}, 0.5f, 2), clearGlass(1.5f, 1.0f));
  scene.add(quad({-0.4f, 0.2f, 1}, {0.8f, 0, 0}, {0, 0.8f, 0}), veil);
  scene.add(quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}), emitter(vec3(8.0f)));
  scene::Light lamp;
  lamp.position = {1.0f, 2.0f, 1.0f};
  scene.light(lamp).sky(vec3(0.3f)).camera(perspective({0.5f, 1.5f, 3.0f}, {0, 0.4f, 0}, 40.0f));
  return scene;
}

struct Shared {
  SceneBuilder scene = variedScene();
  render::DeviceScene device{testContext(), scene::Scene(scene.scene), scene.environment};
  program::Program program = program::loadProgram("pathtracer");
  render::RenderSettings settings;

  Shared() {
    ImageOptions options;
    options.width = 20;
    options.height = 14;
    settings = settingsFor(scene.scene.cameras[0], options);
  }
  io::Image render(const render::RenderSettings& with, const std::vector<std::uint32_t>& batches = {4, 4, 3}) {
    render::Renderer renderer = makeRenderer(device, program, with);
    for (const std::uint32_t count : batches) renderer.renderBatch(count);
    return renderer.image();
  }
};

// The definitions are known before the scene is on the device, so that its program can be compiled in the meantime.
TEST(Renderer, RunsAProgramThatWasCompiledBeforeTheUpload) {
  Shared shared;
  const auto defines = [](const SceneBuilder& scene) {
    return render::shaderDefines(render::sceneFeatures(scene.scene, scene.environment), testContext().info().quirks);
  };
  ASSERT_EQ(defines(shared.scene), shared.device.defines());
  SceneBuilder dark = variedScene();
  dark.sky(vec3(0.0f));
  EXPECT_NE(defines(dark), shared.device.defines());

  program::CompiledProgram compiled =
      program::compile(shared.program, testCompiler(), render::renderDefines(defines(shared.scene), {}));
  compiled.seconds = 1234.0;
  job::CheckedProgram checked =
      job::checkCompiled(shared.program, compiled, shared.device.facts(), job::deviceLimits(testContext().info()));
  render::Renderer renderer(shared.device, std::move(checked.runnable), testCompiler(), nullptr, shared.settings);
  EXPECT_EQ(renderer.statistics().compileSeconds, 1234.0);
  for (const std::uint32_t count : {4u, 4u, 3u}) renderer.renderBatch(count);
  EXPECT_EQ(renderer.image().data, shared.render(shared.settings).data);
}

TEST(Renderer, DefinesRequestedOutputs) {
  const render::Defines defines =
      render::renderDefines({{"QUINTET_NO_PANES", "1"}}, {"depth", "ids"}, {{"SCALE", "2"}});
  const render::Defines expected{
      {"SCALE", "2"}, {"QUINTET_NO_PANES", "1"}, {"QUINTET_OUTPUT_depth", "1"}, {"QUINTET_OUTPUT_ids", "1"}};
  EXPECT_EQ(defines, expected);
}

TEST(Renderer, RendersTheSameBytesWithAllLaunchSizes) {
  Shared shared;
  const io::Image whole = shared.render(shared.settings);
  EXPECT_TRUE(std::any_of(whole.data.begin(), whole.data.end(), [](std::byte b) { return b != std::byte{0}; }));
  for (const double seconds : {1e-9, 1e9}) {
    render::RenderSettings settings = shared.settings;
    settings.launchSeconds = seconds;
    EXPECT_EQ(shared.render(settings).data, whole.data) << seconds;
  }
  for (const std::uint32_t samples : {1u, 3u}) {  // per launch
    shared.program.samplesPerLaunch = samples;
    EXPECT_EQ(shared.render(shared.settings).data, whole.data) << samples;
  }
}

TEST(Renderer, RendersTheSameBytesWithLaunchesInFlight) {
  Shared shared;
  const io::Image whole = shared.render(shared.settings);
  render::RenderSettings settings = shared.settings;
  settings.launchesInFlight = 2;
  settings.launchSeconds = 1e-9;  // a launch for each row and sample
  settings.profile = true;
  render::Renderer renderer = makeRenderer(shared.device, shared.program, settings);
  for (const std::uint32_t count : {4u, 4u, 3u}) renderer.renderBatch(count);
  EXPECT_LT(renderer.launches().size(), 11u * 14u);  // the last one is in flight
  renderer.finish();
  std::uint64_t rowSamples = 0;
  for (const render::LaunchTiming& launch : renderer.launches())
    rowSamples += std::uint64_t{launch.rows} * launch.samples;
  EXPECT_EQ(rowSamples, 11u * 14u);
  EXPECT_EQ(renderer.statistics().samples, 11u);
  EXPECT_EQ(renderer.image().data, whole.data);
}

// A canceled batch leaves the image of the earlier batches intact, and leaves nothing behind after a restart.
TEST(Renderer, CancelsABatchWithLaunchesInFlight) {
  Shared shared;
  render::RenderSettings settings = shared.settings;
  settings.launchesInFlight = 2;
  settings.launchSeconds = 1e-9;
  render::Renderer renderer = makeRenderer(shared.device, shared.program, settings);
  renderer.renderBatch();
  const io::Image before = renderer.image();
  EXPECT_FALSE(renderer.renderBatch(4, [](double) { return false; }));
  EXPECT_EQ(renderer.image().data, before.data);
  renderer.restart();
  renderer.renderBatch();
  EXPECT_EQ(renderer.image().data, before.data);
}

TEST(Renderer, RendersDifferentBytesWithADifferentSeed) {
  Shared shared;
  const io::Image first = shared.render(shared.settings);
  EXPECT_EQ(shared.render(shared.settings).data, first.data);
  render::RenderSettings settings = shared.settings;
  settings.seed = 2;
  EXPECT_NE(shared.render(settings).data, first.data);
}

// A launch covers all samples of a batch, or one sample of one row.
TEST(Renderer, RendersTheSameBytesWithAllLaunchSizesForEachProgram) {
  for (const char* name : {"ao", "naive", "normals"}) {
    Shared shared;
    shared.program = program::loadProgram(name);
    shared.settings.parameters = program::ParameterValues(shared.program.parameters);
    const io::Image whole = shared.render(shared.settings, {4, 3});
    render::RenderSettings settings = shared.settings;
    settings.launchSeconds = 1e-9;
    EXPECT_EQ(shared.render(settings, {4, 3}).data, whole.data) << name;
  }
}

// The paths are the same, because random numbers do not depend on which code is present. Only a compiler can round
// differently (lavapipe: 1.5e-8).
void expectSame(const RenderedImage& lean, const RenderedImage& full) {
  for (std::uint32_t y = 0; y < lean.height(); ++y)
    for (std::uint32_t x = 0; x < lean.width(); ++x)
      for (std::size_t c = 0; c < 4; ++c)
        EXPECT_NEAR(lean.at(x, y, c).mean(), full.at(x, y, c).mean(), 1e-5) << x << ' ' << y << " channel " << c;
}

// Unused materials add the shader code of their features (render/scene/scene_features.h).
TEST(Renderer, RendersTheSameWithCodeForUnusedFeatures) {
  ImageOptions options;
  options.batches = 4;
  SceneBuilder scene;
  scene::Material metal;
  metal.roughness = 0.4f;
  scene.add(sphere(vec3(0.0f), 1.0f, 2), metal)
      .add(quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}), lambert({0.6f, 0.5f, 0.4f}));
  scene.sky({0.5f, 0.6f, 0.7f}).camera(perspective({0, 0.5f, 4}, vec3(0.0f), 40.0f));
  const RenderedImage lean = renderImage(scene, options);
  scene.scene.materials.insert(scene.scene.materials.end(),
                               {clearGlass(1.5f, 1.0f), clearGlass(1.5f, 0.0f), emitter(vec3(1.0f))});
  scene.scene.materials.back().clearcoat = 1.0f;
  scene.scene.materials.back().sheenColor = vec3(1.0f);
  scene.scene.materials.back().diffuseTransmission = 0.5f;
  scene.scene.materials.back().anisotropy = 1.0f;
  scene.scene.materials.back().iridescence = 1.0f;
  scene.scene.materials[scene.scene.materials.size() - 3].dispersion = 1.0f;
  scene.scene.materials[scene.scene.materials.size() - 3].dielectricPriority = 1.0f;
  scene.scene.materials[scene.scene.materials.size() - 3].attenuationColor = vec3(0.5f);
  scene.scene.materials[scene.scene.materials.size() - 3].attenuationDistance = 1.0f;
  scene.scene.materials[scene.scene.materials.size() - 3].multiscatterColor = vec3(0.5f);
  expectSame(lean, renderImage(scene, options));
}

// The same for textures, vertex colors and alpha.
TEST(Renderer, RendersTheSameWithCodeForUnusedTextures) {
  ImageOptions options;
  options.batches = 8;
  SceneBuilder scene;
  scene.add(sphere(vec3(0.0f), 1.0f, 2), lambert({0.7f, 0.4f, 0.2f}))
      .add(quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}), lambert({0.6f, 0.5f, 0.4f}));
  scene.add(quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}), emitter(vec3(4.0f)));
  scene.sky({0.2f, 0.3f, 0.4f}).camera(perspective({0, 0.5f, 4}, vec3(0.0f), 40.0f));
  const RenderedImage lean = renderImage(scene, options);
  scene.scene.images.push_back({"gray", io::makeImage(1, 1, 4, io::PixelType::u8, io::ColorEncoding::sRgb)});
  scene.scene.textures.push_back({.name = "gray", .image = 0, .sampler = {}});
  scene::Material unused = clearGlass(1.5f, 1.0f);
  for (scene::TextureUse* use :
       {&unused.baseColorTexture, &unused.metallicRoughnessTexture, &unused.normalTexture, &unused.emissiveTexture,
        &unused.transmissionTexture, &unused.specularTexture, &unused.specularColorTexture})
    use->texture = 0;
  scene.scene.materials.push_back(unused);
  // An any-hit shader and vertex colors, on geometry that neither the camera nor light reaches.
  scene.add(quad({-3, -9, 3}, {6, 0, 0}, {0, 0, -6}), unlit({0.2f, 0.9f, 0.4f}, 0.5f));
  scene.scene.materials.back().alphaMode = scene::AlphaMode::blend;
  scene.scene.meshes.back().geometries[0].colors.assign(scene.scene.meshes.back().geometries[0].positions.size(),
                                                        vec4(1.0f));
  expectSame(lean, renderImage(scene, options));
}

TEST(Renderer, RendersARegionOfTheImage) {
  Shared shared;
  const io::Image whole = shared.render(shared.settings);
  for (const render::Region region : {render::Region{0, 0, 20, 14}, {3, 5, 7, 4}, {19, 13, 1, 1}}) {
    render::RenderSettings settings = shared.settings;
    settings.region = region;
    settings.launchSeconds = 1e-9;
    const io::Image part = shared.render(settings);
    ASSERT_EQ(part.width, region.width);
    ASSERT_EQ(part.height, region.height);
    std::size_t wrong = 0;
    for (std::uint32_t y = 0; y < region.height; ++y)
      for (std::uint32_t x = 0; x < region.width; ++x)
        wrong += !std::ranges::equal(part.pixel<float>(x, y), whole.pixel<float>(region.x + x, region.y + y));
    EXPECT_EQ(wrong, 0u);
  }
}

TEST(Renderer, RejectsInvalidRegionsAndSizes) {
  Shared shared;
  for (const render::Region region :
       {render::Region{20, 0, 1, 1}, {0, 0, 21, 1}, {10, 10, 5, 5}, {0, 0, 0, 3}, {1, 0, 0xFFFFFFFFu, 1}}) {
    render::RenderSettings settings = shared.settings;
    settings.region = region;
    try {
      shared.render(settings);
      ADD_FAILURE() << region.x << "," << region.y << "," << region.width << "," << region.height;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("is not inside the image of 20x14"));
    }
  }
  render::RenderSettings settings = shared.settings;
  settings.width = 0;
  EXPECT_THROW(shared.render(settings), UsageError);
}

TEST(Renderer, ReportsTheLocationOfAProgramError) {
  Shared shared;
  shared.program = program::loadProgram("normals");
  shared.settings.parameters = program::ParameterValues(shared.program.parameters);
  std::string& text = shared.program.files.at("normals.rgen");
  const std::size_t at = text.find("void main()");
  ASSERT_NE(at, std::string::npos);
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  text.insert(at, "vec3 broken() { return nothing; }\n");
  try {
    shared.render(shared.settings);
    FAIL();
  } catch (const ProgramError& error) {
    ASSERT_FALSE(error.diagnostics().empty());
    EXPECT_EQ(error.diagnostics()[0].file, "<programs/normals>/normals.rgen");
    EXPECT_EQ(error.diagnostics()[0].line, line);
    EXPECT_THAT(error.what(), HasSubstr("<programs/normals>/normals.rgen:" + std::to_string(line)));
    EXPECT_THAT(error.what(), HasSubstr("nothing"));
  }
}

TEST(Renderer, CountsSamplesAndStopsOnRequest) {
  Shared shared;
  shared.settings.launchSeconds = 1e-9;  // a row at a time
  render::Renderer renderer = makeRenderer(shared.device, shared.program, shared.settings);
  EXPECT_TRUE(renderer.renderBatch());
  EXPECT_TRUE(renderer.renderBatch(2));
  EXPECT_EQ(renderer.statistics().samples, 6u);
  EXPECT_EQ(renderer.statistics().batches, 2u);
  EXPECT_GE(renderer.rays().rays, 6u * 20u * 14u);  // one camera ray each
  EXPECT_EQ(renderer.rays().droppedSamples, 0u);
  const io::Image before = renderer.image();
  std::vector<double> seen;
  EXPECT_FALSE(renderer.renderBatch(4, [&](double done) {
    seen.push_back(done);
    return false;
  }));
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_GT(seen[0], 0.0);
  EXPECT_LT(seen[0], 1.0);
  EXPECT_EQ(renderer.statistics().samples, 6u);
  // A batch whose last row is in flight can no longer be canceled.
  EXPECT_TRUE(renderer.renderBatch(4, [](double done) { return done < 1.0; }));
  EXPECT_EQ(renderer.statistics().samples, 10u);
}

TEST(BuiltInProgram, NormalsShowsTheNormalAsColor) {
  SceneBuilder scene;
  scene.add(quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), lambert(vec3(0.5f)), glm::rotate(mat4(1.0f), 0.5f, vec3(0, 1, 0)));
  scene.camera(orthographic({0, 0, 0.2f}, vec3(0.0f), 0.05f));
  ImageOptions options;
  options.program = program::loadProgram("normals");
  options.batches = 2;
  expectUniform(renderImage(scene, options),
                vec4(0.5f + 0.5f * std::sin(0.5f), 0.5f, 0.5f + 0.5f * std::cos(0.5f), 1.0f), {.error = 1e-5});
}

// Seen from a plane, a parallel square of side 2 at height 1 hides a part of the hemisphere that is its form factor.
TEST(BuiltInProgram, AoShowsTheOpenPartOfTheHemisphere) {
  SceneBuilder scene;
  scene.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), lambert(vec3(0.5f)));
  scene.add(quad({-1, 1, 1}, {2, 0, 0}, {0, 0, -2}), lambert(vec3(0.5f)));
  scene.camera(orthographic({0, 0.5f, 0}, vec3(0.0f), 0.001f));
  ImageOptions options;
  options.program = program::loadProgram("ao");
  options.batches = 32;
  const float hidden = 4.0f / (kPi * std::sqrt(2.0f)) * std::atan(1.0f / std::sqrt(2.0f));
  expectUniform(renderImage(scene, options), vec4(vec3(1.0f - hidden), 1.0f), {.error = 0.01, .rounding = 1e-4});
  options.set = {"distance=0.9"};
  expectUniform(renderImage(scene, options), vec4(1.0f), {.error = 1e-5});
}

// A wall at one side hides half of the sky, a low one less: the directions must cover all azimuths evenly.
TEST(BuiltInProgram, AoTracesAroundTheNormalEvenly) {
  for (const float height : {1000.0f, 1.0f}) {
    for (const float turn : {0.3f, 1.9f, 3.5f, 5.1f}) {
      SCOPED_TRACE(testing::Message() << height << " " << turn);
      const mat4 turned = glm::rotate(mat4(1.0f), turn, glm::normalize(vec3(0.2f, 1.0f, -0.4f)));
      const vec3 up = turned * vec4(0, 1, 0, 0);
      SceneBuilder scene;
      scene.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), lambert(vec3(0.5f)), turned);
      scene.add(quad({1, 0, -5000}, {0, 0, 10000}, {0, height, 0}), lambert(vec3(0.5f)), turned);
      scene.camera(orthographic(0.2f * up, vec3(0.0f), 0.001f));
      ImageOptions options;
      options.program = program::loadProgram("ao");
      options.batches = 32;
      // The form factor of a strip of infinite length at the distance 1.
      const float hidden = 0.5f * (1.0f - 1.0f / std::sqrt(1.0f + height * height));
      expectUniform(renderImage(scene, options), vec4(vec3(1.0f - hidden), 1.0f), {.error = 0.01, .rounding = 1e-3});
    }
  }
}

TEST(BuiltInProgram, AoHasABackground) {
  SceneBuilder scene;
  scene.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), lambert(vec3(0.5f)))
      .camera(orthographic(vec3(9, 0, 3), vec3(9, 0, 0), 0.05f));
  ImageOptions options;
  options.program = program::loadProgram("ao");
  options.batches = 2;
  options.set = {"background=0.25,0.5,0.75"};
  expectUniform(renderImage(scene, options), vec4(0.25f, 0.5f, 0.75f, 1.0f));
  options.transparent = true;
  expectUniform(renderImage(scene, options), vec4(0.0f));
}

// A panel covers the part of the image left of x = 3.5 and above y = 4.5 pixels, and so half of the pixels at its edges; what
// is around it is black.
TEST(BuiltInProgram, EachOneShowsPixelsAtTheirPositions) {
  const vec2 corner(3.5f, 4.5f);
  const std::pair<const char*, vec3> programs[] = {
      {"ao", vec3(1.0f)}, {"naive", vec3(0.25f, 0.5f, 0.75f)}, {"normals", vec3(0.5f, 0.5f, 1.0f)}};
  for (const auto& [name, color] : programs) {
    SCOPED_TRACE(name);
    SceneBuilder scene;  // 8 pixels are 8 m
    scene.add(quad({-9, 4 - corner.y, 0}, {9 - 4 + corner.x, 0, 0}, {0, 9, 0}), emitter(vec3(0.25f, 0.5f, 0.75f)));
    scene.camera(orthographic({0, 0, 9}, vec3(0.0f), 4.0f));
    ImageOptions options;
    options.program = program::loadProgram(name);
    options.batches = 64;
    if (name == std::string("ao")) options.set = {"background=0,0,0"};
    expectPixels(
        renderImage(scene, options),
        [&, color = color](vec2 pixel) { return pixel.x < corner.x && pixel.y < corner.y ? color : vec3(0.0f); },
        {.error = 0.01, .rounding = 1e-3});
  }
}

TEST(BuiltInProgram, NaiveHasATransparentBackground) {
  SceneBuilder scene;
  scene.add(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), lambert(vec3(0.5f)))
      .sky(vec3(1.0f))
      .camera(orthographic(vec3(9, 0, 3), vec3(9, 0, 0), 0.05f));
  ImageOptions options;
  options.program = program::loadProgram("naive");
  options.batches = 2;
  expectUniform(renderImage(scene, options), vec4(1.0f));
  options.transparent = true;
  expectUniform(renderImage(scene, options), vec4(0.0f));
}

}  // namespace
}  // namespace quintet::test
