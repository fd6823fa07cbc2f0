// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/suggestion.h"
#include "job/interactive/light_properties.h"
#include "job/interactive/material_properties.h"
#include "job/view.h"
#include "program/heat.h"
#include "program/load.h"
#include "render/tone_map/false_color.h"
#include "scene/animation/animated_bounds.h"
#include "scene/animation/keyframes.h"
#include "scene/animation/pose.h"
#include "scene/model/mesh_bounds.h"
#include "scene/model/names.h"

namespace quintet::job::interactive {
namespace {

constexpr std::uint32_t kDefaultSamples = 64;
constexpr double kQuietSeconds = 0.2;  // after the last command, the image becomes sharper
constexpr double kStableSeconds = 60;  // of rendering, after which a loss of the device is not a repetition
// A driver can need some time after a reset. The first attempt to open the device does not wait.
constexpr std::chrono::milliseconds kReopenPause{250};

// By the kind of device.
struct Pace {
  double updatesPerSecond;  // while something moves
  double launchSeconds;     // an interruption waits for a launch
};
constexpr Pace kPaceOfCpu{12, 0.05}, kPaceOfGpu{90, 0.01};

const Pace& paceOf(Engine& engine) { return engine.context().info().software ? kPaceOfCpu : kPaceOfGpu; }

ResolvedJob resolveSession(const SessionRequest& session, const std::shared_ptr<const scene::Scene>& scene,
                           const Bounds3& bounds, SceneSource source, program::Program program, double launchSeconds) {
  RenderRequest request = session.render;
  request.bounds = bounds;
  request.loadedScene = scene;
  request.editable = true;
  if (!(request.launchSeconds > 0)) request.launchSeconds = launchSeconds;
  const auto samples = static_cast<std::uint32_t>(request.limits.samples.value_or(kDefaultSamples));
  request.limits = {};
  request.limits.samples = samples;
  request.frames = {};
  request.frames.accumulated = samples;
  ResolvedJob job = resolve(std::move(request), std::move(program));
  source.loaded = scene;
  job.scene = std::move(source);
  return job;
}

// With the heat maps, so that they can be selected.
program::Program loadForSession(const std::string& name) {
  return program::withAllHeatMaps(program::loadProgram(name));
}

// A state for an edited version of its program, without what this version does not have or accept.
struct Fitted {
  SessionState state;
  std::vector<std::string> warnings;  // what was left out
};

Fitted fittedTo(const program::Program& edited, SessionState state) {
  Fitted result;
  program::ParameterValues values(edited.parameters);
  std::erase_if(state.assignments, [&](const std::string& assignment) {
    try {
      values.setAssignment(assignment);
      return false;
    } catch (const UsageError& error) {
      result.warnings.push_back(fmt::format("'{}' no longer applies: {}", assignment, error.what()));
      return true;
    }
  });
  const std::vector<std::string> outputs = program::outputNames(edited);
  if (!outputs.empty() && std::ranges::find(outputs, state.output) == outputs.end()) {
    result.warnings.push_back(
        fmt::format("the output '{}' no longer exists; showing '{}'", state.output, outputs.front()));
    state.output = outputs.front();
  }
  result.state = std::move(state);
  return result;
}

std::size_t indexOf(const std::string& name, const std::vector<std::string>& names, const char* kind) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw UsageError(fmt::format("{} '{}' not found{}", kind, name, suggestionOrList(name, names)));
  return static_cast<std::size_t>(found - names.begin());
}

// The optional outputs that must be rendered to show this one. Throws UsageError if it does not exist.
std::vector<std::string> outputsFor(const program::Program& program, const std::string& output) {
  const std::size_t index = indexOf(output, program::outputNames(program), "output");
  return program.outputs[index].optional ? std::vector<std::string>{output} : std::vector<std::string>{};
}

// Those whose values differ, or that only one of the maps has. A scene can have 10⁶ objects, of which few are edited.
template <class Value>
std::vector<std::size_t> changedKeys(const std::map<std::size_t, Value>& a, const std::map<std::size_t, Value>& b) {
  std::vector<std::size_t> keys;
  for (const auto& [key, value] : a)
    if (const auto found = b.find(key); found == b.end() || !(found->second == value)) keys.push_back(key);
  for (const auto& [key, value] : b)
    if (!a.contains(key)) keys.push_back(key);
  return keys;
}

// In all that EditLight can change.
bool isSame(const LightState& a, const LightState& b) {
  return a.on == b.on && a.color == b.color && a.light.intensity == b.light.intensity &&
         a.light.position == b.light.position && a.light.direction == b.light.direction &&
         a.light.innerConeAngle == b.light.innerConeAngle && a.light.outerConeAngle == b.light.outerConeAngle;
}

bool isSame(const scene::Material& a, const scene::Material& b, const std::vector<Property>& properties) {
  return std::ranges::all_of(properties, [&](const Property& property) {
    return materialPropertyValue(a, property.name) == materialPropertyValue(b, property.name);
  });
}

void requirePositive(double value, const char* name) {
  if (!(value > 0.0) || !std::isfinite(value)) throw UsageError(fmt::format("{} {} must be above 0", name, value));
}

}  // namespace

SessionRequest withState(SessionRequest request, const SessionState& state) {
  request.program = state.program;
  request.render.parameterFile = state.parameterFile;
  request.render.assignments = state.assignments;
  request.render.camera = state.camera;
  request.render.environment = state.environment;
  if (!state.environmentOn) request.render.environment.source = "none";
  request.render.size = state.size;
  request.render.limits.samples = state.samples;
  return request;
}

// Turns the reports of the job into events, and stops it.
class Session::Recorder : public Observer {
 public:
  explicit Recorder(Observer& host) : host_(host) {}
  void stage(const std::string& text) override { host_.stage(text); }
  void deviceHung(const Diagnostic& diagnostic) override { host_.deviceHung(diagnostic); }
  void note(const std::string& text) override { add(Note{text}); }
  void warning(const std::string& text) override { add(Warning{text}); }
  void diagnostics(const std::vector<Diagnostic>& found) override { add(DiagnosticsFound{found}); }
  void printed(const Printed& prints) override {
    if (keepsPrints) add(LinesPrinted{prints});
  }
  StopRequest stopRequested() override {
    return interrupted && interrupted() ? StopRequest::abandon : StopRequest::none;
  }

  void add(Event event) {
    const std::lock_guard lock(mutex_);  // warnings come from any thread
    events_.push_back(std::move(event));
  }
  std::vector<Event> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(events_, {});
  }

  std::function<bool()> interrupted;
  bool keepsPrints = false;  // the image has its full resolution

 private:
  Observer& host_;
  std::mutex mutex_;
  std::vector<Event> events_;
};

Session::Session(Engine& engine, SessionRequest request, Clock clock, Observer& host)
    : engine_(engine),
      clock_(std::move(clock)),
      drafts_(request.drafts),
      recorder_(std::make_unique<Recorder>(host)),
      resolution_(request.updatesPerSecond > 0 ? request.updatesPerSecond : paceOf(engine).updatesPerSecond) {
  program::Program program = loadForSession(request.program);
  // The animation plays with all programs that the session can select.
  request.render.editable = true;
  SceneSource source = chooseSceneSource(request.render.scene, program, loadOptions(request.render, false));
  host.stage("loading " + source.name);
  scene_ = std::make_shared<const scene::Scene>(loadScene(source));
  instanceNames_ = scene::instanceNames(*scene_);
  materialNames_ = scene::materialNames(*scene_);
  lightNames_ = scene::lightNames(*scene_);
  sceneBounds_ = scene::animatedBounds(*scene_);
  recovering([&] {
    job_ = std::make_unique<RenderJob>(
        engine, resolveSession(request, scene_, sceneBounds_, source, program, paceOf(engine).launchSeconds),
        *recorder_);
  });
  const RenderRequest& resolved = job_->resolved().request;
  state_.program = request.program;
  state_.parameterFile = resolved.parameterFile;
  state_.assignments = resolved.assignments;
  state_.camera = resolved.camera;
  state_.environment = job_->keepEnvironment();
  state_.output = this->program().outputs.front().name;
  state_.size = filmSize_ = job_->scene()->size;
  state_.samples = static_cast<std::uint32_t>(*resolved.limits.samples);
  lastRestart_ = clock_();
  watched_.addFiles(job_->programFiles());
  watchFiles({});
}

Session::~Session() = default;

void Session::apply(const Command& command) {
  if (std::holds_alternative<EndDrag>(command)) {
    history_.endGroup();
    return;
  }
  if (const auto* size = std::get_if<SetSize>(&command); size && size->ofWindow) {
    show(changed(command));
    sizeOfWindow_ = true;
    return;
  }
  if (const auto* print = std::get_if<SetPrint>(&command)) {
    recovering([&] { setPrint(*print); });
    return;
  }
  if (std::holds_alternative<Rewind>(command)) {
    imageChanged_ = true;
    restarted();
    return;
  }
  const bool isUndo = std::holds_alternative<Undo>(command), isRedo = std::holds_alternative<Redo>(command);
  if (isUndo && !canUndo()) throw UsageError("there is no step to undo");
  if (isRedo && !canRedo()) throw UsageError("there is no step to redo");
  SessionState before = state_;
  SessionState next = isUndo ? history_.undone() : isRedo ? history_.redone() : changed(command);
  if (!isUndo && !isRedo && next == before) return;
  if (sizeOfWindow_ && (isUndo || isRedo)) next.size = state_.size;
  const auto drop = [&] {
    if (isUndo) history_.dropUndo();
    if (isRedo) history_.dropRedo();
  };
  try {
    recovering([&] { show(next); });
  } catch (const FileError&) {  // such as a program whose file no longer exists
    drop();
    throw;
  } catch (const UsageError&) {  // such as a parameter that the program no longer has
    drop();
    throw;
  }
  if (isUndo)
    history_.undo(std::move(before));
  else if (isRedo)
    history_.redo(std::move(before));
  else
    history_.add(std::move(before), undoGroup(command), interactive::undoName(command));
}

// The state after a command. It is checked when it is shown.
SessionState Session::changed(const Command& command) const {
  struct Change {
    const Session& session;
    SessionState next;

    void navigate(const OrbitCamera& camera) {
      next.camera = camera.request();
      if (!isFinite(camera.center) || !isFinite(camera.eye()) || camera.eye() == camera.center)
        throw UsageError("the camera would be too near or too far");
    }
    uvec2 size() const { return next.size; }
    // RenderJob reports animated instances.
    void setTransform(std::size_t instance, const mat4& worldFromObject) {
      const bool animated = !session.scene_->instances[instance].keyframes.empty();
      if (animated || worldFromObject != session.transform(instance)) next.transforms[instance] = worldFromObject;
    }

    void operator()(const Orbit& c) {
      const OrbitCamera camera = session.navigation();
      navigate(orbit(camera, c.right, c.up, next.orbitCenter.value_or(camera.center)));
    }
    void operator()(const Pan& c) { navigate(pan(session.navigation(), c.pixels, size())); }
    void operator()(const Zoom& c) {
      requirePositive(c.factor, "the zoom factor");
      navigate(zoom(session.navigation(), c.factor, c.pixel.value_or(0.5f * vec2(size())), size()));
    }
    void operator()(const Fly& c) { navigate(fly(session.navigation(), c.meters, c.yaw, c.pitch)); }
    void operator()(const Frame& c) {
      navigate(frame(session.navigation(), session.bounds(c.instance), size()));
      next.orbitCenter.reset();
    }
    void operator()(const SetOrbitCenter& c) {
      const float depth = session.navigation().depthOf(c.point);
      if (!isFinite(c.point) || !(depth > 0.0f)) throw UsageError("the orbit center must be in front of the camera");
      next.orbitCenter = c.point;
      next.camera.focusDistance = depth;
    }
    void operator()(const SetCamera& c) {
      next.camera = c.camera;
      next.orbitCenter.reset();
    }
    void operator()(const SetLens& c) {
      if (c.verticalFov && !(*c.verticalFov > 0.0f && *c.verticalFov < 180.0f))
        throw UsageError(fmt::format("the field of view {} must be between 0 and 180 degrees", *c.verticalFov));
      if (c.apertureRadius && !(*c.apertureRadius >= 0.0f)) throw UsageError("the aperture is negative");
      if (c.focusDistance) requirePositive(*c.focusDistance, "the focus distance");
      if (c.verticalFov) next.camera.verticalFov = c.verticalFov;
      if (c.apertureRadius) next.camera.apertureRadius = c.apertureRadius;
      if (c.focusDistance) next.camera.focusDistance = c.focusDistance;
    }
    void operator()(const SetProgram& c) {
      next.program = c.name;
      next.parameterFile.clear();
      next.assignments.clear();
      const bool isShown = c.name == session.state_.program;
      next.output = isShown ? session.program().outputs.front().name : "";  // the first one of the program
    }
    void operator()(const SetParameter& c) {
      program::ParameterValues values = session.parameters();
      values.set(c.name, c.value);
      if (values.toJson() == session.parameters().toJson()) return;
      const auto sets = [&](const std::string& text) { return text.starts_with(c.name + "="); };
      const std::string assignment = c.name + "=" + c.value;
      const auto found = std::ranges::find_if(next.assignments, sets);
      if (found == next.assignments.end()) {
        next.assignments.push_back(assignment);
      } else {
        next.assignments.erase(std::remove_if(found + 1, next.assignments.end(), sets), next.assignments.end());
        *found = assignment;
      }
    }
    void operator()(const EditMaterial& c) {
      std::vector<std::string> names = session.materialNames_;
      names.pop_back();  // the default material is not part of the scene
      const std::size_t index = indexOf(c.material, names, "material");
      scene::Material material = session.material(index);
      for (const Property& property : c.properties) setMaterialProperty(material, property.name, property.numbers);
      if (isSame(material, session.material(index), c.properties)) return;
      next.materials[index] = std::make_shared<const scene::Material>(std::move(material));
    }
    void operator()(const EditLight& c) {
      const std::size_t index = indexOf(c.light, session.lightNames_, "light");
      LightState light = session.light(index);
      for (const Property& property : c.properties) {
        const bool isSwitch = property.name == "on";
        if (isSwitch && (property.numbers.size() != 1 || (property.numbers[0] != 0 && property.numbers[0] != 1)))
          throw UsageError("the property 'on' of a light is true or false");
        if (isSwitch)
          light.on = property.numbers[0] == 1;
        else
          setLightProperty(light.light, light.color, property.name, property.numbers);
      }
      if (!isSame(light, session.light(index))) next.lights[index] = std::make_shared<const LightState>(light);
    }
    void operator()(const SetEnvironment& c) {
      if (c.intensity && !(*c.intensity >= 0.0f && std::isfinite(*c.intensity)))
        throw UsageError(fmt::format("the intensity {} of the environment must be at least 0", *c.intensity));
      if (c.rotation && !std::isfinite(*c.rotation)) throw UsageError("the rotation of the environment is not finite");
      if (c.source) next.environment.source = *c.source;
      if (c.intensity) next.environment.intensity = c.intensity;
      if (c.rotation) next.environment.rotation = c.rotation;
      if (c.on) next.environmentOn = *c.on;
    }
    void operator()(const SetTransform& c) {
      setTransform(indexOf(c.instance, session.instanceNames_, "instance"), c.worldFromObject);
    }
    void operator()(const Move& c) {
      const std::size_t index = indexOf(c.instance, session.instanceNames_, "instance");
      mat4 moved = session.transform(index);
      moved[3] += vec4(c.meters, 0.0f);
      setTransform(index, moved);
    }
    void operator()(const SetFrame& c) {
      if (!session.isAnimated())
        throw UsageError("the scene has neither keyframes nor an animation, so all frames are the same");
      next.frame = c.frame;
    }
    void operator()(const SelectOutput& c) {
      const program::Program& program = session.program();
      const std::size_t index = indexOf(c.name, program::outputNames(program), "output");
      if (program.outputs[index].pixel == program::OutputPixel::coverage)
        throw UsageError(fmt::format("output '{}' counts ids and is not an image", c.name));
      next.output = c.name;
    }
    void operator()(const SetExposure& c) {
      if (!(std::abs(c.stops) <= kMaxExposure))
        throw UsageError(
            fmt::format("the exposure {} must be between {} and {} stops", c.stops, -kMaxExposure, kMaxExposure));
      next.exposure = c.stops;
    }
    void operator()(const SetToneMap& c) { next.toneMap = c.toneMap; }
    void operator()(const SetSize& c) { next.size = c.size; }
    void operator()(const SetSamples& c) {
      if (c.samples == 0) throw UsageError("the number of samples must be at least 1");
      next.samples = c.samples;
    }
    void operator()(const SetPrint&) {}
    void operator()(const Rewind&) {}
    void operator()(const EndDrag&) {}
    void operator()(const Undo&) {}
    void operator()(const Redo&) {}
  };
  Change change{*this, state_};
  std::visit(change, command);
  return std::move(change.next);
}

const scene::Material& Session::materialIn(const SessionState& state, std::size_t index) const {
  const auto edited = state.materials.find(index);
  return edited != state.materials.end() ? *edited->second : scene_->materials.at(index);
}

LightState Session::lightIn(const SessionState& state, std::size_t index) const {
  const auto edited = state.lights.find(index);
  return edited != state.lights.end()
             ? *edited->second
             : LightState{scene_->lights.at(index), true, lightColor(scene_->lights.at(index))};
}

const scene::Material& Session::material(std::size_t index) const { return materialIn(state_, index); }

LightState Session::light(std::size_t index) const { return lightIn(state_, index); }

mat4 Session::transform(std::size_t instance) const {
  const auto edited = state_.transforms.find(instance);
  return edited != state_.transforms.end() ? edited->second
                                           : scene::worldFromObjectAt(scene_->instances.at(instance), pose());
}

Bounds3 Session::bounds(const std::string& instance) const {
  std::size_t first = 0, end = scene_->instances.size();
  if (!instance.empty()) {
    first = indexOf(instance, instanceNames_, "instance");
    end = first + 1;
  }
  Bounds3 bounds;
  for (std::size_t i = first; i < end; ++i) {
    const auto mesh = static_cast<std::size_t>(scene_->instances[i].mesh);
    bounds.extend(scene::meshBounds(scene_->meshes[mesh], transform(i)));
  }
  return bounds;
}

scene::Camera Session::camera() const {
  const float aspect = static_cast<float>(state_.size.x) / static_cast<float>(state_.size.y);
  if (!scene_->nodeAnimation) return chooseCamera(*scene_, state_.camera, aspect, sceneBounds_).camera;
  scene::Scene cameras;
  cameras.name = scene_->name;
  for (const scene::Camera& camera : scene_->cameras) cameras.cameras.push_back(scene::cameraAt(camera, pose()));
  return chooseCamera(cameras, state_.camera, aspect, sceneBounds_).camera;
}

OrbitCamera Session::navigation() const {
  const vec3 sceneCenter = sceneBounds_.empty() ? vec3(0.0f) : sceneBounds_.center();
  return orbitCamera(camera(), state_.orbitCenter.value_or(state_.camera.lookAt.value_or(sceneCenter)));
}

bool Session::isAnimated() const { return scene::isAnimated(*scene_); }

float Session::lastFrame() const { return scene::lastFrame(*scene_); }

const scene::Pose& Session::pose() const {
  if (!pose_ || pose_->frame != state_.frame) pose_ = scene::poseAt(scene_->nodeAnimation.get(), state_.frame);
  return *pose_;
}

// Passes the difference to the job. Counts the edits that have succeeded, which discard the samples. An empty output of
// `to` becomes the first one of its program.
void Session::transfer(const SessionState& from, SessionState& to, unsigned& edits) {
  const auto differs = [&](auto member) { return !(to.*member == from.*member); };
  const auto edit = [&](bool needed, const auto& function) {
    if (!needed) return;
    function();
    ++edits;
  };
  if (differs(&SessionState::program) || differs(&SessionState::parameterFile)) {
    program::Program loaded = loadForSession(to.program);
    if (to.output.empty() && !loaded.outputs.empty()) to.output = loaded.outputs.front().name;
    edit(true, [&] { showProgram(std::move(loaded), to); });
  } else {
    edit(differs(&SessionState::output) && outputsFor(program(), to.output) != job_->resolved().request.outputs,
         [&] { showProgram(program(), to); });
    edit(differs(&SessionState::assignments), [&] { job_->setParameters(to.assignments); });
  }
  edit(differs(&SessionState::camera), [&] { job_->setCamera(to.camera); });
  edit(differs(&SessionState::frame), [&] { job_->setFrame(to.frame); });
  edit(differs(&SessionState::samples), [&] { job_->setPlannedSamples(to.samples); });
  edit(differs(&SessionState::size), [&] {
    job_->setSize(to.size);
    filmSize_ = to.size;
    if (hasAutomaticCamera()) job_->setCamera(to.camera);  // it depends on the aspect ratio
  });
  edit(differs(&SessionState::environment) || differs(&SessionState::environmentOn), [&] {
    EnvironmentRequest environment = to.environment;
    if (!to.environmentOn) environment.source = "none";
    job_->setEnvironment(environment);
  });
  for (const std::size_t i : changedKeys(from.materials, to.materials))
    edit(true, [&] { job_->setMaterial(i, materialIn(to, i)); });
  for (const std::size_t i : changedKeys(from.lights, to.lights))
    edit(true, [&] {
      LightState light = lightIn(to, i);
      if (!light.on) light.light.intensity = vec3(0.0f);
      job_->setLight(i, light.light);
    });
  for (const std::size_t i : changedKeys(from.transforms, to.transforms))
    edit(true, [&] {
      const auto edited = to.transforms.find(i);
      job_->setTransform(i, edited != to.transforms.end() ? edited->second : scene_->instances[i].worldFromObject);
    });
}

// After an error, the job is as before. If removed steps made the difference large, edits before the error are undone.
void Session::show(const SessionState& next) {
  SessionState shown = next;
  unsigned edits = 0;
  try {
    transfer(state_, shown, edits);
  } catch (...) {
    if (edits > 0) {
      SessionState before = state_;
      transfer(shown, before, edits);
      restarted();
    }
    throw;
  }
  const bool otherProgram = shown.program != state_.program;
  if (kept_ && shown.output != state_.output) {  // it shows the output before, and the film has no samples
    kept_.reset();
    preview_ = refining_ = false;
  }
  state_ = std::move(shown);
  if (otherProgram) {
    watched_ = {};
    watched_.addFiles(job_->programFiles());
    watchFiles({});
  }
  imageChanged_ = true;
  if (edits > 0) restarted();
}

void Session::showProgram(program::Program program, const SessionState& next) {
  const ProgramRequest with{outputsFor(program, next.output), next.parameterFile, next.assignments, drafts_};
  job_->setProgram(std::move(program), with, *recorder_);  // keeps the old one if it throws
  // The program that picks depends on the shown one, so it is prepared again. Destroying the future would wait.
  if (picking_.valid() && picking_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) picking_ = {};
}

void Session::setPrint(const SetPrint& command) {
  if (command.print && !command.print->all) {
    const render::Region& pixels = command.print->pixels;
    const auto end = [](std::uint32_t begin, std::uint32_t size) { return std::uint64_t{begin} + size; };
    if (pixels.width == 0 || pixels.height == 0 || end(pixels.x, pixels.width) > state_.size.x ||
        end(pixels.y, pixels.height) > state_.size.y)
      throw UsageError(fmt::format("the pixels {},{},{},{} to print are outside the image of {}x{}", pixels.x, pixels.y,
                                   pixels.width, pixels.height, state_.size.x, state_.size.y));
  }
  job_->setPrint(command.print, *recorder_);
  imageChanged_ = true;
  restarted();
}

void Session::restarted() {
  explainer_.reset();
  ++restarts_;
  recorder_->add(Restarted{});
  if (failed_) deviceLosses_ = 0;
  samples_ = 0;
  seconds_ = 0;
  kept_.reset();
  preview_ = refining_ = failed_ = false;
  lastRestart_ = clock_();
}

// Calls the function, again with a new device if the device was lost.
template <class Function>
std::invoke_result_t<const Function&> Session::recovering(const Function& function) {
  for (;;) {
    try {
      return function();
    } catch (const TimeoutError&) {  // the device still works
      throw;
    } catch (const DeviceLostError& error) {
      replaceDevice(error.what());
    }
  }
}

// Edits of the job take effect when the next render has loaded it on the new device.
void Session::replaceDevice(const std::string& cause) {
  explainer_.reset();
  if (picking_.valid()) picking_.wait();
  picking_ = {};
  if (job_) {
    job_->releaseDevice();
    restarted();
  }
  engine_.close();
  std::string failure;
  while (++deviceLosses_ < kMaxDeviceLosses) {
    std::this_thread::sleep_for((deviceLosses_ - 1) * kReopenPause);
    try {
      recorder_->add(DeviceReplaced{engine_.context().info().name, cause});
      return;
    } catch (const Error& error) {  // the driver needs more time, or the device no longer exists
      failure = error.what();
    }
  }
  const char* remedy = job_ ? "; the next change of the image tries again" : "";
  if (!failure.empty())
    throw DeviceLostError(fmt::format("the device was lost and cannot be opened{}: {}", remedy, failure));
  throw DeviceLostError(fmt::format("the device was lost {} times in sequence{}: {}", kMaxDeviceLosses, remedy, cause));
}

bool Session::recoverFrom(const DeviceLostError& error) {
  if (deviceLosses_ >= kMaxDeviceLosses) return false;
  try {
    replaceDevice(error.what());
    return true;
  } catch (const DeviceLostError&) {
    return false;
  }
}

bool Session::hasAutomaticCamera() const {
  return !state_.camera.lookFrom && state_.camera.name.empty() && scene_->cameras.empty();
}

std::size_t Session::outputIndex() const { return indexOf(state_.output, program::outputNames(program()), "output"); }

void Session::watchFiles(const std::vector<Diagnostic>& diagnostics) {
  watched_.addProgram(state_.program);
  watched_.addDiagnosed(diagnostics);
  watcher_.watch(watched_);
}

void Session::reloadIfSaved() {
  if (!watcher_.pending()) return;
  watcher_.wait(0);
  const auto reject = [&](const std::vector<Diagnostic>& diagnostics) {
    recorder_->diagnostics(diagnostics);
    watchFiles(diagnostics);
  };
  try {
    Fitted fitted;
    recovering([&] {
      program::Program saved = loadForSession(state_.program);
      fitted = fittedTo(saved, state_);
      showProgram(std::move(saved), fitted.state);
    });
    state_ = std::move(fitted.state);
    for (const std::string& warning : fitted.warnings) recorder_->warning(warning);
    recorder_->add(ProgramReloaded{watcher_.changedNames()});
    watched_.addFiles(job_->programFiles());
    watchFiles({});
    restarted();
  } catch (const ProgramError& error) {
    reject(error.diagnostics());
  } catch (const FileError& error) {
    reject({asDiagnostic(error)});
  } catch (const UsageError& error) {
    reject({{Severity::error, "", 0, 0, "", error.what()}});
  }
}

bool Session::isMoving() const { return clock_() - lastRestart_ < kQuietSeconds; }

bool Session::hasWork() const {
  if (failed_) return false;
  if (preview_) return direct_ || !isMoving();
  return samples_ < state_.samples;
}

double Session::secondsUntilWork() const {
  if (imageChanged_ || hasWork()) return 0;
  if (failed_ || !preview_) return std::numeric_limits<double>::infinity();
  return std::max(0.0, lastRestart_ + kQuietSeconds - clock_());
}

std::vector<Event> Session::refine(const std::function<bool()>& interrupted) {
  direct_ = true;
  if (std::exchange(failed_, false))
    deviceLosses_ = 0;  // the caller requires an image, so it gets that or the error again
  try {
    std::vector<Event> events = step(std::numeric_limits<double>::infinity(), interrupted);
    direct_ = false;
    return events;
  } catch (...) {
    direct_ = false;
    throw;
  }
}

std::vector<Event> Session::step(double seconds, const std::function<bool()>& interrupted) {
  // An edit of the program does not wait for samples that it discards.
  recorder_->interrupted = [this, interrupted] {
    return (interrupted && interrupted()) || (!direct_ && watcher_.pending());
  };
  const double end = clock_() + seconds;
  reloadIfSaved();
  const auto fail = [&](const Error& error) {
    failed_ = true;
    recorder_->add(Failed{error.what()});
  };
  // A batch can take seconds, and a changed exposure must not wait for it.
  const bool displayChanged = imageChanged_ && (samples_ > 0 || kept_);
  try {
    if (!displayChanged || direct_) recovering([&] { work(end); });
  } catch (const TimeoutError&) {
    throw;
  } catch (const DeviceLostError& error) {
    fail(error);
  } catch (const gpu::NoDeviceError& error) {  // after a loss
    fail(error);
  } catch (const ProgramError& error) {
    recorder_->diagnostics(error.diagnostics());
    watchFiles(error.diagnostics());
    fail(error);
  } catch (const FileError& error) {
    fail(error);
  } catch (const UsageError& error) {
    fail(error);
  } catch (const MemoryError& error) {
    fail(error);
  }
  if (imageChanged_ && (samples_ > 0 || kept_) && !failed_) {
    const bool showsKept = kept_ && samples_ == 0;
    ImageUpdated image;
    image.samples = std::max<std::uint64_t>(samples_, 1);
    image.size = showsKept ? uvec2(kept_->width, kept_->height) : filmSize_;
    image.factor = preview_ || showsKept ? previewFactor_ : 1;
    image.seconds = seconds_;
    image.complete = !preview_ && samples_ >= state_.samples;
    recorder_->add(image);
  }
  imageChanged_ = false;
  recorder_->interrupted = interrupted;
  return recorder_->take();
}

void Session::work(double end) {
  while (hasWork() && renderNext() && clock_() < end && recorder_->stopRequested() == StopRequest::none) {
  }
}

// Previews of increasing resolution, then batches at full resolution.
bool Session::renderNext() {
  if (!direct_ && !refining_) {
    if (!preview_) return renderPreview(resolution_.factor());
    if (previewFactor_ > 1) return renderPreview(finerFactor(previewFactor_));
  }
  if (!refining_) beginRefinement();
  return renderBatch();
}

// The image stays that of the last preview until the next batch is complete.
void Session::keepPreview() {
  if (preview_) kept_ = linearImage();
}

bool Session::renderPreview(unsigned factor) {
  keepPreview();
  const uvec2 size = reducedSize(state_.size, factor);
  if (filmSize_ != size) job_->setSize(size);
  job_->restart();
  filmSize_ = size;
  samples_ = 0;
  seconds_ = 0;
  recorder_->keepsPrints = false;
  if (!added(job_->renderBatch(1, *recorder_), 1, factor)) return false;
  previewFactor_ = factor;
  preview_ = true;
  return true;
}

void Session::beginRefinement() {
  keepPreview();
  job_->completeProgram(*recorder_);
  if (filmSize_ != state_.size) job_->setSize(state_.size);
  filmSize_ = state_.size;
  job_->restart();
  // An automatic camera depends on the aspect ratio, and a preview can have built the scene again, for its own.
  if (hasAutomaticCamera()) job_->setCamera(state_.camera);
  preview_ = false;
  refining_ = true;
  samples_ = 0;
  seconds_ = 0;
}

bool Session::renderBatch() {
  const std::uint64_t count = job_->resolved().accumulatesFrames() ? 1 : render::kBatchSamples;
  const std::uint64_t end = std::min<std::uint64_t>(state_.samples, samples_ + count);
  recorder_->keepsPrints = true;
  return added(job_->renderBatch(end, *recorder_), end - samples_, 1);
}

// `seconds`: of new samples per pixel, or nothing if they were interrupted.
bool Session::added(std::optional<double> seconds, std::uint64_t samples, unsigned factor) {
  if (!seconds) return false;
  samples_ += samples;
  seconds_ += *seconds;
  imageChanged_ = true;
  kept_.reset();
  if (refining_ && (samples_ >= state_.samples || seconds_ >= kStableSeconds)) deviceLosses_ = 0;
  // The first click then need not wait for the compiler.
  if (!picking_.valid()) picking_ = compilePicking(engine_, *job_->scene()->onDevice, program());
  if (measuredLink_ == job_->linkCount()) resolution_.measured(factor, *seconds / static_cast<double>(samples));
  measuredLink_ = job_->linkCount();
  return true;
}

io::Image Session::linearImage() const {
  return kept_ && samples_ == 0 ? *kept_ : job_->renderer().displayImage(outputIndex());
}

io::Image Session::image() const {
  const program::OutputKind kind = program().outputs[outputIndex()].kind;
  const auto exposure = static_cast<float>(state_.exposure);
  const io::Image linear = linearImage();
  if (kind == program::OutputKind::heat && !state_.toneMap)
    return render::falseColor(linear, {.scale = render::falseColorScale(linear, exposure), .legend = false});
  return render::toDisplay(linear, state_.toneMap.value_or(render::defaultToneMap(kind)), exposure,
                           !job_->resolved().request.transparent);
}

RenderResult Session::result() const { return job_->result(true); }

render::RayCount Session::rays() const { return job_->renderer().rays(); }

std::vector<uvec2> Session::droppedPixels(std::size_t limit) const {
  job_->renderer().finish();
  const std::vector<uvec2> statistics = job_->renderer().film().downloadStatistics();
  std::vector<uvec2> pixels;
  for (std::size_t i = 0; i < statistics.size() && pixels.size() < limit; ++i)
    if (statistics[i].y > 0) pixels.push_back(render::pixelAt(job_->region(), i));
  return pixels;
}

void Session::requirePixel(uvec2 pixel) const {
  if (pixel.x >= state_.size.x || pixel.y >= state_.size.y)
    throw UsageError(
        fmt::format("pixel {},{} is not inside the image of {}x{}", pixel.x, pixel.y, state_.size.x, state_.size.y));
}

PixelExplanation Session::explain(uvec2 pixel, std::uint32_t sample) {
  requirePixel(pixel);
  if (sample >= state_.samples)
    throw UsageError(fmt::format("{} {} does not exist: the first one is 0, the last one {}",
                                 job_->resolved().accumulatesFrames() ? "frame" : "sample", sample,
                                 state_.samples - 1));
  return recovering([&] {
    job_->update(*recorder_);
    if (!explainer_ || explainedPixel_ != pixel) {
      explainer_.reset();
      const float aspect = static_cast<float>(state_.size.x) / static_cast<float>(state_.size.y);
      explainer_ = std::make_unique<PixelExplainer>(
          engine_, *job_,
          ExplainedImage{chooseCamera(job_->hostScene(), state_.camera, aspect, sceneBounds_), state_.size}, pixel);
      explainedPixel_ = pixel;
    }
    PixelExplanation explanation = explainer_->explain(pixel, sample, *recorder_);
    job_->showCurrentFrame();
    return explanation;
  });
}

std::optional<Pick> Session::pick(uvec2 pixel) {
  requirePixel(pixel);
  return recovering([&] {
    job_->update(*recorder_);
    job_->showCurrentFrame();
    return interactive::pick(engine_, *job_->scene()->onDevice, camera(), state_.size, pixel, program());
  });
}

DepthMap Session::depthMap() {
  return recovering([&] {
    job_->update(*recorder_);
    job_->showCurrentFrame();
    return renderDepthMap(engine_, *job_->scene()->onDevice, camera(), state_.size, program());
  });
}

}  // namespace quintet::job::interactive
