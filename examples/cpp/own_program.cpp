// SPDX-License-Identifier: Apache-2.0
// Five shaders from a string, with a parameter; then the layers (AOVs) of the path tracer as arrays and in an OpenEXR file.
// Writes own_program_1.png, own_program_8.png and layers.exr.
#include <cstdio>
#include <exception>

#include <quintet/quintet.h>

// The lecture form (docs/lecture-form.md): comments with stars name the stages.
constexpr const char* kShaders = R"(
/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
/**** COMMON END ****/
/**** RAY GENERATION SHADER ****/
uniform float bands;  // defaultval="4" min="1" max="32" help="Number of bands per unit of distance"
void main() {
  vec2 point = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) * 2.0 - 1.0;
  vec3 direction = normalize(vec3(point * vec2(1.5, 1.0) * 0.5, -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 1.0, 6.0), 0.001, direction, 1e4, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
/**** CLOSEST-HIT SHADER ****/
void main() { payload.color = mix(vec3(0.1, 0.2, 0.6), vec3(1.0, 0.8, 0.3), fract(gl_HitTEXT * bands)); }
/**** MISS SHADER ****/
void main() { payload.color = vec3(0.02); }
)";

int main() try {
  const quintet::Program program = quintet::Program::fromSource(kShaders, "bands");
  for (const quintet::Diagnostic& diagnostic : quintet::checkProgram(program)) std::puts(diagnostic.format().c_str());
  const quintet::Scene scene = quintet::Scene::of(program);  // the built-in one

  quintet::prepareDrivers();  // before the process has other threads
  quintet::Device device;
  quintet::Renderer renderer(device, scene, program, {.width = 360, .height = 240});
  for (const char* bands : {"1", "8"}) {
    renderer.setParameter("bands", bands);
    renderer.render(1);
    renderer.image().write(std::string("own_program_") + bands + ".png");
  }

  quintet::Renderer pathTracer(device, scene, quintet::Program::load("pathtracer"),
                               {.width = 360, .height = 240, .outputs = {"albedo", "normal", "depth", "instance_id"}});
  pathTracer.render(16);
  const quintet::Film film = pathTracer.film();
  const quintet::Layer depth = film.layer("depth");      // floats, meters
  const quintet::Layer ids = film.layer("instance_id");  // 1 + the index of the instance; 0 where nothing was hit
  const std::size_t center = std::size_t{120} * depth.width + 180;
  std::printf("center: instance %u at %.2f m\n", ids.ids[center], static_cast<double>(depth.values[center]));
  film.write("layers.exr", {.layers = {"all"}});
} catch (const std::exception& error) {
  return std::fprintf(stderr, "own_program: %s\n", error.what()), 1;
}
