// The options that `render` and `run` have in common: declared in groups, read as text, then checked.
#ifndef QUINTET_APP_OPTION_GROUPS_H
#define QUINTET_APP_OPTION_GROUPS_H

#include <string>
#include <vector>

#include "cli.h"
#include "render_options.h"

namespace quintet::app {

// Options as text, before their values are looked at.
struct RawOptions {
  std::string scene, output, size, spp, time, untilError, lookFrom, lookAt, up, fov, aperture, focus, envIntensity,
      envRotation, exposure, toneMap, seed, region, timeout, setFile, exrType, exrCompression, exrTiles;
  std::vector<std::string> aovs;
};

void declareImage(CLI::App& app, RawOptions& raw, RenderOptions& options);  // all but the output file
void declareQuality(CLI::App& app, RawOptions& raw, RenderOptions& options);
void declareView(CLI::App& app, RawOptions& raw, RenderOptions& options);     // camera and light
void declareProgram(CLI::App& app, RawOptions& raw, RenderOptions& options);  // parameters and outputs
void declareProcess(CLI::App& app, RawOptions& raw, RenderOptions& options, const std::string& timeoutHelp);

enum class AovNames { ofProgram, ofFilms };  // what --aov names
void declareExr(CLI::App& app, RawOptions& raw, AovNames names = AovNames::ofProgram);
bool asksForAovList(const RawOptions& raw);

// Fills `options` with the values of all texts but the scene and the output file. Throws UsageError.
void interpret(const RawOptions& raw, RenderOptions& options);

// Options of OpenEXR for another file, when its name is known. Throws UsageError.
void checkExrOptions(const RawOptions& raw, const RenderOptions& options);

// What --json and --all-outputs forbid with -o -. Throws UsageError.
void checkStandardOutput(const std::filesystem::path& output, bool json, bool allOutputs);

}  // namespace quintet::app
#endif
