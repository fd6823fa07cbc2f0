// SPDX-License-Identifier: Apache-2.0
// Runs a program over a scene, batch by batch, into a film. Built-in programs and user programs are treated alike.
#ifndef QUINTET_RENDER_RENDERER_RENDERER_H
#define QUINTET_RENDER_RENDERER_RENDERER_H

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "program/linked/linked_program.h"
#include "program/runnable_program.h"
#include "render/film/film.h"
#include "render/renderer/instrument.h"
#include "render/renderer/launch_queue.h"
#include "render/renderer/parameter_textures.h"
#include "render/renderer/render_settings.h"
#include "render/scene/device_scene.h"

namespace quintet::render {

// Called between launches with the fraction of the current batch that is finished or in flight. Returning false cancels
// the batch: its samples are lost, but its rays stay counted. A batch at fraction 1 can no longer be canceled.
using BatchProgress = std::function<bool(double)>;

class Renderer {
 public:
  // `scene` must outlive the renderer. `compiler` compiles the film's compute passes and is used during construction
  // only, as is `cache`, which can be null. Throws UsageError (size, region, outputs), FileError (parameter images),
  // and gpu errors.
  Renderer(DeviceScene& scene, program::RunnableProgram program, const shader::Compiler& compiler,
           const gpu::PipelineCache* cache, const RenderSettings& settings);
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Renders the next batch of at most kBatchSamples samples per pixel. For a program that accumulates
  // (program::Accumulation) it renders the next `sampleCount` frames. Returns false if the batch was canceled.
  bool renderBatch(std::uint32_t sampleCount = kBatchSamples, const BatchProgress& progress = {});
  // Renders the frame with this index, which is the program's frameID; for programs that accumulate. Returns false if
  // the frame was canceled; the image is then still that of the previous frame.
  bool renderFrame(std::uint32_t index, const BatchProgress& progress = {});
  // Renders one sample, or frame, of one pixel of the region into the sums of the latest batch (Film::downloadBatch), and
  // does not add it to the film. Blocks.
  void renderPixel(uvec2 pixel, std::uint32_t index);
  // The same for all pixels; for programs whose samples the film averages.
  void renderSample(std::uint32_t index);
  // Adaptive sampling, for programs that support it (Program::adaptive): renders the next batches (nextAdaptiveBatches) of the
  // cells (SampleCounts::cellBatches) that are below `limits`. Asserts that there is one, and that all pixels have batch 0.
  // Returns false if the batches were canceled.
  bool renderCells(const std::vector<std::uint32_t>& limits, const BatchProgress& progress = {});

  // A batch that several devices share: each renders parts of it, and their films are added up (addFilm). Renders rows
  // [first, first + count) of the region, or tiles [first, first + count) of `tiles` if there are any (AdaptiveBatches::tiles),
  // and does not count the samples (Film::counts). Not for programs that accumulate. Returns false if it was canceled.
  struct Part {
    SampleRange samples;  // of the batch, for rows
    std::span<const shared::FilmTile> tiles;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  bool renderPart(const Part& part, const BatchProgress& progress = {});
  // Returns whether batches of a pixel must run one after another (nextAdaptiveBatches), because their samples have different times
  // or the program keeps records by pixel.
  bool needsOneBatch() const;
  // Reads the film, without counts, and discards its samples. Blocks.
  FilmState takeFilm();

  // Sets the batch that renderBatch() renders next, for parts of a render.
  void startAt(std::uint64_t batch) { nextBatch_ = batch; }
  // Reads the film. Blocks.
  FilmState saveFilm() const;
  // Replaces the film by that of a render with the same program, outputs and region, and resumes after it. Blocks.
  void restoreFilm(const FilmState& state);
  // Discards all samples or frames, for the next frame of an animation.
  void restart();

  // Edits: each discards all samples. Before a change of the scene itself, call restart(). The next launch shows the changed scene
  // (DeviceScene::revision).
  void setCamera(const scene::Camera& camera);
  // RenderSettings::shutter and cameraAt. With a shutter, each launch calls DeviceScene::setFrame; else the caller does, before
  // this function.
  void setShutter(const std::optional<ShutterInterval>& shutter, std::function<scene::Camera(double frame)> cameraAt);
  // For the same program. Throws FileError for an image that cannot be read, and then changes nothing.
  void setParameters(const program::ParameterValues& values);
  // The whole image has this size from now on, without a region. Not for renderers with RenderSettings::instrument or
  // ray records. Throws UsageError and MemoryError, and then changes nothing.
  void setSize(uvec2 size);
  // RenderSettings::plannedSamples, or frameCount for a program that accumulates.
  void setPlannedSamples(std::uint32_t count);

  // Waits for the launches in flight; statistics() and launches() then cover all of them. The functions that read the
  // film or its counters wait by themselves.
  void finish() { finishLaunches(); }

  const Film& film() const { return film_; }
  const RenderSettings& settings() const { return settings_; }  // with defaults resolved (decideSettings)
  // Returns the mean of all samples, or the last frame, as linear premultiplied RGBA. An output with display values
  // (program::OutputKind::display) is decoded, so that an 8-bit image file holds the values that the program wrote.
  // Blocks.
  io::Image image(std::size_t output = 0) const;
  // The same for display, with Film::downloadMean().
  io::Image displayImage(std::size_t output = 0) const;
  RayCount rays() const;  // blocks
  // Returns Film::notFinitePixels. Blocks.
  std::vector<NotFinitePixels> notFinitePixels() const;
  const RenderStatistics& statistics() const { return statistics_; }
  // Returns the finished launches if RenderSettings::profile is set.
  const std::vector<LaunchTiming>& launches() const { return queue_.timings(); }
  const program::LinkedProgram& linked() const { return linked_; }
  // Returns the findings of the runtime checks so far (Q001 to Q007) if RenderSettings::instrument is set. Blocks.
  std::vector<Diagnostic> runtimeDiagnostics() const;
  // Returns the number of traces beyond the recursion depth of the pipeline that were not executed, since the start or
  // restart(); 0 unless RunnableProgram::countsRecursion is set. Blocks.
  std::uint64_t skippedTraces() const;
  // Returns what the runtime checks counted so far if RenderSettings::instrument is set, else zeros. Blocks.
  shared::Instrument instrumentCounts() const;
  const program::Program& program() const { return runnable_.description; }

 private:
  using Record = LaunchQueue::Record;
  // The area of launches: rows of the region, or film tiles, one below another.
  struct Target {
    std::uint32_t width = 0;   // invocations per row
    std::uint32_t height = 0;  // rows
    uvec2 offset{0};           // pixel offset of row 0 in the whole image
    shared::Address tiles = 0;
    struct Batch {
      std::uint32_t endRow = 0;
      std::uint32_t firstSample = 0;
    };
    std::vector<Batch> batches;  // of the rows up to endRow; for tiles, several can hold the same pixels
    Record begin, end;           // before the first launch and after the last one; can be empty
  };

  // The outputs that a launch stores.
  enum class Stored {
    all,
    samples,  // all but those of pixel centers
    centers,  // only those of pixel centers, without any counts
  };
  void restartAndUploadFrame();
  void uploadFrame();
  void uploadFrame(const scene::Camera& camera, Stored stored);
  // Moves the scene and the camera to a frame of the animation, and waits for the launches in flight.
  void showTime(double frame, Stored stored);
  void showSample(std::uint32_t index, Stored stored);  // the time of a sample, if there is a shutter
  bool storesCenters() const;
  bool storesMotion() const;
  bool accumulates() const { return program().accumulation == program::Accumulation::program; }
  double filmPixels() const;  // of the rendered region
  Target wholeRegion(std::uint32_t firstSample);
  // Uploads the tiles, which must stay valid until the last launch has been recorded.
  Target tileTarget(std::span<const shared::FilmTile> tiles);
  // Launches a strip of the target. `samples` is relative to the first sample of each batch.
  void launch(const Target& target, std::uint32_t row, std::uint32_t rows, SampleRange samples, const Record& before,
              const Record& after);
  bool renderFrames(std::uint32_t count, const BatchProgress& progress);
  // Renders `count` samples of the target's batches.
  bool renderSamples(const Target& target, std::uint32_t count, const BatchProgress& progress);
  // The parts of renderSamples(): in strips, all samples at the time that the scene shows; and each sample at its own
  // time. `begin` and `end`: those of the target, or empty.
  bool renderStrips(const Target& target, SampleRange samples, const Record& begin, const Record& end,
                    const BatchProgress& progress);
  bool renderTimes(const Target& target, std::uint32_t count, const BatchProgress& progress);
  // Waits for the launches in flight, with their time limit, so that a hanging launch is detected. The wait counts as
  // render time.
  void finishLaunches() const;

  DeviceScene& scene_;
  gpu::Context& context_;
  program::RunnableProgram runnable_;
  RenderSettings settings_;
  program::LinkedProgram linked_;
  rt::ShaderBindingTable table_;
  Film film_;
  gpu::Buffer frameBuffer_;
  std::uint64_t shownRevision_ = 0;  // DeviceScene::revision() of frameBuffer_
  gpu::Buffer tileBuffer_;           // tiles of the latest adaptive batch
  ParameterTextures parameterTextures_;
  gpu::Buffer parameterBuffer_;
  std::optional<InstrumentBuffer> instrument_;
  std::optional<RecursionBuffer> recursion_;
  gpu::Buffer heat_;                       // counters of heat maps: HeatPixel[]; empty unless the program counts them
  std::uint32_t tracesSkippedBefore_ = 0;  // the last restart()
  // Mutable so that const functions can wait for launches, which changes no result.
  mutable RenderStatistics statistics_;
  mutable LaunchQueue queue_;
  bool compiled_ = false;  // by the driver, as far as it compiles in launches
  std::uint64_t nextBatch_ = 0;
};

}  // namespace quintet::render
#endif
