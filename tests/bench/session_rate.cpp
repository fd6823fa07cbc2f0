// SPDX-License-Identifier: Apache-2.0
// quintet_session_rate SCENE: how fast an interactive session answers, without a window.
//
// While the camera orbits, it counts images per second, from the command to the image in host memory for display. Then
// it makes each kind of edit several times while the image is refined, and measures the time from the command to the
// next image, and how often the program is compiled. It also measures how long an interruption of the refinement waits,
// how long picking takes, and how long the rays of an explained pixel take to draw. The output is one JSON object.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/stopwatch.h"
#include "gpu/driver_environment.h"
#include "gpu/image.h"
#include "gpu/present/line_renderer.h"
#include "gpu/timer.h"
#include "job/interactive/light_properties.h"
#include "job/interactive/session.h"
#include "overlay/ray_overlay.h"
#include "overlay/window_shaders.h"

namespace quintet::bench {
namespace {

using namespace job::interactive;
using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, device, program = "pathtracer", environment;
  std::uint32_t width = 800, height = 500;
  double seconds = 5;  // of orbiting
  int repeat = 7;      // of each edit
};

// Counts compilations.
class Host : public job::Observer {
 public:
  void stage(const std::string& text) override { compilations += text.starts_with("compiling") ? 1 : 0; }
  int compilations = 0;
};

double quantile(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1) + 0.5)];
}

double milliseconds(double seconds) { return std::round(seconds * 1e5) * 1e-2; }

class Measurement {
 public:
  explicit Measurement(const Options& options) : options_(options), engine_({.device = options.device, .log = {}}) {
    job::RenderRequest request;
    request.scene = options.scene;
    request.size = {options.width, options.height};
    request.environment.source = options.environment;
    request.limits.samples = 1u << 20;  // it never completes
    session_ = std::make_unique<Session>(
        engine_, SessionRequest{options.program, request}, [this] { return clock_.seconds(); }, host_);
  }

  Json run() {
    Json json;
    json["device"] = engine_.context().info().name;
    json["scene"] = options_.scene;
    json["program"] = options_.program;
    json["width"] = options_.width;
    json["height"] = options_.height;
    nextImage();
    json["firstImageSeconds"] = std::round(clock_.seconds() * 1e3) * 1e-3;
    json["orbit"] = orbitRate();
    json["edits"] = edits();
    json["interruptionMilliseconds"] = interruption();
    json["pickMilliseconds"] = picking();
    json["explanation"] = explanation();
    return json;
  }

 private:
  // Renders until there is an image, and reads it for display.
  ImageUpdated nextImage() {
    for (;;) {
      for (const Event& event : session_->step(0)) {
        if (const auto* failed = std::get_if<Failed>(&event)) throw Error(failed->message);
        if (const auto* image = std::get_if<ImageUpdated>(&event)) {
          shown_ = session_->image();
          return *image;
        }
      }
      if (session_->secondsUntilWork() == std::numeric_limits<double>::infinity())
        throw Error("the session has nothing to render");
    }
  }

  Json orbitRate() {
    for (int i = 0; i < 10; ++i) nextImageAfter(Orbit{1, 0});  // adapts the resolution
    std::vector<double> seconds, factors;
    const int compilations = host_.compilations;
    const Stopwatch total;
    while (total.seconds() < options_.seconds) {
      const Stopwatch watch;
      factors.push_back(nextImageAfter(Orbit{1, 0}).factor);
      seconds.push_back(watch.seconds());
    }
    return {{"updatesPerSecond", std::round(10 * static_cast<double>(seconds.size()) / total.seconds()) * 0.1},
            {"medianMilliseconds", milliseconds(quantile(seconds, 0.5))},
            {"slowestOf100Milliseconds", milliseconds(quantile(seconds, 0.99))},
            {"medianFactor", quantile(factors, 0.5)},
            {"compilations", host_.compilations - compilations}};
  }

  ImageUpdated nextImageAfter(const Command& command) {
    session_->apply(command);
    return nextImage();
  }

  // A kind of edit: the command of repetition i.
  using Edit = std::function<Command(int)>;

  void addEdit(Json& json, const char* name, const Edit& edit) {
    std::vector<double> seconds;
    session_->apply(edit(0));  // the first one can require shader code that the scene did not need
    nextImage();
    const int compilations = host_.compilations;
    for (int i = 1; i <= options_.repeat; ++i) {
      const double end = clock_.seconds() + 0.5;
      while (clock_.seconds() < end) session_->step(0.05, [&] { return clock_.seconds() > end; });
      const Stopwatch watch;
      nextImageAfter(edit(i));
      seconds.push_back(watch.seconds());
    }
    session_->apply(Undo{});  // one step
    json[name] = {{"medianMilliseconds", milliseconds(quantile(seconds, 0.5))},
                  {"slowestMilliseconds", milliseconds(quantile(seconds, 1))},
                  {"compilations", host_.compilations - compilations}};
  }

  // The material with emission, else the one of the fewest triangles: lamps are small.
  std::size_t lampMaterial() const {
    const scene::Scene& scene = session_->scene();
    std::vector<std::size_t> triangles(scene.materials.size(), 0);
    for (const scene::Instance& instance : scene.instances)
      for (const scene::Geometry& geometry : scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries)
        if (geometry.material != scene::kNone)
          triangles[static_cast<std::size_t>(geometry.material)] += geometry.triangles.size();
    std::size_t best = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (scene.materials[i].emissive != vec3(0.0f)) return i;
      if (triangles[i] > 0 && (triangles[best] == 0 || triangles[i] < triangles[best])) best = i;
    }
    return best;
  }

  Json edits() {
    Json json = Json::object();
    const scene::Scene& scene = session_->scene();
    const auto between = [](int i) { return 0.3 + 0.05 * i; };
    addEdit(json, "camera", [](int i) { return Command(Orbit{static_cast<float>(i), 0}); });
    if (!scene.materials.empty()) {
      const std::string material = session_->materialNames().front();
      addEdit(json, "material", [=](int i) {
        return Command(EditMaterial{material, {{"baseColor", {between(i), 0.5, 0.4}}, {"roughness", {between(i)}}}});
      });
      addEdit(json, "emission", [=, lamp = session_->materialNames()[lampMaterial()]](int i) {
        return Command(EditMaterial{lamp, {{"emissive", {between(i), 0.1, 0.1}}}});
      });
    }
    if (!scene.lights.empty())
      addEdit(json, "light", [&](int i) {
        return Command(EditLight{session_->lightNames().front(), {{"intensity", {10 * between(i)}}}});
      });
    addEdit(json, "environment", [](int i) {
      return Command(
          SetEnvironment{.source = {}, .intensity = {}, .rotation = 10.0f * static_cast<float>(i), .on = {}});
    });
    const auto still = std::ranges::find_if(scene.instances, [](const auto& i) { return i.keyframes.empty(); });
    if (still != scene.instances.end()) {
      const auto index = static_cast<std::size_t>(still - scene.instances.begin());
      addEdit(json, "transform", [this, name = session_->instanceNames()[index]](int i) {
        return Command(Move{name, {0, i % 2 == 0 ? 0.02f : -0.02f, 0}});
      });
    }
    const auto number = std::ranges::find_if(session_->program().parameters, [](const program::Parameter& p) {
      return p.type == program::ParameterType::integer && p.max >= 20;
    });
    if (number != session_->program().parameters.end())
      addEdit(json, "parameter", [name = number->name](int i) {
        return Command(SetParameter{name, std::to_string(12 + i % 2)});
      });
    addEdit(json, "exposure", [](int i) { return Command(SetExposure{0.1 * i}); });
    return json;
  }

  // How long step() continues after it was interrupted during refinement.
  Json interruption() {
    std::vector<double> seconds;
    for (int i = 0; i < options_.repeat; ++i) {
      nextImageAfter(Orbit{1, 0});
      const double end = clock_.seconds() + 0.7 + 0.03 * i;
      while (clock_.seconds() < end) session_->step(1, [&] { return clock_.seconds() > end; });
      seconds.push_back(clock_.seconds() - end);
    }
    return {{"median", milliseconds(quantile(seconds, 0.5))}, {"slowest", milliseconds(quantile(seconds, 1))}};
  }

  Json picking() {
    std::vector<double> seconds;
    for (int i = 0; i <= options_.repeat; ++i) {
      const Stopwatch watch;
      session_->pick(
          {options_.width * static_cast<std::uint32_t>(i + 1) / (static_cast<std::uint32_t>(options_.repeat) + 2),
           options_.height / 2});
      seconds.push_back(watch.seconds());
    }
    const double first = seconds.front();
    seconds.erase(seconds.begin());
    return {{"first", milliseconds(first)}, {"median", milliseconds(quantile(seconds, 0.5))}};
  }

  // Of 25 pixels, explains the one with the most rays, and draws its rays over the image.
  Json explanation() {
    session_->explain({0, 0}, 0);  // compiles the instrumented program
    overlay::RayOverlay paths;
    std::vector<double> explainSeconds;
    for (std::uint32_t i = 0; i < 25; ++i) {
      const Stopwatch watch;
      const job::PixelExplanation explained =
          session_->explain(uvec2(options_.width, options_.height) * uvec2(i % 5 + 1, i / 5 + 1) / 6u, 0);
      explainSeconds.push_back(watch.seconds());
      overlay::RayOverlay rays = overlay::rayOverlay(explained, 1.0f);
      if (rays.rays.size() > paths.rays.size()) paths = std::move(rays);
    }
    session_->depthMap();  // compiles its program
    const Stopwatch depthWatch;
    const job::DepthMap depth = session_->depthMap();
    const double depthSeconds = depthWatch.seconds();
    const overlay::OverlayView view{session_->camera(), {.origin = {}, .size = {options_.width, options_.height}}};
    std::vector<double> seconds;
    gpu::LineList list;
    for (int i = 0; i < options_.repeat; ++i) {
      const Stopwatch lines;
      list = overlay::overlayLines(paths, view, {}, &depth);
      seconds.push_back(lines.seconds());
    }
    return {{"explainMilliseconds", milliseconds(quantile(explainSeconds, 0.5))},
            {"depthMapMilliseconds", milliseconds(depthSeconds)},
            {"rays", paths.rays.size()},
            {"lines", list.lines.size()},
            {"linesHostMilliseconds", milliseconds(quantile(seconds, 0.5))},
            {"linesDeviceMilliseconds", milliseconds(drawingSeconds(list, depth))}};
  }

  // Device time of the lines over an image of the size of the session, median.
  double drawingSeconds(const gpu::LineList& list, const job::DepthMap& depth) {
    gpu::Context& context = engine_.context();
    const overlay::WindowShaders shaders = overlay::compileLineShaders(job::EngineOptions().caches);
    constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_UNORM;
    gpu::LineRenderer renderer(context, kFormat, shaders.vertex, shaders.fragment);
    renderer.setDepth({depth.size.x, depth.size.y}, overlay::reversedDepths(depth));
    const gpu::Image target(context, {.width = options_.width,
                                      .height = options_.height,
                                      .format = kFormat,
                                      .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                      .name = "benchmark of lines"});
    gpu::Timer timer(context, 2);
    std::vector<double> seconds;
    for (int i = 0; i < options_.repeat; ++i) {
      context.submitAndWait([&](gpu::Commands& commands) {
        commands.transition(target, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        timer.reset(commands);
        timer.mark(commands, 0);
        renderer.draw(commands, target, list, VK_ATTACHMENT_LOAD_OP_CLEAR);
        timer.mark(commands, 1);
      });
      seconds.push_back(timer.seconds(0, 1));
    }
    return quantile(seconds, 0.5);
  }

  const Options& options_;
  const Stopwatch clock_;
  job::Engine engine_;
  Host host_;
  std::unique_ptr<Session> session_;
  io::Image shown_;
};

}  // namespace
}  // namespace quintet::bench

int main(int argc, char** argv) {
  using namespace quintet;
  bench::Options options;
  CLI::App app("Measures how fast an interactive session answers.");
  app.add_option("SCENE", options.scene, "Scene file")->required();
  app.add_option("--program", options.program, "Program (default: pathtracer)");
  app.add_option("--env", options.environment, "Environment, as in 'quintet render'");
  app.add_option("--width", options.width, "Width in pixels (default: 800)");
  app.add_option("--height", options.height, "Height in pixels (default: 500)");
  app.add_option("--device", options.device, "Device, as in 'quintet render'");
  app.add_option("--seconds", options.seconds, "Duration of orbiting in seconds (default: 5)");
  app.add_option("--repeat", options.repeat, "Repetitions of each edit (default: 7)")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    gpu::prepareDriverEnvironment();
    fmt::print("{}\n", bench::Measurement(options).run().dump(2));
  } catch (const std::exception& error) {
    fmt::print(stderr, "quintet_session_rate: {}\n", error.what());
    return 1;
  }
  return 0;
}
