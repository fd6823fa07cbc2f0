#include "scene_setup.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "io/codec.h"
#include "scene/auto_camera.h"
#include "scene/default_environment.h"
#include "values.h"

namespace quintet::app {
namespace {

constexpr std::uint32_t kDefaultWidth = 1280;
constexpr std::uint32_t kDefaultHeight = 720;
constexpr float kDefaultAspect = static_cast<float>(kDefaultWidth) / static_cast<float>(kDefaultHeight);

std::string describe(const scene::Scene& scene, std::size_t index) {
  const std::string& name = scene.cameras[index].name;
  return name.empty() ? fmt::format("camera {}", index) : fmt::format("camera {} '{}'", index, name);
}

std::size_t findCamera(const scene::Scene& scene, const std::string& wanted) {
  std::vector<std::string> names;
  for (const scene::Camera& camera : scene.cameras) names.push_back(camera.name);
  if (const auto found = std::ranges::find(names, wanted); found != names.end())
    return static_cast<std::size_t>(found - names.begin());
  std::size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, error] = std::from_chars(wanted.data(), end, index);
  const bool isIndex = error == std::errc{} && stop == end;
  if (isIndex && index < names.size()) return index;
  if (names.empty()) throw UsageError(fmt::format("--camera: {} has no cameras", scene.name));
  throw UsageError(fmt::format("--camera: {} has no camera '{}'{}; it has {}", scene.name, wanted,
                               isIndex ? "" : suggestion(wanted, names),
                               names.size() == 1 ? "one, 0" : fmt::format("0 to {}", names.size() - 1)));
}

scene::Camera lookingCamera(const scene::Scene& scene, const CameraOptions& options) {
  const Bounds3 bounds = scene::worldBounds(scene);
  const vec3 eye = *options.lookFrom;
  const vec3 target = options.lookAt ? *options.lookAt : bounds.empty() ? vec3(0.0f) : bounds.center();
  const vec3 way = target - eye;
  if (!(glm::length(way) > 0.0f)) throw UsageError("--look-from and --look-at are the same point");
  if (!(glm::length(options.up) > 0.0f)) throw UsageError("--up: the vector has no length");
  return scene::lookAtCamera(eye, target, options.up, scene::Camera().verticalFov, 0.0f);
}

// In front of the camera, where the middle of the scene is.
float distanceToScene(const scene::Scene& scene, const scene::Camera& camera) {
  const Bounds3 bounds = scene::worldBounds(scene);
  if (bounds.empty()) return camera.focusDistance;
  const vec3 eye(camera.worldFromCamera[3]);
  const float distance = glm::dot(bounds.center() - eye, -vec3(camera.worldFromCamera[2]));
  return distance > 0.0f ? distance : camera.focusDistance;
}

scene::Environment readEnvironment(const std::string& source) {
  scene::Environment environment;
  environment.name = source;
  environment.present = true;
  const bool isColor = source.find(',') != std::string::npos && !std::filesystem::exists(source);
  if (isColor) {
    environment.constant = parseVec3("--env", source);
    if (glm::any(glm::lessThan(environment.constant, vec3(0.0f))))
      throw UsageError(fmt::format("--env: '{}' has a negative radiance", source));
  } else {
    environment.image = io::toFloat(io::readImage(source));
  }
  return environment;
}

}  // namespace

ChosenCamera chooseCamera(const scene::Scene& scene, const CameraOptions& options, float aspect) {
  ChosenCamera chosen;
  if (options.lookAt && !options.lookFrom) throw UsageError("--look-at needs --look-from");
  if (options.lookFrom && !options.camera.empty()) throw UsageError("--camera and --look-from exclude each other");
  if (options.lookFrom) {
    chosen = {lookingCamera(scene, options), "--look-from"};
  } else if (!options.camera.empty() || !scene.cameras.empty()) {
    const std::size_t index = options.camera.empty() ? 0 : findCamera(scene, options.camera);
    chosen = {scene.cameras[index], describe(scene, index)};
  } else {
    chosen = {scene::frameScene(scene::worldBounds(scene), aspect > 0.0f ? aspect : kDefaultAspect), "automatic"};
  }
  scene::Camera& camera = chosen.camera;
  if (options.fov) {
    if (camera.orthographic) throw UsageError(fmt::format("--fov: {} is orthographic", chosen.description));
    camera.verticalFov = glm::radians(*options.fov);
  }
  if (options.aperture) camera.apertureRadius = *options.aperture;
  if (options.focus) {
    camera.focusDistance = *options.focus;
  } else if (options.aperture && !options.lookFrom) {
    camera.focusDistance = distanceToScene(scene, camera);
  }
  return chosen;
}

uvec2 chooseSize(uvec2 asked, const scene::Camera& camera) {
  if (asked.x > 0 && asked.y > 0) return asked;
  const float aspect = camera.aspect > 0.0f ? std::clamp(camera.aspect, 1e-3f, 1e3f) : kDefaultAspect;
  const auto rounded = [](float pixels) {
    return static_cast<std::uint32_t>(std::clamp(std::round(pixels), 1.0f, static_cast<float>(kMaxSide)));
  };
  if (asked.x > 0) return {asked.x, rounded(static_cast<float>(asked.x) / aspect)};
  return aspect >= 1.0f ? uvec2{kDefaultWidth, rounded(kDefaultWidth / aspect)}
                        : uvec2{rounded(kDefaultWidth * aspect), kDefaultWidth};
}

ChosenEnvironment chooseEnvironment(const scene::Scene& scene, const EnvironmentOptions& options) {
  ChosenEnvironment chosen;
  if (options.source == "none") {
    chosen.environment.present = true;
    chosen.description = "none";
  } else if (options.source == "default") {
    chosen = {scene::defaultEnvironment(), "default"};
  } else if (!options.source.empty()) {
    chosen = {readEnvironment(options.source), options.source};
  } else if (scene.environment.present) {
    chosen = {scene.environment, "of the scene"};
  } else if (!scene::givesLight(scene)) {
    chosen = {scene::defaultEnvironment(), "default", true};
  } else {
    chosen.description = "none";
  }
  if (options.intensity) chosen.environment.intensity *= *options.intensity;
  if (options.rotation) chosen.environment.rotation += glm::radians(*options.rotation);
  return chosen;
}

}  // namespace quintet::app
