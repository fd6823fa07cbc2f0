// The session's rendering as a film file: checkpoints and parts.
#include <utility>

#include <fmt/format.h>

#include "aov_notes.h"
#include "exr_camera.h"
#include "film_facts.h"
#include "film_guard.h"
#include "session.h"

namespace quintet::app {

const render::FilmFacts& Session::identity() {
  if (identity_.empty())
    identity_ = filmIdentity({program_, parameters_, renderer_->shaderHashes(), sceneInfo_.hash,
                              sceneInfo_.environmentHash, sceneInfo_.camera, sceneInfo_.size, renderer_->film()},
                             options_);
  return identity_;
}

render::FilmFile Session::film(const RenderOutcome& outcome) {
  fillRecord(outcome);
  render::FilmFacts notes = filmNotes(program_, options_, record_);
  notes.emplace_back("batch seconds", fmt::format("{:.6f}", outcome.batchSeconds));
  addAovNotes(notes, aovs_, sceneInfo_.names);
  addCameraNotes(notes, shownCamera(program_, sceneInfo_.camera, sceneInfo_.size));
  return {identity(), std::move(notes), renderer_->saveFilm(), outcome.plan};
}

void Session::writeFilm(const RenderOutcome& outcome) {
  progress_.stage("writing " + options_.output.string());
  const render::FilmFile file = film(outcome);
  // It was looked at for what was planned; this may be less.
  if (!options_.farm.force) refuseLoss(options_.output, file.identity, file.film.counts);
  writeBytes(options_.output, render::encodeFilm(file));
  record_.files = {options_.output.string()};
  record_.totalSeconds = clock_.seconds();
}

}  // namespace quintet::app
