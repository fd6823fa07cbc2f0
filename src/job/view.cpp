// SPDX-License-Identifier: Apache-2.0
#include "job/view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/parse.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "io/codec.h"
#include "scene/defaults/auto_camera.h"
#include "scene/model/limits.h"
#include "scene/model/names.h"

namespace quintet::job {
namespace {

constexpr std::uint32_t kDefaultWidth = 1280;
constexpr std::uint32_t kDefaultHeight = 720;
constexpr float kDefaultAspect = static_cast<float>(kDefaultWidth) / static_cast<float>(kDefaultHeight);

std::string describe(const scene::Scene& scene, std::size_t index) {
  const std::string& name = scene.cameras[index].name;
  return name.empty() ? fmt::format("camera {}", index) : fmt::format("camera {} '{}'", index, name);
}

constexpr std::size_t kListedCameras = 20;

// "0 'Main', 1 'Side' (node 'Camera.001'), 2"
std::string listOfCameras(const scene::Scene& scene) {
  std::vector<std::string> entries;
  for (std::size_t i = 0; i < std::min(scene.cameras.size(), kListedCameras); ++i) {
    const auto& [name, nodeName] = std::tie(scene.cameras[i].name, scene.cameras[i].nodeName);
    entries.push_back(fmt::format("{}{}{}", i, name.empty() ? "" : fmt::format(" '{}'", name),
                                  nodeName.empty() || nodeName == name ? "" : fmt::format(" (node '{}')", nodeName)));
  }
  if (scene.cameras.size() > kListedCameras)
    entries.push_back(fmt::format("and {} more", scene.cameras.size() - kListedCameras));
  return printable(fmt::format("{}", fmt::join(entries, ", ")));
}

// By the name of the camera, else of its node, else by index.
std::size_t findCamera(const scene::Scene& scene, const std::string& wanted) {
  std::vector<std::string> names;
  for (const auto name : {&scene::Camera::name, &scene::Camera::nodeName}) {
    if (const auto found = std::ranges::find(scene.cameras, wanted, name); found != scene.cameras.end())
      return static_cast<std::size_t>(found - scene.cameras.begin());
    std::ranges::transform(scene.cameras, std::back_inserter(names), name);
  }
  std::erase(names, "");
  std::size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, error] = std::from_chars(wanted.data(), end, index);
  const bool isIndex = error == std::errc{} && stop == end;
  if (isIndex && index < scene.cameras.size()) return index;
  if (scene.cameras.empty())
    throw UsageError(fmt::format("camera '{}' not found: {} has no cameras", wanted, scene::nameForMessages(scene)));
  throw UsageError(fmt::format("camera '{}' not found in {}{}; available: {}", wanted, scene::nameForMessages(scene),
                               isIndex ? "" : suggestion(wanted, names), listOfCameras(scene)));
}

// Computing them takes a while for a large scene.
class LazyBounds {
 public:
  LazyBounds(const scene::Scene& scene, const std::optional<Bounds3>& known) : scene_(scene), bounds_(known) {}
  const Bounds3& operator()() {
    if (!bounds_) bounds_ = scene::worldBounds(scene_);
    return *bounds_;
  }

 private:
  const scene::Scene& scene_;
  std::optional<Bounds3> bounds_;
};

scene::Camera lookAtCamera(const CameraRequest& request, LazyBounds& bounds) {
  const vec3 eye = *request.lookFrom;
  const vec3 target = request.lookAt ? *request.lookAt : bounds().empty() ? vec3(0.0f) : bounds().center();
  if (!(glm::length(target - eye) > 0.0f)) throw UsageError("look-from and look-at are the same point");
  if (!(glm::length(request.up) > 0.0f)) throw UsageError("the up vector has length 0");
  return scene::lookAtCamera(eye, target, request.up, scene::Camera().verticalFov, 0.0f);
}

// Distance of the scene's center along the optical axis.
float distanceTo(const Bounds3& bounds, const scene::Camera& camera) {
  if (bounds.empty()) return camera.focusDistance;
  const vec3 eye(camera.worldFromCamera[3]);
  const float distance = glm::dot(bounds.center() - eye, -vec3(camera.worldFromCamera[2]));
  return distance > 0.0f ? distance : camera.focusDistance;
}

// `repair`: what was changed in the image.
scene::Environment readEnvironment(const std::string& source, std::size_t maxMemory, std::string& repair) {
  scene::Environment environment;
  environment.name = source;
  environment.present = true;
  const bool isColor = source.find(',') != std::string::npos && !std::filesystem::exists(source);
  if (!isColor) {
    MemoryBudget budget(source, maxMemory);
    environment.image = io::readRadiance(source, budget);
    repair = scene::repairTexels(environment.image);
    return environment;
  }
  const std::optional<vec3> color = parseVec3(source);
  if (!color) throw UsageError(fmt::format("environment: '{}' is not three numbers like 1,2.5,3", printable(source)));
  if (glm::any(glm::lessThan(*color, vec3(0.0f))))
    throw UsageError(fmt::format("environment: '{}' has a negative radiance", source));
  if (!glm::all(glm::lessThanEqual(*color, vec3(scene::kMaxRadiance))))
    throw UsageError(
        fmt::format("environment: '{}' is too bright; at most {:g} in each channel", source, scene::kMaxRadiance));
  environment.constant = *color;
  return environment;
}

}  // namespace

CameraChoice chooseCamera(const scene::Scene& scene, const CameraRequest& request, float aspect,
                          const std::optional<Bounds3>& known) {
  if (request.lookAt && !request.lookFrom) throw UsageError("look-at requires look-from");
  if (request.lookFrom && !request.name.empty()) throw UsageError("camera and look-from exclude each other");
  LazyBounds bounds(scene, known);
  CameraChoice chosen;
  if (request.lookFrom) {
    chosen = {lookAtCamera(request, bounds), "look-from"};
  } else if (!request.name.empty() || !scene.cameras.empty()) {
    const std::size_t index = request.name.empty() ? 0 : findCamera(scene, request.name);
    chosen = {scene.cameras[index], describe(scene, index)};
  } else {
    chosen = {scene::frameScene(bounds(), aspect > 0.0f ? aspect : kDefaultAspect), "automatic"};
  }
  scene::Camera& camera = chosen.camera;
  if (request.verticalFov) {
    if (camera.orthographic)
      throw UsageError(fmt::format("the field of view does not apply: {} is orthographic", chosen.description));
    camera.verticalFov = glm::radians(*request.verticalFov);
  }
  if (request.apertureRadius) camera.apertureRadius = *request.apertureRadius;
  if (request.focusDistance) {
    camera.focusDistance = *request.focusDistance;
  } else if (request.apertureRadius && !request.lookFrom) {
    camera.focusDistance = distanceTo(bounds(), camera);
  }
  return chosen;
}

uvec2 chooseImageSize(uvec2 requested, const scene::Camera& camera) {
  if (requested.x > 0 && requested.y > 0) return requested;
  const float aspect = camera.aspect > 0.0f ? std::clamp(camera.aspect, 1e-3f, 1e3f) : kDefaultAspect;
  const auto rounded = [](float pixels) {
    return static_cast<std::uint32_t>(std::clamp(std::round(pixels), 1.0f, static_cast<float>(io::kMaxImageSide)));
  };
  if (requested.x > 0) return {requested.x, rounded(static_cast<float>(requested.x) / aspect)};
  return aspect >= 1.0f ? uvec2{kDefaultWidth, rounded(kDefaultWidth / aspect)}
                        : uvec2{rounded(kDefaultWidth * aspect), kDefaultWidth};
}

EnvironmentChoice chooseEnvironment(const scene::Scene& scene, const EnvironmentRequest& request,
                                    std::size_t maxMemory) {
  EnvironmentChoice chosen;
  if (request.source == "none") {
    chosen.environment.present = true;
    chosen.description = "none";
  } else if (request.source == "default") {
    chosen = {scene::defaultEnvironment(), "default"};
  } else if (!request.source.empty()) {
    std::string repair;
    chosen = {readEnvironment(request.source, maxMemory, repair), request.source};
    if (!repair.empty()) chosen.repair = fmt::format("{}: {}", printable(request.source), repair);
  } else if (scene.environment.present) {
    chosen = {scene.environment, "of the scene"};
  } else {
    const scene::OwnLight light = scene::ownLight(scene);
    if (scene::needsEnvironment(light)) chosen.environment = scene::defaultEnvironment();
    chosen.description = scene::needsEnvironment(light) ? "default" : "none";
    chosen.decidedBy = light;
  }
  chosen.sourceIntensity = chosen.environment.intensity;
  chosen.sourceRotation = chosen.environment.rotation;
  adjust(chosen, request);
  return chosen;
}

void adjust(EnvironmentChoice& choice, const EnvironmentRequest& request) {
  scene::Environment& environment = choice.environment;
  environment.intensity = choice.sourceIntensity;
  environment.rotation = choice.sourceRotation;
  environment.animatedIntensityFactor = request.intensity.value_or(1.0f);
  environment.animatedRotationOffset = glm::radians(request.rotation.value_or(0.0f));
  if (request.intensity) environment.intensity *= *request.intensity;
  if (request.rotation) environment.rotation += glm::radians(*request.rotation);
}

}  // namespace quintet::job
