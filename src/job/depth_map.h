// SPDX-License-Identifier: Apache-2.0
// The depth of the first surface at each pixel, for lines that are drawn over an image.
#ifndef QUINTET_JOB_DEPTH_MAP_H
#define QUINTET_JOB_DEPTH_MAP_H

#include <vector>

#include "job/engine.h"
#include "job/render_job.h"
#include "program/description/program.h"
#include "render/scene/device_scene.h"
#include "scene/model/scene.h"

namespace quintet::job {

struct DepthMap {
  uvec2 size{0};              // pixels
  scene::Camera camera;       // of the image
  std::vector<float> depths;  // rows from the top; meters along the camera's axis, > 0; 0 without a surface
};

// Traces the rays through the centers of pixels and lens (the program `pick`). `size`: of the whole image. `shown`: the
// program for which the scene is prepared, so that the scene need not be prepared again. Boxes with a surface that only
// a program knows have the depth of the box. Blocks. Throws ProgramError, gpu errors and TimeoutError.
DepthMap renderDepthMap(Engine& engine, render::DeviceScene& scene, const scene::Camera& camera, uvec2 size,
                        const program::Program& shown);

// Of the image of a job that has rendered: at its frame; with a shutter, in the middle of its interval, where the camera of
// the job is.
DepthMap renderDepthMap(Engine& engine, RenderJob& job);

}  // namespace quintet::job
#endif
