// SPDX-License-Identifier: Apache-2.0
// What a running job reports to its front end, and how the front end stops it.
#ifndef QUINTET_JOB_OBSERVER_H
#define QUINTET_JOB_OBSERVER_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"

namespace quintet::job {

struct Provenance;
struct RenderResult;

// State of a render between two launches.
struct Progress {
  double samples = 0;         // per pixel, with the finished fraction of the current batch; or frames
  double seconds = 0;         // since rendering started, earlier sessions of a resumed render included
  double raysPerSecond = 0;   // 0 if unknown
  bool countsFrames = false;  // `samples` and `sampleLimit` count frames
  std::optional<std::uint64_t> sampleLimit;
  std::optional<double> secondLimit;
  std::optional<double> error;          // stated relative error; infinite if unknown
  std::optional<double> targetSamples;  // probable `samples` when the target error is reached; unset if unknown

  double fraction() const;     // of the limit that is reached first, [0,1]; 0 without limits
  double secondsLeft() const;  // infinity if unknown
};

// A batch is complete, or a frame of a program that accumulates.
struct BatchReport {
  std::uint64_t samples = 0;  // per pixel, so far; or frames
  double seconds = 0;
  std::optional<std::uint64_t> checkpointSamples;  // in the checkpoint on disk; unset without checkpoints
};

// What an invocation printed.
struct PrintedLine {
  uvec2 pixel{0};                       // of the whole image
  std::optional<std::uint32_t> frame;   // of an animation, or of a program that accumulates
  std::optional<std::uint32_t> sample;  // of the pixel, unless the program accumulates
  SourceLocation location;              // of the debugPrintfEXT: in the stage's file or an included one
  std::string stage;                    // file of the stage
  std::string text;                     // without the end of the line; can contain others
};

// Lines by pixel (row by row), then by sample, then in the order of the calls.
struct Printed {
  std::vector<PrintedLine> lines;
  // Further ones, because of the limit or because the device could not store them.
  std::uint64_t omitted = 0;
  // Of these, those that the device could not store. Which ones it stored can then differ in each run.
  std::uint64_t notStored = 0;
};

enum class StopRequest {
  none,
  finish,   // complete the current batch and return what there is
  abandon,  // return at once; the result is incomplete and must not be used
};

// The text of Observer::stage() before the driver compiles shaders. Neither the driver nor the job answers until that is done.
inline constexpr const char* kCompilingStage = "compiling shaders";

// Calls come from the thread that runs the job, except warning(), which any thread may call.
class Observer {
 public:
  virtual ~Observer() = default;

  virtual void stage(const std::string& /*text*/) {}  // a step of unknown length has started: "loading scene.glb"
  virtual void note(const std::string& /*text*/) {}   // information about a decision
  virtual void warning(const std::string& /*text*/) {}
  // Warnings of the compiler and of the check. Errors are thrown as ProgramError.
  virtual void diagnostics(const std::vector<Diagnostic>& /*found*/) {}
  // With RenderRequest::print: what the program printed since the last call. After each batch or frame that printed.
  virtual void printed(const Printed& /*prints*/) {}
  // The program has calls of debugPrintfEXT, and the request does not ask for their text. Once per job.
  virtual void printsDisabled() {}
  virtual void progress(const Progress& /*state*/) {}
  virtual void batch(const BatchReport& /*report*/) {}
  // True asks for Progress::error also without a target error. The estimate takes up to 2 % of the time.
  virtual bool showsError() const { return false; }

  // With FrameRequest::every and CheckpointRequest::resume, before each frame: true if its images were written by an
  // earlier run with the same request, so that the frame is skipped. `frame`: identity, limits and number of the frame.
  virtual bool isFrameWritten(const Provenance& /*frame*/) { return false; }
  // With FrameRequest::every: a frame is complete.
  virtual void frame(const RenderResult& /*result*/) {}
  // True asks for preview(): of the first batch of a film; of frames that are not written, one per second.
  virtual bool wantsPreviews() const { return false; }
  virtual void preview(const RenderResult& /*result*/) {}

  virtual StopRequest stopRequested() { return StopRequest::none; }
  // Asked several times per second while a job is constructed, and while a render loads the scene again after an edit. True
  // ends that with CanceledError, but not a call of the driver.
  virtual bool cancelsPreparation() { return false; }

  // Replaces a file in one step. The default is quintet::writeFile; a command-line program also blocks signals meanwhile.
  virtual void write(const std::filesystem::path& file, std::span<const std::byte> bytes);

  // A launch did not end in time. The device still works on it, so destroying GPU objects would block: a program
  // should report this and exit without unwinding. If this function returns, TimeoutError propagates.
  virtual void deviceHung(const Diagnostic& /*diagnostic*/) {}
};

}  // namespace quintet::job
#endif
