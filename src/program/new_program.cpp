// SPDX-License-Identifier: Apache-2.0
#include "program/new_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "program/lecture/lecture.h"
#include "program/load.h"

namespace quintet::program {
namespace {

namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;  // relative path → text

constexpr const char* kLecture = R"(// Diffuse surfaces under a lamp, before a sky.
// All shaders of the program are in this file. A comment with stars names the stage of each main().
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;  // what the ray sees; every closest-hit and miss shader writes it
};
/**** COMMON END ****/

/**** RAY GENERATION SHADER ****/
// Runs once per pixel. Row 0 is the bottom of the image.
uniform float fov;  // defaultval="40" min="1" max="170" unit="deg" help="Vertical field of view"

void main() {
  // A camera at `eye` that looks at `target`.
  vec3 eye = vec3(2.2, 2.6, 6.0);
  vec3 target = vec3(0.0, 0.8, 0.0);
  vec3 forward = normalize(target - eye);
  vec3 right = normalize(cross(forward, vec3(0.0, 1.0, 0.0)));
  vec3 up = cross(right, forward);

  // The center of the pixel, -1 ... 1 in both directions.
  vec2 size = vec2(gl_LaunchSizeEXT.xy);
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / size - 1.0;
  float height = tan(0.5 * radians(fov));
  vec3 direction = normalize(forward + point.x * height * size.x / size.y * right + point.y * height * up);

  // Flags, cull mask, hit record offset and stride, miss index, origin, tmin, direction, tmax, payload location.
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

/**** CLOSEST-HIT SHADER ****/
// Runs at the closest hit of a ray.
uniform vec3 surfaceColor;    // defaultval="0.9, 0.55, 0.2" help="Color of all surfaces"
uniform vec3 lampDirection;   // defaultval="0.5, 1.0, 0.6" help="Direction to the lamp, any length"

void main() {
  // The vertex normals of the triangle, interpolated with the barycentric coordinates, in world space.
  vec3 n0, n1, n2;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  vec3 objectNormal = n0 * (1.0 - baryCoord.x - baryCoord.y) + n1 * baryCoord.x + n2 * baryCoord.y;
  mat3 worldFromObjectNormal;
  gsnGetNormal3x3Matrix(gl_InstanceID, worldFromObjectNormal);
  vec3 normal = normalize(worldFromObjectNormal * objectNormal);

  // Lambert's cosine, plus a little ambient light.
  float diffuse = max(dot(normal, normalize(lampDirection)), 0.0);
  payload.color = surfaceColor * (0.2 + 0.8 * diffuse);
}

/**** MISS SHADER ****/
// Runs for rays without a hit.
void main() {
  float height = 0.5 + 0.5 * normalize(gl_WorldRayDirectionEXT).y;
  payload.color = mix(vec3(0.95, 0.95, 0.9), vec3(0.4, 0.6, 0.9), height);
}
)";

constexpr const char* kToml = R"([program]
description = "Diffuse surfaces under a lamp, before a sky"
ray_generation = "main.rgen"

# A ray type. It has a miss shader, and each hit group names the shaders that it runs for this ray type.
[[ray]]
name = "primary"
miss = "sky.rmiss"

[[hit_group]]
name = "surface"
primary = { closest_hit = "surface.rchit" }

[[output]]
name = "color"

# Shaders read it as parameters.lamp; --set lamp=1,0,0 sets it.
[[parameter]]
name = "lamp"
type = "vec3"
default = [0.5, 1.0, 0.6]
help = "Direction to the lamp, world space, any length"

[[parameter]]
name = "ambient"
type = "float"
default = 0.2
min = 0.0
max = 1.0
help = "Ambient light"
)";

constexpr const char* kPayload =
    R"(// The payload of a ray. All shaders that run for a ray must use the same type, so all of them include this file.
struct Payload {
  vec3 color;  // linear radiance
};
)";

constexpr const char* kRayGeneration = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/camera.glsl>
#include <quintet/output.glsl>
#include <quintet/sampling/sobol.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT Payload payload;

// Runs once per pixel and sample. An output is a sum over the samples; Quintet divides it by their number.
void main() {
  const uvec2 pixel = launchPixel();
  // Each sample has its own position in the pixel, which gives smooth edges.
  Sampler rng = makeSampler(pixel, launch.firstSample, frame.seed);
  const Ray ray = cameraRay(vec2(pixel) + next2D(rng), vec2(0.5));
  payload.color = vec3(0.0);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary,
              ray.origin, 0.0, ray.direction, kInfinity, 0);
  storeOutput(kOutput_color, pixel, loadOutput(kOutput_color, pixel) + vec4(payload.color, 1.0));
}
)";

constexpr const char* kClosestHit = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
#include <quintet/material.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

// Runs at the closest hit of a ray. `wo` points to the viewer.
void main() {
  const vec3 wo = -gl_WorldRayDirectionEXT;
  const Surface surface = fetchSurface(triangleHit(baryCoord, 0u), wo);
  const Shading shading = shadeSurface(surface, wo);
  const float diffuse = max(dot(shading.normal, normalize(parameters.lamp)), 0.0);
  payload.color = shading.bsdf.baseColor * mix(diffuse, 1.0, parameters.ambient) + shading.emission;
}
)";

constexpr const char* kMiss = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;

// Runs for rays without a hit.
void main() {
  const float height = 0.5 + 0.5 * gl_WorldRayDirectionEXT.y;
  payload.color = mix(vec3(0.9, 0.8, 0.7), vec3(0.3, 0.5, 0.9), height);
}
)";

Files folderTemplate() {
  return {{"program.toml", kToml},
          {"payload.glsl", kPayload},
          {"main.rgen", kRayGeneration},
          {"surface.rchit", kClosestHit},
          {"sky.rmiss", kMiss}};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); !from.empty() && at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// Returns the lecture file under its new name and the files whose names the copied files mention.
Files copyOfLecture(const Program& source, const std::string& stem) {
  const std::string& main = source.descriptionFile;
  std::vector<std::string> open{main}, taken{main};
  if (!source.scene.empty()) open.push_back(source.scene), taken.push_back(source.scene);
  while (!open.empty()) {
    const std::string text = source.files.at(open.back());
    open.pop_back();
    for (const auto& [name, ignored] : source.files) {
      const bool generated = name.starts_with(main + ".");
      if (generated || std::ranges::find(taken, name) != taken.end() || text.find(name) == std::string::npos) continue;
      open.push_back(name);
      taken.push_back(name);
    }
  }
  // The scene gets the program's name, also where the text mentions it.
  const std::string ownScene = stem + ".scene.toml";
  Files files;
  for (const std::string& name : taken) {
    const std::string& text = source.files.at(name);
    if (name == main)
      files[stem + std::string(kLectureExtension)] = replaced(text, source.scene, ownScene);
    else
      files[name == source.scene ? ownScene : name] = text;
  }
  return files;
}

}  // namespace

NewProgram planNewProgram(const NewProgramOptions& options) {
  const fs::path normal = fs::path(options.name).lexically_normal();
  const fs::path path = normal.has_filename() ? normal : normal.parent_path();
  std::string stem = path.filename().string();
  if (stem.ends_with(kLectureExtension)) stem.resize(stem.size() - kLectureExtension.size());
  if (stem.empty() || stem == "." || stem == "..")
    throw UsageError(fmt::format("'{}' is not a valid name for a program", options.name));
  const fs::path folder = path.parent_path() / stem;
  const std::string file = stem + std::string(kLectureExtension);
  const fs::path shadowing = options.folder ? fs::path() : normal;
  if (options.from.empty())
    return options.folder ? NewProgram{folder, folderTemplate(), folder, {}}
                          : NewProgram{path.parent_path(), {{file, kLecture}}, path.parent_path() / file, shadowing};
  const Program source = loadProgram(options.from);
  if (!source.descriptionFile.ends_with(kLectureExtension)) return {folder, source.files, folder, {}};
  const fs::path home = options.folder ? folder : path.parent_path();
  return {home, copyOfLecture(source, stem), home / file, shadowing};
}

void createProgram(const NewProgram& program) {
  std::error_code failed;
  if (program.program == program.folder && fs::exists(program.folder, failed))
    throw FileError(program.folder, "already exists; choose a different name");
  for (const auto& [name, text] : program.files)
    if (fs::exists(program.folder / name, failed))
      throw FileError(program.folder / name, "already exists; choose a different name");
  if (!program.shadowing.empty() && fs::is_directory(program.shadowing, failed))
    throw FileError(program.shadowing, "is a folder; choose a different name");
  failed.clear();
  if (!program.folder.empty()) fs::create_directories(program.folder, failed);
  if (failed) throw FileError(program.folder, "cannot create the folder: " + failed.message());
  for (const auto& [name, text] : program.files) {
    const fs::path file = program.folder / name;
    if (fs::path(name).has_parent_path()) fs::create_directories(file.parent_path(), failed);
    writeFile(file, text);
  }
}

}  // namespace quintet::program
