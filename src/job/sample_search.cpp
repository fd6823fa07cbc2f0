// SPDX-License-Identifier: Apache-2.0
#include "job/sample_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "gpu/error.h"
#include "job/brightest_samples.h"
#include "job/pixel_explainer.h"
#include "job/runnable_program.h"

namespace quintet::job {
namespace {

bool isFinite(const vec4& value) { return std::isfinite(value.x + value.y + value.z + value.w); }

bool isFinite(const EventValue& value) {
  if (const auto* number = std::get_if<float>(&value)) return std::isfinite(*number);
  if (const auto* numbers = std::get_if<std::vector<float>>(&value))
    return std::ranges::all_of(*numbers, [](float number) { return std::isfinite(number); });
  return true;
}

float luminance(const vec3& color) { return 0.2126f * color.r + 0.7152f * color.g + 0.0722f * color.b; }

// Follows the events of a sample in their order.
class CauseFinder {
 public:
  explicit CauseFinder(bool notFinite) : notFinite_(notFinite) {}

  void visit(const ExplainedEvent& event) {
    // Members of payloads that the program has not written are undefined.
    if (done_ || event.type == "payload" || event.type == "data") return;
    if (const std::string instance = event.text("instanceName"); !instance.empty() && event.type != "intersection")
      now_.instance = instance;
    if (event.type == "surface") now_.material = event.text("material");
    if (event.type == "bsdf") now_.lobe = event.text("lobe");
    if (notFinite_) {
      for (const auto& [name, value] : event.fields)
        if (!isFinite(value)) return found(event, name);
    } else if (event.type == "contribution" && luminance(event.vector("value")) > largest_) {
      largest_ = luminance(event.vector("value"));
      found(event, {});
      done_ = false;  // a later one can be brighter
    }
    if (event.type == "bsdf" && event.flag("useful") && !event.flag("straight")) ++bounces_;
  }
  SampleCause take() { return std::move(cause_); }

 private:
  void found(const ExplainedEvent& event, const std::string& field) {
    cause_ = now_;
    cause_.event = event.type;
    cause_.field = field;
    cause_.bounce = event.find("scatterings") ? event.integer("scatterings") : now_.lobe.empty() ? -1 : bounces_;
    done_ = true;
  }

  const bool notFinite_;
  SampleCause now_, cause_;
  std::int64_t bounces_ = 0;
  float largest_ = 0;
  bool done_ = false;
};

class Search {
 public:
  Search(Engine& engine, RenderJob& job, const SearchOptions& options, Observer& observer)
      : engine_(engine), job_(job), options_(options), observer_(observer), region_(job.region()) {}

  SearchResult run() {
    const bool frames = job_.resolved().accumulatesFrames();
    const std::uint64_t count = sampleCount();
    if (options_.fireflies && !frames && count < BrightestSamples::kMinSamples)
      throw UsageError(fmt::format("fireflies: at least {} samples per pixel are required, not {}",
                                   BrightestSamples::kMinSamples, count));
    BrightestSamples brightest({region_.width, region_.height});
    const bool fireflies = options_.fireflies && !frames;
    bad_.assign(std::size_t{region_.width} * region_.height, false);
    const Stopwatch clock;
    for (std::uint32_t sample = 0; sample < count; ++sample) {
      const std::vector<vec4> values = render(sample);
      if (options_.notFinite) findNotFinite(sample, values);
      if (fireflies) brightest.add(sample, values);
      result_.samples = sample + 1;
      if (reportStop(count, clock)) break;
    }
    if (fireflies) addFireflies(brightest.find(options_.threshold));
    explainAll();
    return std::move(result_);
  }

 private:
  std::uint64_t sampleCount() const {
    const RenderRequest& request = job_.resolved().request;
    if (job_.resolved().accumulatesFrames()) return request.frames.accumulatedCount().value_or(1);
    if (!request.limits.samples || request.limits.seconds || request.limits.error)
      throw UsageError("a search requires a number of samples, without time limit and target error");
    return *request.limits.samples;
  }

  // Renders one sample, or frame, of all pixels.
  std::vector<vec4> render(std::uint32_t sample) {
    render::Renderer& renderer = job_.renderer();
    if (job_.resolved().accumulatesFrames()) {
      renderer.finish();
      if (job_.scene()->onDevice->animated()) job_.scene()->onDevice->setFrame(static_cast<float>(sample));
      renderer.renderFrame(sample);
      renderer.finish();
    } else {
      renderer.renderSample(sample);
    }
    return renderer.film().downloadBatch(0);
  }

  // The program adds nothing for a sample that it discards; its counter shows the pixel.
  void findNotFinite(std::uint32_t sample, const std::vector<vec4>& values) {
    const std::vector<uvec2> statistics = job_.renderer().film().downloadStatistics();
    const bool frames = job_.resolved().accumulatesFrames();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool discarded = !discarded_.empty() ? statistics[i].y > discarded_[i].y : statistics[i].y > 0;
      if ((isFinite(values[i]) && !discarded) || (frames && bad_[i])) continue;
      bad_[i] = true;
      if (result_.notFiniteCount++ < options_.limit) {
        FoundSample found;
        found.pixel = render::pixelAt(region_, i);
        found.sample = sample;
        result_.notFinite.push_back(found);
      }
    }
    discarded_ = statistics;
  }

  void addFireflies(const std::vector<Firefly>& fireflies) {
    result_.fireflyCount = fireflies.size();
    for (const Firefly& firefly : fireflies) {
      if (result_.fireflies.size() == options_.limit) break;
      FoundSample found;
      found.pixel = firefly.pixel + uvec2(region_.x, region_.y);
      found.sample = firefly.sample;
      found.luminance = firefly.luminance;
      found.level = firefly.level;
      result_.fireflies.push_back(found);
    }
  }

  bool reportStop(std::uint64_t count, const Stopwatch& clock) {
    Progress progress;
    progress.samples = static_cast<double>(result_.samples);
    progress.seconds = clock.seconds();
    progress.countsFrames = job_.resolved().accumulatesFrames();
    progress.sampleLimit = count;
    observer_.progress(progress);
    result_.interrupted = result_.samples < count && observer_.stopRequested() != StopRequest::none;
    return result_.interrupted;
  }

  void explainAll() {
    if (result_.notFinite.empty() && result_.fireflies.empty()) return;
    observer_.stage("explaining the samples");
    PixelExplainer explainer(engine_, job_);
    for (const bool notFinite : {true, false}) {
      for (FoundSample& found : notFinite ? result_.notFinite : result_.fireflies) {
        const PixelExplanation explanation = explainer.explain(found.pixel, found.sample, observer_);
        found.value = sumContributions(explanation);
        found.cause = causeOf(explanation, notFinite);
      }
    }
  }

  Engine& engine_;
  RenderJob& job_;
  const SearchOptions& options_;
  Observer& observer_;
  const render::Region region_;
  std::vector<uvec2> discarded_;  // statistics after the previous sample
  std::vector<bool> bad_;         // pixels of the region that were not finite
  SearchResult result_;
};

}  // namespace

SampleCause causeOf(const PixelExplanation& explanation, bool notFinite) {
  CauseFinder finder(notFinite);
  forEachEvent(explanation.events, [&](const ExplainedEvent& event, int) { finder.visit(event); });
  return finder.take();
}

SearchResult searchSamples(Engine& engine, RenderJob& job, const SearchOptions& options, Observer& observer) {
  try {
    return Search(engine, job, options, observer).run();
  } catch (const TimeoutError& error) {
    observer.deviceHung(hangDiagnostic(job.resolved().program, error.seconds()));
    throw;
  }
}

}  // namespace quintet::job
