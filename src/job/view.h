// SPDX-License-Identifier: Apache-2.0
// How the scene is seen: camera, image size and environment, chosen from the request and the scene.
#ifndef QUINTET_JOB_VIEW_H
#define QUINTET_JOB_VIEW_H

#include <optional>
#include <string>

#include "base/math.h"
#include "job/request.h"
#include "scene/defaults/default_environment.h"
#include "scene/model/scene.h"

namespace quintet::job {

struct CameraChoice {
  scene::Camera camera;
  std::string description;  // for metadata: "camera 0 'Main'", "automatic", "look-from"
};

// lookFrom, else the named camera, else the scene's first, else an automatic one that shows the whole scene. `aspect`:
// width / height of the image; 0 if it is not known yet. `bounds`: those of the scene if they are known. Throws UsageError.
CameraChoice chooseCamera(const scene::Scene& scene, const CameraRequest& request, float aspect,
                          const std::optional<Bounds3>& bounds = {});

// 1280 pixels for the longer side if the camera states an aspect ratio, else 1280x720. A width without a height keeps
// the same aspect ratio.
uvec2 chooseImageSize(uvec2 requested, const scene::Camera& camera);

struct EnvironmentChoice {
  scene::Environment environment;
  std::string description;  // for metadata: "sky.hdr", "default", "none", "of the scene"
  // Set if neither the request nor the scene names an environment: the light of the scene, which decides.
  std::optional<scene::OwnLight> decidedBy;
  std::string repair = {};  // "sky.exr: 1 pixel is …": what was changed in the image of the request; else empty
  // Before adjust().
  float sourceIntensity = 1;
  float sourceRotation = 0;  // radians

  // The default environment, used because the scene does not light itself.
  bool isFallback() const { return decidedBy && scene::needsEnvironment(*decidedBy); }
};

// The requested one, else the scene's, else the default one if the scene does not light itself, else none. `maxMemory`: bytes
// that the file of the environment can request (scene::LoadOptions). Throws FileError, MemoryError, UsageError.
EnvironmentChoice chooseEnvironment(const scene::Scene& scene, const EnvironmentRequest& request,
                                    std::size_t maxMemory = 0);

// Sets intensity and rotation for a request with the same source.
void adjust(EnvironmentChoice& choice, const EnvironmentRequest& request);

}  // namespace quintet::job
#endif
