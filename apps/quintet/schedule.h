// What is rendered next, and when it is enough: samples, a stated error, adaptive sampling.
#ifndef QUINTET_APP_SCHEDULE_H
#define QUINTET_APP_SCHEDULE_H

#include <cstdint>
#include <optional>
#include <vector>

#include "render/film_error.h"
#include "render/film_file.h"
#include "render/renderer.h"

namespace quintet::app {

struct RenderLimits {
  std::optional<std::uint64_t> samples;  // per pixel; on average where adaptive
  std::optional<double> seconds;         // wall clock of rendering
  std::optional<double> error;           // render::ErrorEstimate::reaches; looked at after fixed numbers of batches
  bool adaptive = false;                 // batches where they are needed, after a first few of all pixels
  // Of a part or a rendering that goes on: its first sample, the next one, the seconds that it took so far.
  std::uint64_t begin = 0;
  std::uint64_t done = 0;
  double secondsBefore = 0;
  double batchSecondsBefore = 0;         // those of its last batch
  std::vector<std::uint32_t> plan = {};  // of an adaptive one: Schedule::plan() of then; empty: it decides anew
};

class Schedule {
 public:
  Schedule(render::Renderer& renderer, const RenderLimits& limits);

  // Decides on the next batch; false: it is enough.
  bool next();
  // Renders that batch; false: it was given up.
  bool render(const render::BatchProgress& progress);

  // Samples per pixel (on average) that are there, those of the batch that comes, and the end as far as it is known.
  double samples() const { return samples_; }
  double step() const { return step_; }
  std::optional<std::uint64_t> sampleLimit() const;
  // Nothing: not known. From the last look.
  const std::optional<render::ErrorEstimate>& estimate() const { return estimate_; }
  bool reached() const { return reached_; }
  // What adaptive sampling has decided on and is carrying out: batches by cell. The film and this are all that the
  // rendering's further way depends on.
  const std::vector<std::uint32_t>& plan() const { return plan_; }
  // Looks now: for the progress line.
  void look();

 private:
  bool nextForAll();
  bool nextForCells();

  render::Renderer& renderer_;
  const RenderLimits& limits_;
  std::uint64_t done_;       // samples of all pixels
  std::uint32_t count_ = 0;  // of the batch that comes; 0: of cells
  std::vector<std::uint32_t> plan_;
  double samples_ = 0;
  double step_ = 0;
  bool reached_ = false;
  std::optional<render::ErrorEstimate> estimate_;
};

// Some cell has fewer batches than the plan says.
bool isLeft(const std::vector<std::uint32_t>& plan, const render::SampleCounts& counts);

// Adaptive sampling's next plan, where nothing is left of the one before; empty: it ends here.
std::vector<std::uint32_t> decide(const render::Region& region, const render::SampleCounts& counts,
                                  const render::ErrorEstimate& estimate, const RenderLimits& limits);

// An adaptive rendering with these limits would go no further than this film.
bool isFinished(const render::FilmFile& film, const render::ErrorEstimate& estimate, const RenderLimits& limits);

// An error to reach that will never be known (squares beyond the film's range stay so), and nothing else that ends it.
bool isHopeless(const render::ErrorEstimate& estimate, const RenderLimits& limits);

// Numbers of batches after which a rendering with an error to reach looks at it: fixed, so that the same command
// ends with the same samples, interrupted or not. 4 … 15, then eight per doubling.
bool looksAfter(std::uint64_t batches);

}  // namespace quintet::app
#endif
