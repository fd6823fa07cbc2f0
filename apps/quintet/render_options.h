// The options of `quintet render`, which `quintet run` has, too; checked as far as they can be without the scene.
#ifndef QUINTET_APP_RENDER_OPTIONS_H
#define QUINTET_APP_RENDER_OPTIONS_H

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "exr_output.h"
#include "farm_options.h"
#include "render/film.h"
#include "render/tone_map.h"
#include "scene_setup.h"

namespace quintet::app {

struct RenderOptions {
  std::filesystem::path scene;   // empty (run only): the program's own, else the built-in one
  std::filesystem::path output;  // "-": PNG to standard output
  uvec2 size{0};                 // 0: decided by the camera
  std::optional<std::uint64_t> samples;
  std::optional<double> seconds;
  std::optional<double> error;  // relative, to be reached
  bool adaptive = false;
  std::optional<std::uint32_t> frames;  // as asked for
  // Of a program that draws frame after frame; nothing: until the time is over.
  std::optional<std::uint32_t> drawnFrames;
  CameraOptions camera;
  EnvironmentOptions environment;
  float exposure = 0.0f;  // stops
  std::optional<render::ToneMap> toneMap;
  std::uint32_t seed = 0;
  render::Region region;  // width 0: everything
  std::string program = "pathtracer";
  std::vector<std::string> assignments;  // name=value, in the order of the command line
  std::filesystem::path setFile;         // JSON object of parameters, before the assignments; may be empty
  std::string outputName;                // of the program; empty: its first
  bool allOutputs = false;               // one file each
  std::optional<std::string> bounces;
  std::optional<std::string> clamp;
  bool programHelp = false;
  std::string device;
  std::optional<double> timeout;  // seconds of one launch
  bool quiet = false;
  bool json = false;
  bool transparent = false;
  FarmOptions farm;
  std::string commandLine;
  ExrFormat exr;
  std::vector<std::string> aovs;  // layers besides the picture, or "all"
  bool aovList = false;           // print what there are
};

// Nothing: help was printed. Throws UsageError.
std::optional<RenderOptions> parseRenderOptions(Arguments arguments);

}  // namespace quintet::app
#endif
