// SPDX-License-Identifier: Apache-2.0
// quintet_animation_rate: what a frame of a skinned animation costs, and whether later frames cost more than the first.
//
// A generated limb, a tube with 100,000 triangles, bends along a chain of 32 joints with two sets of weights, and two of
// its morph targets swell it. Each frame is shown and traced with one sample per pixel. The table has the median of all
// frames for each step, the device time of the passes, and the cost of the last tenth of the frames divided by that of
// the first tenth. The output is one JSON object with --json.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/stopwatch.h"
#include "gpu/driver_environment.h"
#include "job/device_limits.h"
#include "job/engine.h"
#include "job/runnable_program.h"
#include "job/view.h"
#include "program/load.h"
#include "render/renderer/renderer.h"
#include "scene/animation/pose.h"

namespace quintet::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kTargets = 4;  // morph targets, of which two move
constexpr float kLength = 4.0f;      // of the limb, meters

struct Options {
  std::string program = "pathtracer", device;
  std::size_t triangles = 100000, joints = 32;
  std::uint32_t width = 1280, height = 720, frames = 60;
  bool host = false, json = false;
};

// ---- The limb ----

// Nodes 0 to joints - 1 form a chain along y, each bending about z; the last node has the mesh.
scene::NodeAnimation limbAnimation(const Options& options) {
  scene::NodeAnimation animation;
  const float step = kLength / static_cast<float>(options.joints);
  scene::Skin skin;
  const auto addChannel = [&](std::size_t node, scene::AnimatedProperty property, scene::AnimationSampler sampler) {
    animation.animation.samplers.push_back(std::move(sampler));
    animation.animation.channels.push_back({static_cast<int>(node), property, animation.animation.samplers.size() - 1});
  };
  const double seconds = options.frames / animation.framesPerSecond;
  for (std::size_t j = 0; j < options.joints; ++j) {
    scene::AnimationNode& node = animation.nodes.emplace_back();
    node.parent = static_cast<int>(j) - 1;
    node.translation = {0, j == 0 ? 0 : step, 0};
    scene::AnimationSampler bend;
    bend.valueSize = 4;
    for (int key = 0; key <= 4; ++key) {
      const float angle = 0.06f * std::sin(1.57f * static_cast<float>(key) + 0.2f * static_cast<float>(j));
      bend.times.push_back(static_cast<float>(seconds * key / 4));
      for (const float value : {0.0f, 0.0f, std::sin(0.5f * angle), std::cos(0.5f * angle)})
        bend.values.push_back(value);
    }
    addChannel(j, scene::AnimatedProperty::rotation, bend);
    skin.joints.push_back(static_cast<int>(j));
    mat4 inverseBind(1.0f);
    inverseBind[3].y = -step * static_cast<float>(j);
    skin.inverseBindMatrices.push_back(inverseBind);
  }
  animation.nodes.emplace_back().weights.assign(kTargets, 0.0f);
  scene::AnimationSampler swell;
  swell.valueSize = kTargets;
  for (int key = 0; key <= 4; ++key) {
    const auto wave = [&](float shift) { return 0.5f + 0.5f * std::sin(1.57f * static_cast<float>(key) + shift); };
    swell.times.push_back(static_cast<float>(seconds * key / 4));
    swell.values.insert(swell.values.end(), {wave(0), 0.0f, wave(2), 0.0f});
  }
  addChannel(options.joints, scene::AnimatedProperty::weights, swell);
  for (std::size_t i = 0; i < animation.nodes.size(); ++i) animation.order.push_back(static_cast<int>(i));
  animation.skins.push_back(std::move(skin));
  return animation;
}

// Four joints of set `set`: those around a position along the chain, with weights that decrease with the distance.
void addInfluences(scene::SkinSet& influences, int set, float along, std::size_t joints) {
  glm::u16vec4& of = influences.joints.emplace_back();
  vec4& weights = influences.weights.emplace_back();
  for (glm::length_t c = 0; c < 4; ++c) {
    const float joint = std::floor(along * static_cast<float>(joints)) - 3.0f + static_cast<float>(4 * set + c);
    const float clamped = std::clamp(joint, 0.0f, static_cast<float>(joints - 1));
    of[c] = static_cast<std::uint16_t>(clamped);
    weights[c] = std::exp(-std::abs(along * static_cast<float>(joints) - clamped - 0.5f));
  }
}

void addVertex(scene::Geometry& geometry, scene::GeometryDeformation& deformation, vec2 uv, std::size_t joints) {
  const float angle = 2.0f * kPi * uv.x;
  const vec3 outward(std::cos(angle), 0.0f, std::sin(angle));
  const float radius = 0.35f + 0.1f * std::sin(9.0f * uv.y);
  geometry.positions.push_back(radius * outward + vec3(0, kLength * uv.y, 0));
  geometry.normals.push_back(outward);
  geometry.tangents.emplace_back(-outward.z, 0.0f, outward.x, 1.0f);
  for (std::size_t t = 0; t < kTargets; ++t) {
    const float bump = std::exp(-40.0f * std::pow(uv.y - 0.2f * static_cast<float>(t + 1), 2.0f));
    deformation.targets[t].positions.push_back(0.15f * bump * outward);
    deformation.targets[t].normals.push_back(vec3(0, 0.3f * bump, 0));
  }
  for (int set = 0; set < 2; ++set)
    addInfluences(deformation.skinSets[static_cast<std::size_t>(set)], set, uv.y, joints);
}

scene::Scene limb(const Options& options) {
  const auto around = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(options.triangles) / 8.0));
  const auto along = static_cast<std::uint32_t>(options.triangles / (2 * around));
  scene::Scene scene;
  scene.nodeAnimation = std::make_shared<scene::NodeAnimation>(limbAnimation(options));
  scene.materials.emplace_back().metallic = 0.0f;
  scene::Mesh& mesh = scene.meshes.emplace_back();
  auto deformation = std::make_shared<scene::MeshDeformation>();
  deformation->node = static_cast<int>(options.joints);
  deformation->skin = 0;
  scene::GeometryDeformation& deformed = deformation->geometries.emplace_back();
  deformed.targets.resize(kTargets);
  deformed.skinSets.resize(2);
  scene::Geometry& geometry = mesh.geometries.emplace_back();
  geometry.material = 0;
  for (std::uint32_t y = 0; y <= along; ++y)
    for (std::uint32_t x = 0; x <= around; ++x) {
      addVertex(geometry, deformed, vec2(x, y) / vec2(around, along), options.joints);
      if (x == 0 || y == 0) continue;
      const std::uint32_t corner = y * (around + 1) + x, below = corner - around - 1;
      geometry.triangles.push_back({below - 1, corner, below});
      geometry.triangles.push_back({below - 1, corner - 1, corner});
    }
  deformed.positions = geometry.positions;
  deformed.normals = geometry.normals;
  deformed.tangents = geometry.tangents;
  mesh.deformation = std::move(deformation);
  scene.instances.emplace_back().mesh = 0;
  scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), 0.0));
  return scene;
}

// ---- The measurement ----

// Seconds of one frame.
struct FrameTimes {
  double pose = 0, deform = 0, cost = 0, refit = 0, build = 0, topLevel = 0, show = 0, trace = 0, total = 0;
};

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

class Measurement {
 public:
  explicit Measurement(const Options& options)
      : options_(options), engine_({.device = options.device, .log = {}}), scene_(limb(options)) {
    const program::Program program = program::loadProgram(options.program);
    const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
    render::RenderSettings settings;
    settings.width = options.width;
    settings.height = options.height;
    settings.camera = job::chooseCamera(scene_, {}, aspect).camera;
    settings.parameters = program::ParameterValues(program.parameters);
    settings.timeoutSeconds = 300;
    settings.profile = true;
    const scene::Environment environment = job::chooseEnvironment(scene_, {}).environment;
    triangles_ = scene_.meshes[0].geometries[0].triangles.size();
    device_ = std::make_unique<render::DeviceScene>(engine_.context(), scene::Scene(scene_), environment,
                                                    render::DeviceSceneOptions{.compiler = &engine_.compiler()});
    job::CheckedProgram checked =
        job::compileAndCheck(program, engine_.compiler(), render::renderDefines(device_->defines(), {}),
                             device_->facts(), job::deviceLimits(engine_.context().info()));
    renderer_ = std::make_unique<render::Renderer>(*device_, std::move(checked.runnable), engine_.compiler(), nullptr,
                                                   settings);
  }

  Json run() {
    measureFrame(0.5);  // the driver compiles in the first frame
    const std::uint64_t memory = engine_.context().memory().now;
    std::vector<FrameTimes> frames;
    for (std::uint32_t i = 1; i <= options_.frames; ++i) frames.push_back(measureFrame(i));
    const render::DeformationStatistics statistics = device_->deformationStatistics();
    Json json;
    json["device"] = engine_.context().info().name;
    json["driver"] = engine_.context().info().driver;
    json["triangles"] = triangles_;
    json["vertices"] = scene_.meshes[0].geometries[0].positions.size();
    json["joints"] = options_.joints;
    json["width"] = options_.width;
    json["height"] = options_.height;
    json["frames"] = options_.frames;
    const auto add = [&](const char* name, double FrameTimes::*step) {
      addStep(json["milliseconds"][name], frames, step);
    };
    add("pose", &FrameTimes::pose);
    add("deform", &FrameTimes::deform);
    add("quality", &FrameTimes::cost);
    add("refit", &FrameTimes::refit);
    add("build", &FrameTimes::build);
    add("topLevel", &FrameTimes::topLevel);
    add("show", &FrameTimes::show);
    add("trace", &FrameTimes::trace);
    add("frame", &FrameTimes::total);
    json["refits"] = statistics.refits;
    json["builds"] = statistics.builds;
    json["memoryGrowthBytes"] =
        static_cast<std::int64_t>(engine_.context().memory().now) - static_cast<std::int64_t>(memory);
    if (options_.host) json["hostDeformMilliseconds"] = hostMilliseconds();
    return json;
  }

 private:
  FrameTimes measureFrame(double frame) {
    const render::DeformationStatistics before = device_->deformationStatistics();
    const double topLevel = device_->frameStatistics().topLevelSeconds;
    FrameTimes times;
    Stopwatch watch;
    device_->setFrame(frame);
    times.show = watch.lap();
    renderer_->restart();
    const std::size_t launches = renderer_->launches().size();
    renderer_->renderBatch(1);
    renderer_->finish();
    times.total = watch.seconds();
    for (std::size_t i = launches; i < renderer_->launches().size(); ++i)
      times.trace += renderer_->launches()[i].traceSeconds;
    const render::DeformationStatistics after = device_->deformationStatistics();
    times.pose = after.poseSeconds - before.poseSeconds;
    times.deform = after.deformSeconds - before.deformSeconds;
    times.cost = after.costSeconds - before.costSeconds;
    times.refit = after.refitSeconds - before.refitSeconds;
    times.build = after.buildSeconds - before.buildSeconds;
    times.topLevel = device_->frameStatistics().topLevelSeconds - topLevel;
    return times;
  }

  // Median of all frames, and the ratio of the last tenth to the first tenth.
  void addStep(Json& json, const std::vector<FrameTimes>& frames, double FrameTimes::*step) const {
    std::vector<double> all;
    for (const FrameTimes& frame : frames) all.push_back(frame.*step);
    const std::size_t tenth = std::max<std::size_t>(1, all.size() / 10);
    const double first = median({all.begin(), all.begin() + static_cast<std::ptrdiff_t>(tenth)});
    const double last = median({all.end() - static_cast<std::ptrdiff_t>(tenth), all.end()});
    json["median"] = std::round(median(all) * 1e6) * 1e-3;
    json["lastToFirst"] = first > 0 ? std::round(100 * last / first) / 100 : 0.0;
  }

  // The same vertices on the host (scene::deformGeometry), median of five frames.
  double hostMilliseconds() const {
    std::vector<double> seconds;
    scene::Geometry geometry = scene_.meshes[0].geometries[0];
    for (int i = 1; i <= 5; ++i) {
      const scene::Pose pose = scene::poseAt(scene_.nodeAnimation.get(), i);
      const Stopwatch watch;
      scene::deformGeometry(*scene_.meshes[0].deformation, 0, *scene_.nodeAnimation, pose, geometry);
      seconds.push_back(watch.seconds());
    }
    return std::round(median(seconds) * 1e6) * 1e-3;
  }

  const Options& options_;
  job::Engine engine_;
  scene::Scene scene_;
  std::size_t triangles_ = 0;
  std::unique_ptr<render::DeviceScene> device_;
  std::unique_ptr<render::Renderer> renderer_;
};

void printTable(const Json& json) {
  fmt::print("{}, {}: {} triangles, {} joints, {} frames of {}x{}\n\n", json["device"].get<std::string>(),
             json["driver"].get<std::string>(), json["triangles"].get<std::size_t>(), json["joints"].get<std::size_t>(),
             json["frames"].get<std::uint32_t>(), json["width"].get<std::uint32_t>(),
             json["height"].get<std::uint32_t>());
  fmt::print("| step | ms per frame | last tenth / first tenth |\n| --- | --- | --- |\n");
  for (const auto& [name, step] : json["milliseconds"].items())
    fmt::print("| {} | {:.3f} | {:.2f} |\n", name, step["median"].get<double>(), step["lastToFirst"].get<double>());
  fmt::print("\n{} refits, {} builds, {} bytes of memory growth\n", json["refits"].get<std::uint64_t>(),
             json["builds"].get<std::uint64_t>(), json["memoryGrowthBytes"].get<std::int64_t>());
  if (json.contains("hostDeformMilliseconds"))
    fmt::print("The same deformation on the host: {:.3f} ms\n", json["hostDeformMilliseconds"].get<double>());
}

}  // namespace
}  // namespace quintet::bench

int main(int argc, char** argv) {
  using namespace quintet;
  bench::Options options;
  CLI::App app("Measures what a frame of a skinned animation costs.");
  app.add_option("--program", options.program, "Program")->capture_default_str();
  app.add_option("--triangles", options.triangles, "Approximate number of triangles")
      ->check(CLI::Range(1000, 100000000))
      ->capture_default_str();
  app.add_option("--joints", options.joints, "Number of joints")->check(CLI::Range(1, 65535))->capture_default_str();
  app.add_option("--frames", options.frames, "Number of frames")->check(CLI::Range(10, 100000))->capture_default_str();
  app.add_option("--width", options.width, "Width in pixels")->capture_default_str();
  app.add_option("--height", options.height, "Height in pixels")->capture_default_str();
  app.add_option("--device", options.device, "Device, as in 'quintet render'");
  app.add_flag("--host", options.host, "Measure the deformation on the host, too");
  app.add_flag("--json", options.json, "Print a JSON object instead of a table");
  CLI11_PARSE(app, argc, argv);
  try {
    gpu::prepareDriverEnvironment();
    const bench::Json json = bench::Measurement(options).run();
    if (options.json)
      fmt::print("{}\n", json.dump(2));
    else
      bench::printTable(json);
  } catch (const std::exception& error) {
    fmt::print(stderr, "quintet_animation_rate: {}\n", error.what());
    return 1;
  }
  return 0;
}
