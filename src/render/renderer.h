// Runs a program over a scene, batch by batch, into a film. Built-in programs and a user's go the same way.
#ifndef QUINTET_RENDER_RENDERER_H
#define QUINTET_RENDER_RENDERER_H

#include <filesystem>
#include <functional>
#include <memory>

#include "base/error.h"
#include "program/link.h"
#include "render/device_scene.h"
#include "render/film.h"
#include "render/program_shaders.h"
#include "render/render_settings.h"
#include "render/scene_features.h"

namespace quintet::render {

struct RenderStatistics {
  double compileSeconds = 0;      // GLSL to SPIR-V
  double pipelineSeconds = 0;     // SPIR-V to pipeline
  double firstLaunchSeconds = 0;  // first launch, with what the driver still compiles in it
  double renderSeconds = 0;       // wall clock of all batches
  double deviceSeconds = 0;       // timestamps around all launches
  std::uint64_t samples = 0;      // per pixel; frames, where the program accumulates
  std::uint64_t batches = 0;
};

// One launch of a profiled renderer: seconds of the device, but where it says otherwise.
struct LaunchTiming {
  std::uint32_t rows = 0;
  std::uint32_t samples = 0;  // per pixel
  double beginSeconds = 0;    // emptying the batch
  double traceSeconds = 0;
  double endSeconds = 0;   // adding the batch to the total
  double idleSeconds = 0;  // of the device, since the launch before; 0 for the first one
  double wallSeconds = 0;  // of the host, from recording to the end of the wait
};

// Called between launches with the fraction of the current batch that is done or under way; false: give the batch up. Its
// samples are lost, but not the count of its rays; at 1 nothing is left to give up.
using BatchProgress = std::function<bool(double)>;

class Renderer {
 public:
  // `scene` outlives the renderer. Throws ProgramError, UsageError (size, region), gpu errors.
  Renderer(DeviceScene& scene, const program::Program& program, const shader::Compiler& compiler,
           const gpu::PipelineCache* cache, const RenderSettings& settings);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Renders the next batch of kBatchSamples samples per pixel, or fewer for the last one. False: given up.
  // Of a program that accumulates (program::Accumulation): the next frames, one launch of the picture each.
  bool renderBatch(std::uint32_t sampleCount = kBatchSamples, const BatchProgress& progress = {});
  // For programs that accumulate: the frame with this index, frameID for the program. False: given up, the picture
  // remains the frame before.
  bool renderFrame(std::uint32_t index, const BatchProgress& progress = {});

  // Adaptive sampling, for programs that allow it (Program::adaptive): the next batch of those cells
  // (SampleCounts::cellBatches) that have fewer batches than `limits` says and, of them, the fewest. False: given up.
  // Asserts that some cell is to be rendered.
  bool renderCells(const std::vector<std::uint32_t>& limits, const BatchProgress& progress = {});

  // The batch that renderBatch() renders next, instead of the one after the last: for parts of a rendering.
  void startAt(std::uint64_t batch);
  // The film as it is, and to go on from one of the same program, outputs and region. Block.
  FilmState saveFilm() const;
  void restoreFilm(const FilmState& state);

  // Waits for the launches that are under way; statistics() and launches() then know of all of them. What reads the
  // picture or its counters waits by itself.
  void finish();

  // Forgets all samples or frames: the next one is the first. For the next frame of an animation.
  void restart();

  const Film& film() const;
  // Mean of all samples so far, or the last frame; linear, premultiplied RGBA. An output of display values
  // (program::Program) is decoded, so that a picture file of 8 bits holds what the program wrote.
  io::Image image(std::size_t output = 0) const;
  RayCount rays() const;
  const RenderStatistics& statistics() const;
  // Of RenderSettings::profile.
  const std::vector<LaunchTiming>& launches() const;
  const program::LinkedProgram& linked() const;
  // What the checks of RenderSettings::instrument have found so far (ids Q001 … Q006). Blocks.
  std::vector<shader::Diagnostic> notes() const;
  // Warnings and notes of the compiler and of the check.
  const std::vector<shader::Diagnostic>& diagnostics() const;
  // Files on disk from outside the program: what its shaders include, and pictures of its parameters.
  const std::vector<std::filesystem::path>& files() const;
  // Of what its shaders include from there, as it was when they were compiled; sorted.
  const std::vector<Hash>& shaderHashes() const;
  const program::Program& program() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::render
#endif
