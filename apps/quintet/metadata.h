// What an image says about how it was made: text in PNG, string attributes in OpenEXR.
#ifndef QUINTET_APP_METADATA_H
#define QUINTET_APP_METADATA_H

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/codec.h"
#include "render/film_error.h"
#include "shader/compiler.h"

namespace quintet::app {

// What the process and the device held, and what a scene needs at least; bytes.
struct MemoryUse {
  std::uint64_t peakHost = 0;    // resident, by the end of the rendering
  std::uint64_t peakDevice = 0;  // asked of the driver
  std::uint64_t geometry = 0;
  std::uint64_t textures = 0;
  std::uint64_t acceleration = 0;  // with the maps of primitives
  // Of peakDevice: (purpose, bytes), as things stood when it was reached; "unused" is room in the driver's blocks.
  std::vector<std::pair<std::string, std::uint64_t>> devicePeak;
  bool deviceIsHost = false;  // a CPU: what the device holds is part of what the process holds
  // Of the peak to the three together. On a CPU the process's peak: what was asked for and never touched is in no
  // memory. Else the larger of the two: each memory by itself.
  double ratio() const;
};

// Everything that is known about a rendering when it has ended.
struct RenderRecord {
  std::string commandLine;
  std::vector<std::string> files;  // pictures written
  std::string outputName;          // of the program, in the picture written last
  std::string scene;
  std::string sceneHash;
  std::string environment;
  std::string camera;
  std::string program;
  std::string parameters;
  std::string device;
  std::string driver;
  std::string toneMap;  // empty: linear radiance was written
  float exposure = 0;
  bool transparent = false;
  std::uint32_t width = 0;  // of the whole image
  std::uint32_t height = 0;
  std::array<std::uint32_t, 4> region{};  // x, y, width, height of what was rendered
  std::uint32_t seed = 0;
  std::uint64_t samples = 0;
  std::uint64_t rays = 0;
  std::uint64_t droppedSamples = 0;
  bool accumulates = false;            // the program draws frames: `samples` counts them
  std::optional<std::uint32_t> frame;  // of an animation
  bool interrupted = false;
  bool adaptive = false;        // `samples` is an average
  render::ErrorEstimate error;  // of the first output
  std::optional<double> wantedError;

  // Seconds.
  double startSeconds = 0;       // instance and device
  double loadSeconds = 0;        // scene and environment, read and decoded
  double buildSeconds = 0;       // upload and acceleration structures
  double compileSeconds = 0;     // GLSL to SPIR-V
  double pipelineSeconds = 0;    // SPIR-V to pipeline
  double firstPixelSeconds = 0;  // from the command's start until the first launch is done
  double renderSeconds = 0;      // wall clock of all batches
  double deviceSeconds = 0;      // of that, on the device
  double totalSeconds = 0;       // from the command's start until the file is written

  // Bytes on the device.
  std::uint64_t geometryBytes = 0;
  std::uint64_t textureBytes = 0;
  std::uint64_t accelerationBytes = 0;
  std::uint64_t filmBytes = 0;

  std::vector<std::string> warnings;
  std::vector<shader::Diagnostic> diagnostics;         // warnings about the program
  std::vector<std::pair<std::string, double>> stages;  // seconds from the start to the first pixel, in more detail
  MemoryUse memory;

  bool cropped() const { return region[2] != width || region[3] != height; }
  double raysPerSecond() const { return renderSeconds > 0 ? static_cast<double>(rays) / renderSeconds : 0; }
};

io::Metadata metadata(const RenderRecord& record);

// Why --until-error is not content.
std::string unreachedText(const RenderRecord& record);

// One object, one line.
std::string toJson(const RenderRecord& record);

// "out.png: 1280x720, 64 samples per pixel, 12.3 s, 4.56 Mrays/s"
std::string summary(const RenderRecord& record);

}  // namespace quintet::app
#endif
