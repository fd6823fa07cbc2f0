// From options to what is rendered: which camera looks, and what light surrounds the scene.
#ifndef QUINTET_APP_SCENE_SETUP_H
#define QUINTET_APP_SCENE_SETUP_H

#include <filesystem>
#include <optional>
#include <string>

#include "scene/scene.h"

namespace quintet::app {

struct CameraOptions {
  std::string camera;            // index or name in the file; empty: the first
  std::optional<vec3> lookFrom;  // world
  std::optional<vec3> lookAt;
  vec3 up{0, 1, 0};
  std::optional<float> fov;       // vertical, degrees
  std::optional<float> aperture;  // lens radius, metres
  std::optional<float> focus;     // metres along the axis
};

struct ChosenCamera {
  scene::Camera camera;
  std::string description;  // "camera 0 'Main'", "automatic", "--look-from"
};

// --look-from > --camera > the file's first > automatic. `aspect`: width / height of the image, 0: not
// decided yet. Throws UsageError.
ChosenCamera chooseCamera(const scene::Scene& scene, const CameraOptions& options, float aspect);

// 1280 pixels for the longer side where the camera states an aspect, else 1280x720. A width without a
// height keeps the same aspect.
uvec2 chooseSize(uvec2 asked, const scene::Camera& camera);

struct EnvironmentOptions {
  std::string source;  // a file, "none", "default", "r,g,b"; empty: decide
  std::optional<float> intensity;
  std::optional<float> rotation;  // degrees about +y, counter-clockwise seen from above
};

struct ChosenEnvironment {
  scene::Environment environment;
  std::string description;  // for metadata: "sky.hdr", "default", "none", "of the scene"
  bool isDefault = false;   // taken because nothing in the scene gives light
};

// --env > the scene's > the default if nothing in the scene gives light > none. Throws FileError, UsageError.
ChosenEnvironment chooseEnvironment(const scene::Scene& scene, const EnvironmentOptions& options);

}  // namespace quintet::app
#endif
