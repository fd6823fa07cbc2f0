#include "new_templates.h"

namespace quintet::app {
namespace {

constexpr const char* kLecture = R"(// Diffuse surfaces under a lamp, before a sky.
// All shaders of the program are in this file; a comment with stars says which stage a main() is.
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;  // what the ray sees; every closest-hit and miss shader writes it
};
/**** COMMON END ****/

/**** RAY GENERATION SHADER ****/
// Runs once per pixel. Row 0 is the bottom of the picture.
uniform float fov;  // defaultval="40" min="1" max="170" unit="deg" help="Vertical field of view"

void main() {
  // A camera that stands at `eye` and looks at `target`.
  vec3 eye = vec3(2.2, 2.6, 6.0);
  vec3 target = vec3(0.0, 0.8, 0.0);
  vec3 forward = normalize(target - eye);
  vec3 right = normalize(cross(forward, vec3(0.0, 1.0, 0.0)));
  vec3 up = cross(right, forward);

  // The pixel's centre, -1 ... 1 in both directions.
  vec2 size = vec2(gl_LaunchSizeEXT.xy);
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / size - 1.0;
  float height = tan(0.5 * radians(fov));
  vec3 direction = normalize(forward + point.x * height * size.x / size.y * right + point.y * height * up);

  // Flags, cull mask, hit record offset and stride, miss index, origin, tmin, direction, tmax, payload location.
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

/**** CLOSEST-HIT SHADER ****/
// Runs where a ray meets its nearest surface.
uniform vec3 surfaceColor;    // defaultval="0.9, 0.55, 0.2" help="Of every surface"
uniform vec3 lampDirection;   // defaultval="0.5, 1.0, 0.6" help="Towards the lamp, any length"

void main() {
  // The normals of the triangle's three vertices, between them by the barycentric coordinates, in the world.
  vec3 n0, n1, n2;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  vec3 objectNormal = n0 * (1.0 - baryCoord.x - baryCoord.y) + n1 * baryCoord.x + n2 * baryCoord.y;
  mat3 worldFromObjectNormal;
  gsnGetNormal3x3Matrix(gl_InstanceID, worldFromObjectNormal);
  vec3 normal = normalize(worldFromObjectNormal * objectNormal);

  // Lambert's cosine, and a little light from everywhere.
  float diffuse = max(dot(normal, normalize(lampDirection)), 0.0);
  payload.color = surfaceColor * (0.2 + 0.8 * diffuse);
}

/**** MISS SHADER ****/
// Runs where a ray meets nothing.
void main() {
  float height = 0.5 + 0.5 * normalize(gl_WorldRayDirectionEXT).y;
  payload.color = mix(vec3(0.95, 0.95, 0.9), vec3(0.4, 0.6, 0.9), height);
}
)";

constexpr const char* kToml = R"([program]
description = "Diffuse surfaces under a lamp, before a sky"
ray_generation = "main.rgen"

# A ray type: the miss shader belongs to it, and each hit group says what it runs for it.
[[ray]]
name = "primary"
miss = "sky.rmiss"

[[hit_group]]
name = "surface"
primary = { closest_hit = "surface.rchit" }

[[output]]
name = "color"

# Read as parameters.lamp in every shader; set by --set lamp=1,0,0.
[[parameter]]
name = "lamp"
type = "vec3"
default = [0.5, 1.0, 0.6]
help = "Towards the lamp, world space, any length"

[[parameter]]
name = "ambient"
type = "float"
default = 0.2
min = 0.0
max = 1.0
help = "Light from everywhere"
)";

constexpr const char* kPayload = R"(// What a ray brings back.
// Shaders that meet at run time must have the same type: so all of them include it.
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

// Runs once per pixel and sample; an output is a sum over the samples, which Quintet divides.
void main() {
  const uvec2 pixel = launchPixel();
  // Anywhere in the pixel, another place for each sample: smooth edges.
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

// Runs where a ray meets its nearest surface; `wo` points back to the viewer.
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

// Runs where a ray meets nothing.
void main() {
  const float height = 0.5 + 0.5 * gl_WorldRayDirectionEXT.y;
  payload.color = mix(vec3(0.9, 0.8, 0.7), vec3(0.3, 0.5, 0.9), height);
}
)";

}  // namespace

std::map<std::string, std::string> lectureTemplate(const std::string& file) { return {{file, kLecture}}; }

std::map<std::string, std::string> folderTemplate() {
  return {{"program.toml", kToml},
          {"payload.glsl", kPayload},
          {"main.rgen", kRayGeneration},
          {"surface.rchit", kClosestHit},
          {"sky.rmiss", kMiss}};
}

}  // namespace quintet::app
