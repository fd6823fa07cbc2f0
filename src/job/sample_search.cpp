// SPDX-License-Identifier: Apache-2.0
#include "job/sample_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/luminance.h"
#include "base/math.h"
#include "base/stopwatch.h"
#include "gpu/error.h"
#include "job/brightest_samples.h"
#include "job/pixel_explainer.h"
#include "job/pixel_groups.h"
#include "job/runnable_program.h"

namespace quintet::job {
namespace {

bool isFiniteValue(const std::string& name, const EventValue& value) {
  // A ray may be infinitely long.
  if (const auto* number = std::get_if<float>(&value))
    return name == "tmax" ? !std::isnan(*number) : std::isfinite(*number);
  if (const auto* numbers = std::get_if<std::vector<float>>(&value))
    return std::ranges::all_of(*numbers, [](float number) { return std::isfinite(number); });
  return true;
}

// Follows the events of a sample in their order.
class CauseFinder {
 public:
  explicit CauseFinder(bool notFinite) : notFinite_(notFinite) {}

  void visit(const ExplainedEvent& event) {
    // Members of payloads that the program has not written are undefined.
    if (done_ || event.type == "payload" || event.type == "data") return;
    // Other hits are those of shadow rays, or candidates.
    if (event.type == "closest-hit") now_.instance = event.text("instanceName");
    if (event.type == "surface") {
      now_.material = event.text("material");
      arriving_ = {now_.lobe, now_.lobeMaterial};
      now_.lobeIsBefore = !now_.lobe.empty();
    }
    if (event.type == "bsdf") {
      now_.lobe = event.text("lobe");
      now_.lobeMaterial = now_.material;
      now_.lobeIsBefore = false;
    }
    if (notFinite_) {
      for (const auto& [name, value] : event.fields)
        if (!isFiniteValue(name, value)) return found(event, name);
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
    // The light at a surface is added after the lobe of the next direction was sampled.
    if (event.type == "contribution" && event.text("source") == "light sample") {
      cause_.lobe = arriving_.lobe;
      cause_.lobeMaterial = arriving_.material;
      cause_.lobeIsBefore = !arriving_.lobe.empty();
    }
    cause_.event = event.type;
    cause_.field = field;
    cause_.bounce = event.find("scatterings") ? event.integer("scatterings") : now_.lobe.empty() ? -1 : bounces_;
    done_ = true;
  }

  const bool notFinite_;
  SampleCause now_, cause_;
  struct Lobe {
    std::string lobe, material;
  };
  Lobe arriving_;  // by which the path reached the latest surface
  std::int64_t bounces_ = 0;
  float largest_ = 0;
  bool done_ = false;
};

class Search {
 public:
  Search(Engine& engine, RenderJob& job, const SearchOptions& options, Observer& observer)
      : engine_(engine), job_(job), options_(options), observer_(observer), region_(job.region()) {}

  SearchResult run() {
    result_.frames = job_.resolved().accumulatesFrames();
    const std::uint64_t count = sampleCount();
    const bool fireflies = searchesFireflies(count);
    BrightestSamples brightest({region_.width, region_.height});
    job_.showRequestedFrame();
    bad_.assign(std::size_t{region_.width} * region_.height, {});
    const Stopwatch clock;
    for (std::uint32_t sample = 0; sample < count; ++sample) {
      const std::vector<vec4> values = render(sample);
      if (options_.notFinite) findNotFinite(sample, values);
      if (fireflies) brightest.add(sample, values);
      result_.samples = sample + 1;
      if (reportStop(count, clock)) break;
    }
    groupNotFinite();
    if (fireflies) addFireflies(brightest.find(options_.threshold));
    explainAll();
    return std::move(result_);
  }

 private:
  std::uint64_t sampleCount() const {
    const std::uint64_t count = requestedCount();
    constexpr std::uint64_t kMost = std::uint64_t{kMaxSample} + 1;
    if (count == 0 || count > kMost)
      throw UsageError(fmt::format("a search has 1 to {} samples, not {}", kMost, count));
    return count;
  }

  std::uint64_t requestedCount() const {
    if (options_.samples) return *options_.samples;
    const RenderRequest& request = job_.resolved().request;
    if (job_.resolved().accumulatesFrames()) return request.frames.accumulatedCount().value_or(1);
    if (!request.limits.samples || request.limits.seconds || request.limits.error)
      throw UsageError("a search requires a number of samples, without time limit and target error");
    return *request.limits.samples;
  }

  bool searchesFireflies(std::uint64_t count) {
    if (!options_.fireflies.value_or(true)) return false;
    std::string problem;
    if (result_.frames)
      problem = fmt::format(
          "the program '{}' accumulates its frames, so its samples are unknown; only values that are not finite can be "
          "found",
          job_.resolved().program.name);
    else if (count < BrightestSamples::kMinSamples)
      problem = fmt::format("at least {} samples per pixel are required, not {}", BrightestSamples::kMinSamples, count);
    if (problem.empty()) return true;
    if (options_.fireflies) throw UsageError("fireflies: " + problem);
    observer_.note("fireflies are not searched: " + problem);
    return false;
  }

  // Renders one sample, or frame, of all pixels.
  std::vector<vec4> render(std::uint32_t sample) {
    render::Renderer& renderer = job_.renderer();
    try {
      if (result_.frames) {
        renderer.finish();
        if (job_.scene()->onDevice->animated()) job_.scene()->onDevice->setFrame(static_cast<float>(sample));
        renderer.renderFrame(sample);
        renderer.finish();
      } else {
        renderer.renderSample(sample);
      }
      return renderer.film().downloadBatch(0);
    } catch (const TimeoutError& error) {
      observer_.deviceHung(hangDiagnostic(job_.resolved().program, error));
      throw;
    }
  }

  // The program adds nothing for a sample that it discards; its counter shows the pixel.
  void findNotFinite(std::uint32_t sample, const std::vector<vec4>& values) {
    const std::vector<uvec2> statistics = job_.renderer().film().downloadStatistics();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool discarded = !discarded_.empty() ? statistics[i].y > discarded_[i].y : statistics[i].y > 0;
      Bad& bad = bad_[i];
      if ((isFinite(values[i]) && !discarded) || (result_.frames && bad.count > 0)) continue;
      if (bad.count++ == 0) bad.first = sample;
      ++result_.notFiniteCount;
    }
    discarded_ = statistics;
  }

  void groupNotFinite() {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < bad_.size(); ++i)
      if (bad_[i].count > 0) order.push_back(i);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return bad_[i].first; });
    std::vector<uvec2> pixels;
    for (const std::size_t i : order) pixels.push_back(render::pixelAt(region_, i) - corner());
    for (const PixelGroup& group : groupAdjacent({region_.width, region_.height}, pixels)) {
      if (result_.notFiniteGroups++ >= options_.limit) continue;
      FoundSample found = foundIn(group, pixels);
      found.sample = bad_[order[group.members.front()]].first;
      found.groupSamples = 0;
      for (const std::size_t member : group.members) found.groupSamples += bad_[order[member]].count;
      result_.notFinite.push_back(found);
    }
  }

  void addFireflies(const std::vector<Firefly>& fireflies) {
    result_.fireflyCount = fireflies.size();
    std::vector<uvec2> pixels;
    for (const Firefly& firefly : fireflies) pixels.push_back(firefly.pixel);
    for (const PixelGroup& group : groupAdjacent({region_.width, region_.height}, pixels)) {
      if (result_.fireflyGroups++ >= options_.limit) continue;
      const Firefly& firefly = fireflies[group.members.front()];
      FoundSample found = foundIn(group, pixels);
      found.sample = firefly.sample;
      found.luminance = firefly.luminance;
      found.level = firefly.level;
      found.groupSamples = group.members.size();
      result_.fireflies.push_back(found);
    }
  }

  uvec2 corner() const { return {region_.x, region_.y}; }

  // The pixels of a group, in the whole image.
  FoundSample foundIn(const PixelGroup& group, const std::vector<uvec2>& pixels) const {
    FoundSample found;
    found.pixel = pixels[group.members.front()] + corner();
    found.least = group.least + corner();
    found.most = group.most + corner();
    found.groupPixels = group.members.size();
    return found;
  }

  bool reportStop(std::uint64_t count, const Stopwatch& clock) {
    Progress progress;
    progress.samples = static_cast<double>(result_.samples);
    progress.seconds = clock.seconds();
    progress.countsFrames = result_.frames;
    progress.sampleLimit = count;
    observer_.progress(progress);
    result_.interrupted = result_.samples < count && observer_.stopRequested() != StopRequest::none;
    return result_.interrupted;
  }

  // Removes the samples that remain if the observer stops; a request that ended the search does not end the explanations.
  void explainAll() {
    Progress progress;
    progress.countsFrames = result_.frames;
    progress.sampleLimit = result_.notFinite.size() + result_.fireflies.size();
    if (progress.sampleLimit == 0) return;
    observer_.stage("explaining the samples");
    PixelExplainer explainer(engine_, job_);
    const Stopwatch clock;
    const bool mayStop = !result_.interrupted;
    for (const bool notFinite : {true, false}) {
      std::vector<FoundSample>& samples = notFinite ? result_.notFinite : result_.fireflies;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const StopRequest stop = observer_.stopRequested();
        if (stop == StopRequest::abandon || (mayStop && stop != StopRequest::none)) {
          result_.interrupted = true;
          samples.resize(i);
          break;
        }
        const PixelExplanation explanation = explainer.explain(samples[i].pixel, samples[i].sample, observer_);
        samples[i].value = sumContributions(explanation);
        samples[i].cause = causeOf(explanation, notFinite);
        samples[i].cause.origin = explanation.origin;
        progress.samples += 1;
        progress.seconds = clock.seconds();
        observer_.progress(progress);
      }
    }
  }

  Engine& engine_;
  RenderJob& job_;
  const SearchOptions& options_;
  Observer& observer_;
  const render::Region region_;
  std::vector<uvec2> discarded_;  // statistics after the previous sample
  struct Bad {
    std::uint32_t first = 0, count = 0;  // samples that are not finite
  };
  std::vector<Bad> bad_;  // by pixel of the region
  SearchResult result_;
};

}  // namespace

SampleCause causeOf(const PixelExplanation& explanation, bool notFinite) {
  CauseFinder finder(notFinite);
  forEachEvent(explanation.events, [&](const ExplainedEvent& event, int) { finder.visit(event); });
  return finder.take();
}

SearchResult searchSamples(Engine& engine, RenderJob& job, const SearchOptions& options, Observer& observer) {
  return Search(engine, job, options, observer).run();
}

}  // namespace quintet::job
