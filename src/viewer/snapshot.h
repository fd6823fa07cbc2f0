// SPDX-License-Identifier: Apache-2.0
// What the window knows about its session at one moment.
#ifndef QUINTET_VIEWER_SNAPSHOT_H
#define QUINTET_VIEWER_SNAPSHOT_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "io/image.h"
#include "job/depth_map.h"
#include "job/interactive/session.h"
#include "program/description/program.h"
#include "viewer/scene_outline.h"

namespace quintet::viewer {

inline constexpr std::size_t kMaxMarkedPixels = 256;

// The state of the session at one moment. Objects behind pointers do not change.
struct Snapshot {
  enum class Phase {
    empty,    // nothing was opened
    loading,  // `stage` says what it does
    ready,
    failed,  // `error` says why; open() starts over
  };
  Phase phase = Phase::empty;
  std::string stage;  // with Phase::ready: of work before the next image; empty if it only renders
  std::string error;
  bool reopensAfterSave = false;  // with Phase::failed: as soon as a file of the program is saved
  bool hung = false;  // with Phase::failed: a launch did not end, and threads of the driver can still work on it

  // With Phase::ready.
  std::uint64_t session = 0;  // number of open() calls
  std::shared_ptr<const SceneOutline> scene;
  std::shared_ptr<const program::Program> program;
  std::shared_ptr<const program::ParameterValues> parameters;
  job::interactive::SessionState state;
  std::shared_ptr<const job::interactive::SessionRequest> request;
  std::string device;  // name
  scene::Camera camera;
  std::optional<job::interactive::OrbitCamera> navigation;  // unset for an orthographic camera
  bool canUndo = false, canRedo = false;
  std::string undoName, redoName;       // interactive::undoName() of the step
  bool animated = false;                // SetFrame has an effect
  bool countsFrames = false;            // `progress` and the limit of samples count frames
  std::vector<Diagnostic> diagnostics;  // of the program, or of its last version that did not compile
  bool outdatedProgram = false;         // the files of the program have errors: the version before them is shown

  std::shared_ptr<const io::Image> image;  // linear premultiplied RGBA floats; null before the first one
  std::uint64_t imageNumber = 0;           // changes with the image
  program::OutputKind outputKind = program::OutputKind::color;
  job::interactive::ImageUpdated progress;  // of the image
  double raysPerSecond = 0;                 // 0 if unknown
  // Samples that the program has discarded because they were not finite, and pixels with such a sample, at most
  // kMaxMarkedPixels. From time to time, and of the complete image.
  std::uint64_t droppedSamples = 0;
  std::vector<uvec2> droppedPixels;
  double secondsPerImage = 0;  // between the last two images
  std::string renderError;     // of the last Failed event, until the session restarts; else empty

  // Of the last explain(); null before the first one, and if the last one failed.
  std::shared_ptr<const job::PixelExplanation> explanation;
  bool explanationOutdated = false;  // the samples were discarded since
  // Its rays are those of the scene's camera (overlay::usesCamera()), and the program is still the same.
  bool explanationUsesCamera = false;
  bool explaining = false;  // an explain() is in progress

  bool callsPrint = false;                      // the program has calls of debugPrintfEXT
  std::optional<job::PrintRequest> print;       // the pixels that print; unset if none
  std::shared_ptr<const job::Printed> printed;  // since the last restart; null if nothing

  // With showDepth(true): of the view at full resolution; null until it is known, and after the view has changed.
  std::shared_ptr<const job::DepthMap> depth;
};

}  // namespace quintet::viewer
#endif
