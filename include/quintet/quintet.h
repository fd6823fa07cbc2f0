// SPDX-License-Identifier: Apache-2.0
// Quintet's C++ API: a scene, a program of ray tracing shaders and a device give an image.
//
//   quintet::Device device;
//   quintet::Renderer renderer(device, quintet::Scene::load("scene.glb"), quintet::Program::load("pathtracer"));
//   renderer.render(64);
//   renderer.image().write("scene.png");
//
// Conventions. Lengths are in meters, angles in radians. Frames are right-handed with y up; a camera looks along its -z
// axis. Images are linear with Rec. 709 primaries, rows from the top. Failures are exceptions of quintet/error.h.
// Objects are movable; use an object from one thread at a time. The library never prints and never exits.
#ifndef QUINTET_QUINTET_H
#define QUINTET_QUINTET_H

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <quintet/diagnostic.h>
#include <quintet/error.h>

namespace quintet {

struct DeviceOptions {
  // Index, or part of the name ("h200", "lavapipe", "cpu"). Empty means $QUINTET_DEVICE, else the best device.
  std::string choice;
  std::filesystem::path cacheFolder;                  // for compiled shaders and pipelines; empty disables the caches
  std::function<void(const std::string&)> onWarning;  // of the driver; called from any thread; may be empty
};

// A Vulkan device that supports ray tracing. It must outlive the renderers that use it.
class Device {
 public:
  // Throws Error if no device can be used; the message says why for each one.
  explicit Device(const DeviceOptions& options = {});
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;
  ~Device();
  std::string name() const;    // "NVIDIA H200"
  std::string driver() const;  // "lavapipe 25.0.7 (LLVM 15.0.6)"

 private:
  friend class Renderer;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class Program;

// A scene in host memory. Copies share their data.
class Scene {
 public:
  // Reads glTF (.gltf, .glb) or .scene.toml. Throws FileError, MemoryError.
  static Scene load(const std::filesystem::path& file);
  // Returns the program's own scene, else a small built-in one with geometry that its hit groups support.
  static Scene of(const Program& program);
  std::string name() const;  // of the file
  std::size_t instanceCount() const;
  std::size_t cameraCount() const;
  std::array<std::array<float, 3>, 2> bounds() const;  // world space, min and max; min > max for an empty scene

 private:
  friend class Renderer;
  friend std::vector<Diagnostic> checkProgram(const Program&, const Scene*);
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

struct ParameterInfo {
  std::string name;
  std::string type;          // "bool", "int", "float", "vec2", "vec3", "vec4", "color", …: docs/programs.md
  std::string defaultValue;  // in the form of Settings::parameters
  double min = 0, max = 0;   // of each component, inclusive
  std::string unit;
  std::string help;
};

// Ray tracing shaders and the description that connects them. Copies share their data. Shaders are compiled by Renderer.
class Program {
 public:
  // Reads a folder with program.toml, a .rt.glsl file, or the built-in program of this name. Throws FileError, UsageError.
  static Program load(const std::string& nameOrPath);
  static std::vector<std::string> builtIn();  // names
  std::string name() const;
  std::string description() const;
  std::vector<ParameterInfo> parameters() const;
  std::vector<std::string> outputs() const;

 private:
  friend class Renderer;
  friend class Scene;
  friend std::vector<Diagnostic> checkProgram(const Program&, const Scene*);
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

// Compiles and links a program without a device and returns every mismatch, with the ids of docs/diagnostics. A scene adds
// the rules that depend on it. Renderer checks the same and throws if there are errors.
std::vector<Diagnostic> checkProgram(const Program& program, const Scene* scene = nullptr);

struct Camera {
  std::array<float, 3> lookFrom{0, 0, 5};  // world space, meters
  std::array<float, 3> lookAt{0, 0, 0};    // also the point in focus
  std::array<float, 3> up{0, 1, 0};
  float verticalFov = 0.7854f;  // radians, (0, pi)
  float apertureRadius = 0;     // meters; 0 is a pinhole camera
};

struct Settings {
  std::uint32_t width = 1280;  // pixels, [1, 65536]
  std::uint32_t height = 720;
  std::uint32_t seed = 0;        // of the random number generator
  std::optional<Camera> camera;  // default: the scene's first camera, else one that shows the whole scene
  std::vector<std::pair<std::string, std::string>> parameters;  // name, value as on the command line ("1,0.5,0")
};

// RGBA floats, linear, premultiplied, rows from the top.
struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> pixels;  // 4 * width * height
  bool toneMap = true;        // .png: Khronos PBR Neutral before the sRGB curve; false if values are not radiance
  std::array<float, 4> at(std::uint32_t x, std::uint32_t y) const;  // (0, 0) is the top left; throws UsageError
  // Writes .png (sRGB, 8 bits), .exr (half, linear) or .hdr in one step. Throws FileError, UsageError.
  void write(const std::filesystem::path& file) const;
};

// Renders a scene with a program.
class Renderer {
 public:
  // Uploads the scene, then compiles, checks and links the program. `device` must outlive the renderer. Throws
  // ProgramError, UsageError, MemoryError, Error.
  Renderer(Device& device, const Scene& scene, const Program& program, const Settings& settings = {});
  Renderer(Renderer&&) noexcept;
  ~Renderer();

  // Adds `count` samples per pixel; multiples of 4 are fastest. A program that accumulates frames itself renders `count`
  // frames.
  void render(std::uint32_t count);
  std::uint64_t sampleCount() const;  // per pixel, or frames, so far
  // Returns the mean of the samples so far, or the last frame. An empty name means the first output. Throws UsageError for
  // an output that the program does not have or that was not rendered.
  Image image(const std::string& output = "") const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet
#endif
