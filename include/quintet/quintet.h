// Quintet's C++ API: a scene, a program of ray tracing shaders, a device; out comes a picture.
//
//   quintet::Device device;
//   quintet::Renderer renderer(device, quintet::Scene::load("scene.glb"), quintet::Program::load("pathtracer"));
//   renderer.render(64);
//   renderer.picture().write("scene.png");
//
// Conventions. Units are metres and radians; frames are right-handed with y up; a camera looks along its -z.
// Pictures are linear, Rec. 709 primaries, rows from the top. What the world refuses (a file, a device, memory, a
// shader) is an exception of quintet/error.h whose what() is one line with file and place. Objects are movable;
// none may be used from two threads at once. The library prints nothing and never exits.
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

#include <quintet/error.h>

namespace quintet {

// What the compiler or the check of the linked pipeline has to say.
struct Diagnostic {
  enum class Severity { note, warning, error };
  Severity severity = Severity::error;
  std::string file;
  int line = 0;    // from 1; 0: unknown
  int column = 0;  // from 1; 0: unknown
  std::string id;  // "GLSL", "Q101", …: docs/diagnostics
  std::string text;
  std::string format() const;  // "file:line:column: error: text [id]"
};

// A program whose shaders do not compile, or do not fit together. what(): the first error's line.
class ProgramError : public Error {
 public:
  explicit ProgramError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

struct DeviceOptions {
  std::string choice;  // index, or part of the name ("h200", "lavapipe", "cpu"); empty: $QUINTET_DEVICE, else the best
  std::filesystem::path cacheFolder;                  // compiled shaders and pipelines; empty: not kept
  std::function<void(const std::string&)> onWarning;  // of the driver; called from any thread; empty: dropped
};

// A Vulkan device that can trace rays. Outlives the renderers made with it.
class Device {
 public:
  explicit Device(const DeviceOptions& options = {});  // throws Error, with each device's refusal, if none fits
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

// A scene in host memory: glTF (.gltf, .glb) or .scene.toml. Copies share their data.
class Scene {
 public:
  static Scene load(const std::filesystem::path& file);  // throws FileError
  // The scene that the program brings, else a small built-in one that its shaders can meet.
  static Scene of(const Program& program);
  std::string name() const;  // the file's
  std::size_t instanceCount() const;
  std::size_t cameraCount() const;
  std::array<std::array<float, 3>, 2> bounds() const;  // world, min and max; min > max if nothing is there

 private:
  friend class Renderer;
  friend std::vector<Diagnostic> check(const Program&, const Scene*);
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

struct ParameterInfo {
  std::string name;
  std::string type;          // "bool", "int", "float", "vec2", "vec3", "vec4", "color", …: docs/programs.md
  std::string defaultValue;  // as Settings::parameters takes it
  double min = 0, max = 0;   // of each component, inclusive
  std::string unit;
  std::string help;
};

// Ray tracing shaders and what connects them: a folder with program.toml, a .rt.glsl file, or a built-in
// program's name. Copies share their data. Shaders are compiled when a Renderer is made.
class Program {
 public:
  static Program load(const std::string& nameOrPath);  // throws FileError, UsageError
  static std::vector<std::string> builtIn();           // names
  std::string name() const;
  std::string description() const;
  std::vector<ParameterInfo> parameters() const;
  std::vector<std::string> outputs() const;

 private:
  friend class Renderer;
  friend class Scene;
  friend std::vector<Diagnostic> check(const Program&, const Scene*);
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

// Compiles and links without a device: everything that does not fit together, by the ids of docs/diagnostics. With a
// scene also what depends on it. A Renderer does the same, and refuses a program with errors.
std::vector<Diagnostic> check(const Program& program, const Scene* scene = nullptr);

struct Camera {
  std::array<float, 3> lookFrom{0, 0, 5};  // world, metres
  std::array<float, 3> lookAt{0, 0, 0};
  std::array<float, 3> up{0, 1, 0};
  float verticalFov = 0.7854f;  // radians, (0, pi)
  float apertureRadius = 0;     // metres; what is as far as lookAt is sharp
};

struct Settings {
  std::uint32_t width = 1280;  // pixels, 1 … 65536
  std::uint32_t height = 720;
  std::uint32_t seed = 0;        // of the random numbers
  std::optional<Camera> camera;  // none: the scene's first, else one that shows everything
  std::vector<std::pair<std::string, std::string>> parameters;  // name, value as on the command line ("1,0.5,0")
};

// RGBA floats, linear, premultiplied, rows from the top.
struct Picture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> pixels;  // 4 · width · height
  bool toneMap = true;        // .png: Khronos PBR neutral before the sRGB curve; false where values are not radiance
  std::array<float, 4> at(std::uint32_t x, std::uint32_t y) const;  // (0, 0): top left
  // .png (sRGB, 8 bits), .exr (half, linear) or .hdr. Throws FileError, UsageError; never half a file.
  void write(const std::filesystem::path& file) const;
};

// A program at work on a scene.
class Renderer {
 public:
  // Uploads, compiles, links. `device` outlives the renderer. Throws ProgramError, UsageError, MemoryError, Error.
  Renderer(Device& device, const Scene& scene, const Program& program, const Settings& settings = {});
  Renderer(Renderer&&) noexcept;
  ~Renderer();

  // Adds `count` samples per pixel (multiples of 4 fill the batches in which they are drawn); a program that accumulates itself (lecture form) renders `count` frames.
  void render(std::uint32_t count);
  std::uint64_t sampleCount() const;  // or frames, so far
  // Mean of the samples so far (or the last frame). Throws UsageError for an output that the program does not have.
  Picture picture(const std::string& output = "") const;  // empty: the first

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet
#endif
