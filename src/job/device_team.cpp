// SPDX-License-Identifier: Apache-2.0
#include "job/device_team.h"

#include <utility>

#include "gpu/error.h"
#include "render/film/film_error.h"

namespace quintet::job {
namespace {

// The film on the only device.
class DeviceView : public FilmView {
 public:
  explicit DeviceView(const render::Renderer& renderer)
      : renderer_(renderer), planes_(emptyPlanes(renderer.program())) {}

  const std::vector<render::FilmPlane>& planes() const override { return planes_; }
  bool stores(std::size_t output) const override { return renderer_.film().stores(output); }
  render::SampleCounts counts() const override { return renderer_.film().counts(); }
  io::Image image(std::size_t output) const override { return renderer_.image(output); }
  render::FilmPlane plane(std::size_t output) const override { return renderer_.film().plane(output); }
  io::Image variance() const override { return render::varianceImage(renderer_.film().saveFirst()); }
  render::FilmState state() const override { return renderer_.saveFilm(); }

 private:
  const render::Renderer& renderer_;
  std::vector<render::FilmPlane> planes_;
};

// Its loss ends the job: the renderer throws DeviceLostError.
class OneDevice : public DeviceTeam {
 public:
  explicit OneDevice(TeamMember member) : DeviceTeam({std::move(member)}) {}

  std::vector<std::size_t> active() const override { return {0}; }
  void drop(std::size_t /*index*/, const std::string& reason) override { throw DeviceLostError(reason); }
  void change(const std::function<void(TeamMember&)>& apply) override { apply(members_.front()); }
  const render::SampleCounts& counts() const override { return first().film().counts(); }
  std::uint64_t batchesWithin(double /*seconds*/) const override { return 1; }
  std::uint64_t roundBatches() const override { return 1; }
  bool renderSamples(std::uint64_t count, const render::BatchProgress& progress) override {
    return first().renderBatch(static_cast<std::uint32_t>(count), progress);
  }
  bool renderCells(const std::vector<std::uint32_t>& limits, double /*seconds*/,
                   const render::BatchProgress& progress) override {
    return first().renderCells(limits, progress);
  }
  void join() override {}
  std::shared_ptr<FilmView> view() override { return std::make_shared<DeviceView>(first()); }
  render::ErrorEstimate estimateError() override {
    first().finish();
    return first().film().estimateError();
  }
  render::RayCount rays() override { return first().rays(); }
  std::vector<render::NotFinitePixels> notFinitePixels() override { return first().notFinitePixels(); }
  std::uint64_t skippedTraces() override { return first().skippedTraces(); }
  void finish() override { first().finish(); }
  void restoreFilm(render::FilmState state) override { first().restoreFilm(state); }
  void startAt(std::uint64_t batch) override { first().startAt(batch); }
  void restart() override { first().restart(); }
  std::vector<std::string> takeWarnings() override { return {}; }
};

}  // namespace

std::vector<render::FilmPlane> emptyPlanes(const program::Program& program) {
  std::vector<render::FilmPlane> planes;
  for (const program::Output& output : program.outputs) {
    render::FilmPlane& plane = planes.emplace_back();
    plane.name = output.name;
    plane.pixel = output.pixel;
    plane.kind = output.kind;
    plane.color = program::holdsColor(output);
  }
  return planes;
}

std::unique_ptr<DeviceTeam> teamOfOne(TeamMember member) { return std::make_unique<OneDevice>(std::move(member)); }

}  // namespace quintet::job
