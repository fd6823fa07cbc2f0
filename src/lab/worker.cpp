// SPDX-License-Identifier: Apache-2.0
#include "lab/worker.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/file_roots.h"
#include "base/parse.h"
#include "base/stopwatch.h"
#include "check/check.h"
#include "check/diagram/pipeline_model.h"
#include "check/scene_facts.h"
#include "gpu/error.h"
#include "io/codec.h"
#include "io/jpeg_encoder.h"
#include "job/device_limits.h"
#include "job/engine.h"
#include "job/instrumented_run.h"
#include "job/interactive/event_json.h"
#include "job/interactive/session.h"
#include "job/resolve.h"
#include "job/source_watcher.h"
#include "lab/file_downloads.h"
#include "lab/frame_channel.h"
#include "lab/image_message.h"
#include "lab/page_message.h"
#include "lab/pixel_mean.h"
#include "lab/private_folder.h"
#include "lab/program_files.h"
#include "lab/project_folder.h"
#include "lab/sandbox.h"
#include "lab/session_events.h"
#include "lab/session_video.h"
#include "lab/unsaved_program.h"
#include "lab/worker_control.h"
#include "lab/worker_process.h"
#include "output/plan.h"
#include "output/write.h"
#include "program/frame_dependence.h"
#include "program/load.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;
namespace interactive = job::interactive;

constexpr double kStepSeconds = 0.05;
constexpr double kWatchSeconds = 0.02;        // between checks for saved files
constexpr double kMovingSeconds = 0.3;        // after a command, images of reduced resolution are not interrupted
constexpr double kLosslessSeconds = 0.25;     // between two images at rest
constexpr double kStatisticsSeconds = 0.5;    // between two reports
constexpr double kAliveSeconds = 1.0;         // between two messages to the server
constexpr std::uint32_t kMaxUnconfirmed = 2;  // images that the page has not shown yet
constexpr int kJpegQuality = 85;
constexpr double kGraphSeconds = 0.4;               // after the first image of a version, if nothing was edited since
constexpr std::uint32_t kEndlessFrames = 1u << 24;  // of a program that counts frames

// Commands that keep the samples do not interrupt a batch.
bool isUrgent(const PageCommand& command) {
  if (std::holds_alternative<ImageReceived>(command) || std::holds_alternative<ReadValue>(command)) return false;
  const auto* edit = std::get_if<interactive::Command>(&command);
  return !edit || !(std::holds_alternative<interactive::SetExposure>(*edit) ||
                    std::holds_alternative<interactive::SetToneMap>(*edit) ||
                    std::holds_alternative<interactive::EndDrag>(*edit));
}

// Messages of the server, which a thread of its own receives.
class Inbox {
 public:
  explicit Inbox(FrameChannel& channel) : channel_(channel), thread_([this] { receive(); }) {}
  ~Inbox() { thread_.join(); }  // after the server has closed the socket
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  struct Message {
    std::variant<PageMessage, PageMessageError, ControlMessage> content;
  };
  // Of messages that were not taken. Then the server keeps the next ones, up to a limit of its own.
  static constexpr std::size_t kMaxBytes = std::size_t{4} << 20;

  // Waits for messages, up to `seconds`.
  std::vector<Message> take(double seconds) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return closed_ || !messages_.empty(); });
    urgent_ = false;
    bytes_ = 0;
    hasRoom_.notify_one();
    return std::exchange(messages_, {});
  }
  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }
  bool hasUrgent() const {
    const std::lock_guard lock(mutex_);
    return closed_ || urgent_;
  }

 private:
  void receive() {
    while (const std::optional<ChannelFrame> frame = channel_.read()) add(*frame);
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_one();
  }

  void add(const ChannelFrame& frame) {
    Message message;
    bool urgent = false;
    if (frame.kind == FrameKind::control) {
      message.content = parseControl(frame.data);
    } else {
      const auto parsed = parsePageMessage(frame.data);
      if (const auto* command = std::get_if<PageMessage>(&parsed)) {
        urgent = isUrgent(command->command);
        message.content = *command;
      } else {
        message.content = std::get<PageMessageError>(parsed);
      }
    }
    {
      std::unique_lock lock(mutex_);
      hasRoom_.wait(lock, [&] { return bytes_ < kMaxBytes; });
      bytes_ += frame.data.size() + sizeof message;
      messages_.push_back(std::move(message));
      urgent_ = urgent_ || urgent;
    }
    changed_.notify_one();
  }

  FrameChannel& channel_;
  mutable std::mutex mutex_;
  std::condition_variable changed_, hasRoom_;
  std::vector<Message> messages_;
  std::size_t bytes_ = 0;  // of messages_
  bool closed_ = false, urgent_ = false;
  std::thread thread_;  // last: it uses the members above
};

class Worker : public job::Observer {
 public:
  // `folder`: for temporary files.
  Worker(FrameChannel& channel, WorkerSettings settings, const fs::path& folder)
      : channel_(channel),
        settings_(std::move(settings)),
        project_(settings_.folder, settings_.files),
        folder_(folder),
        inbox_(channel) {}

  int run() {
    openEngine();
    while (!inbox_.closed()) {
      const double wait =
          session_ && !isResting() ? std::min(kWatchSeconds, session_->secondsUntilWork()) : kWatchSeconds;
      const std::vector<Inbox::Message> messages = inbox_.take(wait);
      const auto lastOpen = std::find_if(messages.rbegin(), messages.rend(), opens).base();
      for (auto message = messages.begin(); message != messages.end(); ++message) {
        // A user who switches programs quickly waits for the last one only.
        if (opens(*message) && message + 1 != lastOpen)
          skip(*message);
        else
          handle(*message);
      }
      if (retry_ && (retryDue_ || retryWatcher_->pending())) {
        retryWatcher_->wait(0);
        const OpenSession again = *retry_;
        guarded("", [&] { open(again); });
      }
      guarded("", [&] { startGraph(); });
      if (session_ && !guarded("", [&] { work(); }) && session_) {  // it would fail again and again
        session_.reset();
        retryAfterSave(opened_, {});
      }
      reportState();
      reportAlive();
    }
    // Destroying the device takes time, and nothing needs it: the process ends.
    std::_Exit(0);
  }

 private:
  // ---- Observer: what the session reports while it works

  void stage(const std::string& text) override {
    send(messageJson("stage", text, "text"));
    reportLoad();
  }
  void warning(const std::string& text) override { send(messageJson("warning", text)); }
  // The device still uses its objects, so the process ends without destroying them.
  void deviceHung(const Diagnostic& diagnostic) override {
    channel_.write(FrameKind::control, controlJson({Control::hung, diagnostic.text}));
    std::_Exit(kHungStatus);
  }

  void send(const std::string& json) { channel_.write(FrameKind::text, json); }

  void openEngine() {
    if (graph_.valid()) graph_.wait();  // it uses the compiler
    engine_ = std::make_unique<job::Engine>(
        job::EngineOptions{.device = settings_.device, .log = [this](LogLevel level, const std::string& text) {
                             if (level == LogLevel::warning) send(messageJson("warning", text));
                           }});
  }

  // ---- Messages

  void handle(const Inbox::Message& message) {
    if (const auto* control = std::get_if<ControlMessage>(&message.content)) {
      hold_ = control->message;
      return;
    }
    if (const auto* error = std::get_if<PageMessageError>(&message.content)) {
      send(withId(messageJson("error", error->message), error->id));
      return;
    }
    const auto& page = std::get<PageMessage>(message.content);
    const bool answered =
        guarded(page.id, [&] { std::visit([&](const auto& value) { execute(value, page.id); }, page.command); });
    if (answered && !page.id.empty()) send(withId(R"({"event":"done"})", page.id));
  }

  static bool opens(const Inbox::Message& message) {
    const auto* parsed = std::get_if<PageMessage>(&message.content);
    return parsed && std::holds_alternative<OpenSession>(parsed->command);
  }

  void skip(const Inbox::Message& message) {
    hold_.reset();
    const std::string& id = std::get<PageMessage>(message.content).id;
    if (!id.empty()) send(withId(messageJson("error", "a later 'open' replaces this one"), id));
  }

  void execute(const OpenSession& command, const std::string& /*id*/) {
    discardGraphs();
    send(openingJson(command.number));
    const std::optional<std::string> hold = std::exchange(hold_, std::nullopt);
    if (!hold) return open(command);
    session_.reset();
    loadTime_ = parseNumber<double>(*hold).value_or(0);
    retryAfterSave(command, {});
  }

  static bool savedSince(const job::WatchList& list, double seconds) {
    const auto isNew = [&](const fs::path& file) {
      std::error_code error;
      const fs::file_time_type time = fs::last_write_time(file, error);
      return !error && secondsSince1970(std::chrono::file_clock::to_sys(time)) > seconds;
    };
    if (std::ranges::any_of(list.files, isNew)) return true;
    for (const fs::path& folder : list.folders) {
      std::error_code error;
      for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
        if (job::isProgramSource(entry.path().filename()) && isNew(entry.path())) return true;
    }
    return false;
  }

  template <class Time>
  static double secondsSince1970(Time time) {
    return std::chrono::duration<double>(time.time_since_epoch()).count();
  }

  void execute(const interactive::Command& command, const std::string& /*id*/) {
    if (const auto* program = std::get_if<interactive::SetProgram>(&command)) return openProgram(program->name);
    interactive::Session& session = requireSession();
    checkFiles(command);
    if (!std::holds_alternative<interactive::EndDrag>(command)) lastCommand_ = clock_.seconds();
    if (std::holds_alternative<interactive::Rewind>(command)) until_ = 0;
    session.apply(command);
  }

  void execute(const ImageReceived& command, const std::string& /*id*/) {
    confirmed_ = std::clamp(command.image, confirmed_, sent_);
  }

  void execute(const PauseSession& command, const std::string& /*id*/) {
    paused_ = command.on;
    until_ = 0;
  }
  void execute(const DescribeGraph& /*command*/, const std::string& id) { describeGraph(id); }
  // Other commands wait. It uses the device between two calls of the session, and keeps nothing of it.
  void execute(const InstrumentProgram& /*command*/, const std::string& /*id*/) {
    const interactive::Session& session = requireSession();
    job::RenderRequest request = interactive::withState({}, session.state()).render;
    request.size = {};
    request.limits = {};
    request.launchTimeout = settings_.defaults.timeout;
    const program::Program program = program::loadProgram(loadedName(opened_));  // without heat maps
    instrumented_ = job::runInstrumented(*engine_, program, session.scene(), request,
                                         [this](const Diagnostic& diagnostic) { deviceHung(diagnostic); });
    sendDiagnostics(session.diagnostics(), false);
  }

  void execute(const RestartWorker& /*command*/, const std::string& /*id*/) {}  // by the server

  void execute(const AdvanceFrames& command, const std::string& /*id*/) {
    requireSession();
    paused_ = true;
    until_ = command.until;
    if (until_ > 0 || still_)
      batches_ = 0;
    else
      batches_ += command.count;
  }

  void execute(const PickPixel& command, const std::string& id) {
    interactive::Session& session = requireSession();
    const auto picked = session.pick(command.pixel);
    send(withId(interactive::pickedJson(command.pixel, picked, session.instanceNames(), session.materialNames()), id));
  }

  void execute(const ReadValue& command, const std::string& id) {
    interactive::Session& session = requireSession();
    const uvec2 size = session.state().size;
    if (command.pixel.x >= size.x || command.pixel.y >= size.y)
      throw UsageError(fmt::format("pixel {},{} is not inside the image of {}x{}", command.pixel.x, command.pixel.y,
                                   size.x, size.y));
    if (command.size.x > size.x - command.pixel.x || command.size.y > size.y - command.pixel.y)
      throw UsageError(fmt::format("the {}x{} pixels at {},{} are not inside the image of {}x{}", command.size.x,
                                   command.size.y, command.pixel.x, command.pixel.y, size.x, size.y));
    if (progress_.samples == 0) throw UsageError("there is no image yet");
    if (!values_) values_ = session.linearImage();
    const uvec2 shown(values_->width, values_->height);  // a preview is smaller
    const uvec2 begin = min(command.pixel / progress_.factor, shown - 1u);
    const uvec2 blockSize = min(max(command.size / progress_.factor, uvec2(1)), shown - begin);
    send(withId(valueJson(command.pixel, pixelMean(*values_, begin, blockSize)), id));
  }

  void execute(const ExplainSample& command, const std::string& id) {
    const job::PixelExplanation explanation = requireSession().explain(command.pixel, command.sample);
    send(withId(interactive::explainedJson(explanation, ""), id));
  }

  void execute(const ExportExr& /*command*/, const std::string& id) {
    interactive::Session& session = requireSession();
    if (!session.hasFullSize()) throw UsageError("there is no image at full resolution yet");
    output::OutputRequest request{.file = downloads_.pathFor("exr"), .output = session.state().output};
    request.exr = output::ExrFormat{.colors = io::ExrType::f32};
    output::writeOutputs(output::planOutputs(request, session.program()), session.result(), *this);
    send(withId(downloads_.offer(request.file, "image.exr", "image/x-exr"), id));
  }

  // Other commands wait until the video is complete. A page that closes the connection ends this process.
  void execute(const RenderVideo& command, const std::string& id) {
    const fs::path file = downloads_.pathFor(command.format);
    SessionVideo video(requireSession(), command, file);
    const auto interrupted = [&] {
      reportAlive();
      return inbox_.closed();
    };
    do {
      if (!video.addFrame(interrupted)) return;
      send(withId(progressJson(video.frames(), command.frames), id));
    } while (!video.isComplete());
    video.finish(*this);
    const std::string type = command.format == "gif" ? "image/gif" : "video/" + command.format;
    send(withId(downloads_.offer(file, "video." + command.format, type), id));
  }

  void execute(const ReadFilePart& command, const std::string& /*id*/) {
    channel_.write(FrameKind::binary, downloads_.part(command.file, command.offset));
  }

  interactive::Session& requireSession() {
    if (!session_) throw UsageError("no program is open");
    return *session_;
  }

  // Sends an error as the answer to the message `id`, and returns whether there was none.
  template <class Function>
  bool guarded(const std::string& id, const Function& function) {
    const auto fail = [&](const std::exception& error) {
      send(withId(messageJson("error", error.what()), id));
      return false;
    };
    try {
      function();
      return true;
    } catch (const ProgramError& error) {
      sendDiagnostics(error.diagnostics(), session_ != nullptr);
      return fail(error);
    } catch (const TimeoutError& error) {  // deviceHung() has ended the process
      return fail(error);
    } catch (const DeviceLostError& error) {
      if (session_ && session_->recoverFrom(error)) return true;
      if (!session_) openEngine();  // its device stays lost
      return fail(error);
    } catch (const gpu::NoDeviceError& error) {
      if (!session_) openEngine();  // the devices can change
      return fail(error);
    } catch (const std::exception& error) {
      return fail(error);
    }
  }

  // ---- Opening

  void open(const OpenSession& command) {
    reportLoad();
    retry_.reset();
    retryDue_ = false;
    session_.reset();
    progress_ = {};
    imagePending_ = false;
    try {
      start(command);
    } catch (const ProgramError& error) {
      retryAfterSave(command, error.diagnostics());
      describeRejected(loadedName(command));
      throw;
    } catch (const NameError&) {
      throw;
    } catch (const FileError& error) {
      retryAfterSave(command, {asDiagnostic(error)});
      throw ProgramError({asDiagnostic(error)});
    } catch (const UsageError&) {  // such as an output that the program does not have yet
      retryAfterSave(command, {});
      throw;
    }
  }

  // The name for program::loadProgram().
  std::string loadedName(const OpenSession& command) const {
    return unsaved_ ? unsaved_->folder().string() : command.program;
  }

  void start(const OpenSession& command) {
    unsaved_ = command.files.empty() ? nullptr : std::make_unique<UnsavedProgram>(folder_, command.files);
    discardGraphs();
    if (!unsaved_) loadableName(project_, command.program);  // throws
    interactive::SessionRequest request;
    request.program = loadedName(command);
    if (!command.scene.empty()) {
      project_.locate(command.scene);  // throws
      request.render.scene = command.scene;
    }
    const program::Program loaded = program::loadProgram(request.program);
    request.render.size = command.size.value_or(settings_.defaults.size);
    const bool frames = loaded.accumulation == program::Accumulation::program;
    request.render.limits.samples = command.samples.value_or(frames ? kEndlessFrames : settings_.defaults.samples);
    request.render.launchTimeout = settings_.defaults.timeout;
    request.render.seed = command.seed;
    request.drafts = true;  // a crash of the driver ends only this process
    request.render.assignments = knownParameters(loaded, command);
    if (command.camera) request.render.camera = *command.camera;
    session_ = std::make_unique<interactive::Session>(
        *engine_, std::move(request), [this] { return clock_.seconds(); }, *this);
    opened_ = command;
    showed_.clear();
    reportOpened();
    applyDisplay(command);
  }

  // The program that the session shows, after it was opened or loaded again.
  void reportOpened() {
    still_ = countsFrames() && !session_->isAnimated() && !program::framesCanDiffer(session_->program());
    findings_.clear();
    instrumented_.clear();
    send(openedJson(*session_, opened_.program, opened_.scene, engine_->context().info().name));
    sendDiagnostics(session_->diagnostics(), false);
    graphOutdated_ = true;
  }

  // Problems of the program, with what its images have shown.
  void sendDiagnostics(std::vector<Diagnostic> diagnostics, bool outdated) {
    rejected_ = hasErrors(diagnostics);
    for (const auto* found : {&findings_, &instrumented_})
      if (!rejected_) diagnostics.insert(diagnostics.end(), found->begin(), found->end());
    send(diagnosticsJson(diagnostics, outdated));
  }

  // Those that the program has and accepts: a page can have values for an older version.
  std::vector<std::string> knownParameters(const program::Program& loaded, const OpenSession& command) {
    program::ParameterValues values(loaded.parameters);
    std::vector<std::string> assignments;
    for (const auto& [name, value] : command.parameters) {
      const auto known = std::ranges::find(loaded.parameters, name, &program::Parameter::name);
      if (known == loaded.parameters.end()) continue;
      try {
        if (known->type == program::ParameterType::image) checkImage(value);
        values.set(name, value);
        assignments.push_back(name + "=" + value);
      } catch (const UsageError& error) {
        send(messageJson("warning", error.what()));
      }
    }
    return assignments;
  }

  void applyDisplay(const OpenSession& command) {
    using namespace interactive;
    const auto apply = [&](const Command& edit) {
      try {
        session_->apply(edit);
      } catch (const UsageError& error) {  // the output of an older version
        send(messageJson("warning", error.what()));
      }
    };
    if (!command.output.empty() && command.output != session_->state().output) apply(SelectOutput{command.output});
    if (command.exposure != 0) apply(SetExposure{command.exposure});
    if (const auto toneMap = render::toneMapByName(command.toneMap)) apply(SetToneMap{toneMap});
    if (command.frame && session_->isAnimated()) apply(SetFrame{*command.frame});
  }

  // The same view with a different program.
  void openProgram(const std::string& program) {
    OpenSession next = opened_;
    next.program = program;
    next.parameters.clear();
    next.output.clear();
    next.samples.reset();
    if (session_) {
      next.size = session_->state().size;
      if (!session_->camera().orthographic && session_->state().camera.lookFrom) next.camera = session_->state().camera;
    }
    open(next);
  }

  void retryAfterSave(const OpenSession& command, const std::vector<Diagnostic>& diagnostics) {
    job::WatchList files;
    if (command.files.empty() && !isBuiltIn(command.program)) files.addProgram(command.program);
    files.addDiagnosed(diagnostics);
    if (files.files.empty() && files.folders.empty()) return;
    retryWatcher_.emplace().watch(std::move(files));
    retry_ = command;
    // A user can have corrected the program while it was loaded, or while the worker before this one still ran.
    retryDue_ = savedSince(retryWatcher_->watched(), loadTime_);
  }

  // Files that a command names must be in the project.
  void checkFiles(const interactive::Command& command) const {
    if (const auto* environment = std::get_if<interactive::SetEnvironment>(&command)) {
      const std::string source = environment->source.value_or("");
      const bool isColor = !source.empty() && source.find_first_not_of("0123456789.,eE+-") == source.npos;
      if (!source.empty() && source != "none" && source != "default" && !isColor) project_.locate(source);
    } else if (const auto* set = std::get_if<interactive::SetParameter>(&command)) {
      const auto& parameters = session_->program().parameters;
      const auto known = std::ranges::find(parameters, set->name, &program::Parameter::name);
      if (known != parameters.end() && known->type == program::ParameterType::image) checkImage(set->value);
    }
  }
  void checkImage(const std::string& file) const {
    if (!file.empty()) project_.locate(file);
  }

  // ---- Rendering

  // The image shows the last change, and no other frame is wanted: it is paused, or all frames are equal.
  bool isResting() {
    const bool isShown = progress_.factor == 1 && progress_.samples > 0;
    return isShown && (still_ || (paused_ && batches_ == 0 && progress_.samples >= until_)) && !session_->hasChange();
  }

  void work() {
    if (!isResting()) {
      const bool moving = isMoving();
      const auto interrupted = [&] {
        reportAlive();
        return inbox_.closed() || (!moving && inbox_.hasUrgent());
      };
      report(session_->step(paused_ || still_ ? 0.0 : kStepSeconds, interrupted));
    } else if (session_->restarts() != restarts_) {
      progress_ = {};  // an edit: render one image
    }
    restarts_ = session_->restarts();
    sendImage();
    reportStatistics();
    if (graphOutdated_ && progress_.factor == 1 && progress_.samples > 0 && !isMoving()) {
      graphOutdated_ = false;
      requestGraph(session_->program(), check::sceneFacts(session_->scene()), kGraphSeconds);
    }
  }

  bool countsFrames() const { return session_->program().accumulation == program::Accumulation::program; }
  bool isMoving() const { return clock_.seconds() - lastCommand_ < kMovingSeconds; }

  void report(const std::vector<interactive::Event>& events) {
    for (const interactive::Event& event : events) {
      if (const auto* image = std::get_if<interactive::ImageUpdated>(&event)) {
        if (image->samples != progress_.samples && image->factor == 1 && batches_ > 0) --batches_;
        progress_ = *image;
        if (still_ && progress_.factor == 1) progress_.complete = true;
        imagePending_ = true;
        values_.reset();
      } else if (const auto* found = std::get_if<interactive::DiagnosticsFound>(&event)) {
        sendDiagnostics(found->diagnostics, hasErrors(found->diagnostics));
        if (hasErrors(found->diagnostics))
          describeRejected(loadedName(opened_));
        else
          graphOutdated_ = true;  // the version before an error is back
      } else {
        if (std::holds_alternative<interactive::Restarted>(event)) {
          progress_ = {};
          imagePending_ = false;
          if (!rejected_ && !std::exchange(instrumented_, {}).empty()) sendDiagnostics(session_->diagnostics(), false);
        }
        send(interactive::eventJson(event));
      }
      if (std::holds_alternative<interactive::ProgramReloaded>(event)) reportOpened();
    }
  }

  // While something moves or frames play, each image is sent as soon as the page has shown the ones before. At rest, some are sent
  // without loss, and always the last one.
  void sendImage() {
    const bool plays = countsFrames() && !paused_ && !progress_.complete;
    const bool atRest = progress_.factor == 1 && !isMoving() && !plays;
    if (!imagePending_ && !(lossyShown_ && atRest)) return;
    if (progress_.samples == 0 || sent_ - confirmed_ >= kMaxUnconfirmed) return;
    const double now = clock_.seconds();
    if (atRest && !progress_.complete && !isResting() && now - lastLossless_ < kLosslessSeconds) return;
    const io::Image image = session_->image();
    const ImageHeader header{.number = ++sent_,
                             .size = {image.width, image.height},
                             .factor = progress_.factor,
                             .samples = static_cast<std::uint32_t>(progress_.samples),
                             .format = atRest ? ImageFormat::png : ImageFormat::jpeg,
                             .complete = progress_.complete};
    send(imageJson(progress_, header.number));
    channel_.write(FrameKind::binary,
                   imageMessage(header, atRest ? io::encodePng(image) : io::encodeJpeg(image, kJpegQuality)));
    if (atRest) lastLossless_ = now;
    imagePending_ = false;
    lossyShown_ = !atRest;
  }

  void reportStatistics() {
    const double now = clock_.seconds();
    if (progress_.factor != 1 || progress_.samples == 0 || isMoving()) return;
    if (progress_.samples == reported_.samples && progress_.seconds == reported_.seconds) return;
    if (!progress_.complete && now - lastStatistics_ < kStatisticsSeconds) return;
    lastStatistics_ = now;
    reported_ = progress_;
    Statistics statistics{.samples = progress_.samples, .frames = countsFrames(), .seconds = progress_.seconds};
    if (progress_.seconds > 0)
      statistics.raysPerSecond = static_cast<double>(session_->rays().rays) / progress_.seconds;
    const job::RenderResult result = session_->result();
    if (!statistics.frames && result.error.known()) statistics.error = result.error.upper;
    send(statisticsJson(statistics));
    reportFindings(job::runFindings(result));
  }

  // Counts grow with the frames: a list of the same problems is sent again only for the last image.
  void reportFindings(std::vector<Diagnostic> findings) {
    const auto areEqual = [&](auto member) { return std::ranges::equal(findings, findings_, {}, member, member); };
    const bool isLast = progress_.complete || isResting();
    if (rejected_ || (areEqual(&Diagnostic::id) && (!isLast || areEqual(&Diagnostic::text)))) return;
    findings_ = std::move(findings);
    sendDiagnostics(session_->diagnostics(), false);
  }

  // The graph of a program with a scene's facts, as an event. The check reads the program as it is compiled for the device,
  // without a scene's definitions, so that all stages appear.
  static std::string graphOf(const program::Program& program, const shader::Compiler& compiler,
                             const std::optional<program::SceneFacts>& facts, const check::DeviceLimits& limits) {
    const program::SceneFacts* scene = facts ? &*facts : nullptr;
    const check::CheckResult result = check::check(program, compiler, scene, limits);
    const auto model = check::describePipeline(program, compiler, scene, result);
    return model ? graphJson(check::pipelineJson(*model)) : "";
  }

  void describeGraph(const std::string& id) {
    const interactive::Session& session = requireSession();
    const std::string graph = graphOf(session.program(), engine_->compiler(), check::sceneFacts(session.scene()),
                                      job::deviceLimits(engine_->context().info()));
    if (!graph.empty()) send(withId(graph, id));
  }

  // Compiling all stages again can take seconds, so it happens on a thread, after a pause: a user who continues to type
  // does not wait for the graph of an older version.
  void requestGraph(program::Program program, std::optional<program::SceneFacts> facts, double pause) {
    wantedGraph_ = WantedGraph{std::move(program), std::move(facts), clock_.seconds() + pause};
    ++graphVersion_;
  }

  // Those of the program that was open before are not sent.
  void discardGraphs() {
    wantedGraph_.reset();
    ++graphVersion_;
  }

  void startGraph() {
    if (!wantedGraph_ || clock_.seconds() < wantedGraph_->notBefore) return;
    if (graph_.valid() && graph_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    WantedGraph wanted = std::move(*wantedGraph_);
    wantedGraph_.reset();
    graph_ = std::async(std::launch::async,
                        [this, wanted = std::move(wanted), version = graphVersion_.load(),
                         &compiler = engine_->compiler(), limits = job::deviceLimits(engine_->context().info())] {
                          try {
                            const std::string graph = graphOf(wanted.program, compiler, wanted.facts, limits);
                            if (!graph.empty() && version == graphVersion_.load()) send(graph);
                          } catch (const Error&) {  // its diagnostics were sent
                          }
                        });
  }

  // The graph of a version that compiles, but does not pass the check: it marks what the diagnostics name.
  void describeRejected(const std::string& program) {
    try {
      std::optional<program::SceneFacts> facts;
      if (session_) facts = check::sceneFacts(session_->scene());
      requestGraph(program::loadProgram(program), std::move(facts), 0);
    } catch (const Error&) {  // its diagnostics were sent
    }
  }

  void reportState() {
    if (!session_) return;
    std::string state = stateJson(*session_, opened_.program, paused_, still_);
    if (state == showed_) return;
    send(state);
    showed_ = std::move(state);
  }

  void reportLoad() {
    loadTime_ = secondsSince1970(std::chrono::system_clock::now());
    channel_.write(FrameKind::control, controlJson({Control::loads, fmt::format("{}", loadTime_)}));
  }

  void reportAlive() {
    const double now = clock_.seconds();
    if (now - lastAlive_ < kAliveSeconds) return;
    lastAlive_ = now;
    channel_.write(FrameKind::control, controlJson({Control::alive, ""}));
  }

  struct WantedGraph {
    program::Program program;
    std::optional<program::SceneFacts> facts;
    double notBefore = 0;  // on clock_
  };

  FrameChannel& channel_;
  const WorkerSettings settings_;
  const ProjectFolder project_;
  const Stopwatch clock_;
  const fs::path folder_;
  FileDownloads downloads_{folder_};
  std::unique_ptr<job::Engine> engine_;
  std::unique_ptr<UnsavedProgram> unsaved_;  // that the session shows
  std::unique_ptr<interactive::Session> session_;
  OpenSession opened_;                // of the session
  std::optional<OpenSession> retry_;  // failed; repeated when one of the files is saved
  std::optional<job::SourceWatcher> retryWatcher_;
  bool retryDue_ = false;                 // a file was saved before it was watched
  double loadTime_ = 0;                   // of the last attempt to load the program, seconds since 1970
  std::optional<std::string> hold_;       // message of Control::hold
  bool still_ = false;                    // all frames of the program are equal
  std::vector<Diagnostic> findings_;      // of the images of the program
  std::vector<Diagnostic> instrumented_;  // of the run-time checks since the last restart
  bool rejected_ = false;                 // the last diagnostics have errors
  bool paused_ = false;
  std::uint64_t batches_ = 0;  // to render while paused
  std::uint64_t until_ = 0;    // frames to render while paused; 0: batches_ decides
  std::uint64_t restarts_ = 0;
  bool graphOutdated_ = false;
  std::optional<WantedGraph> wantedGraph_;
  std::atomic<std::uint64_t> graphVersion_ = 0;    // changes when an earlier graph is outdated
  interactive::ImageUpdated progress_, reported_;  // of the last image, and in the last statistics
  bool imagePending_ = false;                      // the last image was not sent
  bool lossyShown_ = false;                        // the last one that was sent is a JPEG
  std::optional<io::Image> values_;                // Session::linearImage() of the last image
  std::uint32_t sent_ = 0, confirmed_ = 0;
  std::string showed_;                                                                          // the last state
  double lastCommand_ = -1e9, lastLossless_ = -1e9, lastStatistics_ = -1e9, lastAlive_ = -1e9;  // on clock_
  std::future<void> graph_;  // that is being made; its thread uses the members above
  Inbox inbox_;              // last: its thread
};

// Gives up what a session does not need. Shaders of a CPU can do what this process can.
void contain(const WorkerSettings& settings, const fs::path& folder) {
  // Stacks of the compiler and arenas of allocators reserve more than they use; the server watches what is used.
  constexpr std::uint64_t kReserved = std::uint64_t{8} << 30;
  SandboxRules rules{.memory = settings.memory > 0 ? settings.memory + kReserved : 0};
  rules.readable.emplace_back(settings.folder);
  const FileRoots roots = FileRoots::fromEnvironment();
  for (const fs::path& root : roots.folders()) rules.readable.push_back(root);
  if (const char* library = std::getenv("QUINTET_SHADER_PATH")) rules.readable.emplace_back(library);
  rules.writable.push_back(folder);
  // A cache that other programs use could contain code for them.
  if (fs::path caches = cacheFolder(); !caches.empty()) {
    caches /= "lab";
    std::error_code error;
    fs::create_directories(caches, error);
    for (const char* variable :
         {"QUINTET_CACHE_DIR", "XDG_CACHE_HOME", "MESA_SHADER_CACHE_DIR", "__GL_SHADER_DISK_CACHE_PATH"})
      ::setenv(variable, caches.c_str(), 1);
    rules.writable.push_back(caches);
  }
  ::setenv("TMPDIR", folder.c_str(), 1);
  endBySignals();
  enterSandbox(rules);
}

}  // namespace

int runWorker(int socket) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // the terminal sends it to all processes; the server ends its workers
  FrameChannel channel(socket);
  const std::optional<ChannelFrame> first = channel.read();
  if (!first) return 0;
  WorkerSettings settings = parseSettings(first->data);
  fs::current_path(settings.folder);  // so that names in the project are paths
  const PrivateFolder folder(static_cast<pid_t>(settings.process));
  addFileRoot(folder.path());
  if (settings.contained) contain(settings, folder.path());
  return Worker(channel, std::move(settings), folder.path()).run();
}

}  // namespace quintet::lab
