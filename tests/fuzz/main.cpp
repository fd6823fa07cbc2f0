// SPDX-License-Identifier: Apache-2.0
// Fuzz test of the whole path of a program: mutants (mutants.h) are compiled, checked, linked and rendered with 16x16
// pixels. Workers are processes that run many mutants one after the other. The supervisor starts a new one after a crash
// or a launch that does not end, and runs each mutant that crashed once more, alone.
//
//   quintet_fuzz --root FOLDER [--count N] [--seed S] [--first K] [--jobs J] [--only K] [--keep FOLDER] [--strict]
//
// --only runs one mutant in this process. --keep writes the files of mutants that crash. The exit status is 1 if a mutant
// crashed or did not end in Quintet itself (before the pipeline is created), threw an unknown exception, or, with --strict,
// crashed at all; also if no mutant was rendered. It is 2 for a wrong command line, and without a usable device.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "base/error.h"
#include "check/check.h"
#include "gpu/driver_environment.h"
#include "gpu/error.h"
#include "job/device_limits.h"
#include "job/runnable_program.h"
#include "job/scene_source.h"
#include "mutants.h"
#include "program/description/parser.h"
#include "program/lecture/lecture.h"
#include "render/renderer/renderer.h"
#include "scene/defaults/auto_camera.h"
#include "scene/defaults/default_environment.h"

namespace quintet::fuzz {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path root, keep;
  std::uint64_t count = 40, seed = 1, first = 0;
  std::optional<std::uint64_t> only;
  unsigned jobs = 2;
  bool strict = false;
};

enum Outcome : std::uint8_t {
  kNone,
  kDescription,  // program.toml or the lecture form is invalid
  kCompiler,     // the compiler or the check reports an error
  kScene,        // the scene or a setting is invalid
  kRendered,
  kHang,        // a launch did not end in time
  kGpuError,    // out of memory, or a Vulkan call failed
  kUnexpected,  // any other exception
  kCrash,
  kStuck,  // killed by the supervisor
  kOutcomes
};
constexpr std::array<const char*, kOutcomes> kNames{
    "not run", "invalid description", "rejected by compiler or check", "scene error", "rendered",
    "hang",    "GPU error",           "unexpected exception",          "crash",       "stuck"};

enum Stage : std::uint8_t { kMutate, kParse, kCheck, kScenes, kCompile, kLink, kRun, kStages };
constexpr std::array<const char*, kStages> kStageNames{"mutation",    "parsing",  "check", "scene",
                                                       "compilation", "pipeline", "launch"};

// On a busy machine, the driver compiles the path tracer for half a minute in the first launch.
constexpr int kStuckSeconds = 240;
constexpr double kLaunchSeconds = 45;
constexpr long kProgressSeconds = 60;
constexpr unsigned kMutantsPerWorker = 150;  // memory that a wrong program overwrote must not harm later ones for long

// Of one worker, shared with the supervisor.
struct Slot {
  volatile std::uint64_t number = 0;
  volatile std::uint8_t stage = 0;
  volatile bool busy = false;
  volatile long started = 0;  // seconds
};

long nowSeconds() {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class Runner {
 public:
  Runner(const Options& options, const std::vector<Source>& sources) : options_(options), sources_(sources) {
    shader::CompilerOptions compilerOptions;
    compilerOptions.debugInfo = true;
    compiler_.emplace(compilerOptions);
  }

  Outcome run(std::uint64_t number, Slot& slot, std::string& text) {
    slot.stage = kMutate;
    const Mutant mutant = makeMutant(sources_, options_.seed, number);
    try {
      slot.stage = kParse;
      const program::Program program =
          mutant.source->lecture.empty()
              ? program::parseProgram(mutant.files.contains("program.toml") ? mutant.files.at("program.toml") : "",
                                      "mutant", "mutant", mutant.files)
              : program::parseLecture(mutant.files.at(mutant.source->lecture), mutant.source->lecture, "mutant",
                                      mutant.files);
      slot.stage = kCheck;
      const check::CheckResult checked =
          check::checkWithOptionalOutputs(program, *compiler_, nullptr, job::deviceLimits(context().info()));
      if (!checked.ok()) return kCompiler;
      slot.stage = kScenes;
      render::DeviceScene& scene = sceneOf(program);
      slot.stage = kCompile;
      job::CheckedProgram compiled =
          job::compileAndCheck(program, *compiler_, render::renderDefines(scene.defines(), {}), scene.facts(),
                               job::deviceLimits(context().info()));
      slot.stage = kLink;
      render::RenderSettings settings;
      settings.width = settings.height = 16;
      settings.camera = camera_;
      settings.timeoutSeconds = kLaunchSeconds;
      render::Renderer renderer(scene, std::move(compiled.runnable), *compiler_, nullptr, settings);
      slot.stage = kRun;
      renderer.renderBatch(1);
      for (std::size_t output = 0; output < program.outputs.size(); ++output)
        if (renderer.film().stores(output)) static_cast<void>(renderer.film().download(output));
      text = renderer.skippedTraces() > 0 ? "skipped traces" : "";
      return kRendered;
    } catch (const ProgramError&) {
      return kCompiler;
    } catch (const TimeoutError&) {
      return kHang;
    } catch (const DeviceLostError& error) {
      text = error.what();
      return kGpuError;
    } catch (const gpu::VulkanError& error) {
      text = error.what();
      return kGpuError;
    } catch (const MemoryError& error) {
      text = error.what();
      return kGpuError;
    } catch (const Error& error) {
      text = error.what();
      return slot.stage <= kParse ? kDescription : kScene;
    } catch (const std::exception& error) {
      text = error.what();
      return kUnexpected;
    }
  }

 private:
  gpu::Context& context() {
    if (!context_) context_ = std::make_unique<gpu::Context>();
    return *context_;
  }

  // Most mutants have the same scene as the one before.
  render::DeviceScene& sceneOf(const program::Program& program) {
    job::SceneSource source = job::chooseSceneSource({}, program);
    if (!scene_ || !(source == source_)) {
      scene::Scene loaded = job::loadScene(source);
      camera_ = loaded.cameras.empty() ? scene::frameScene(scene::worldBounds(loaded), 1.0f) : loaded.cameras.front();
      const scene::Environment environment = scene::effectiveEnvironment(loaded);
      scene_.reset();
      scene_ = std::make_unique<render::DeviceScene>(context(), std::move(loaded), environment);
      source_ = std::move(source);
    }
    return *scene_;
  }

  const Options& options_;
  const std::vector<Source>& sources_;
  std::optional<shader::Compiler> compiler_;
  std::unique_ptr<gpu::Context> context_;
  job::SceneSource source_;
  scene::Camera camera_;
  std::unique_ptr<render::DeviceScene> scene_;
};

// ---- Processes ----

struct Shared {
  std::atomic<std::uint64_t> next{0};
  std::array<Slot, 64> slots;
  std::uint8_t outcomes[1];  // by number - first; more follow
};

void keep(const Options& options, const std::vector<Source>& sources, std::uint64_t number) {
  if (options.keep.empty()) return;
  const Mutant mutant = makeMutant(sources, options.seed, number);
  const fs::path folder = options.keep / fmt::format("mutant-{}-{}", options.seed, number);
  fs::create_directories(folder);
  for (const auto& [name, text] : mutant.files) std::ofstream(folder / name, std::ios::binary) << text;
}

[[noreturn]] void work(const Options& options, const std::vector<Source>& sources, Shared& shared, Slot& slot) {
  {
    Runner runner(options, sources);
    for (unsigned done = 0; done < kMutantsPerWorker; ++done) {
      const std::uint64_t number = shared.next++;
      if (number >= options.first + options.count) break;
      slot.number = number;
      slot.started = nowSeconds();
      slot.busy = true;
      std::string text;
      const Outcome outcome = runner.run(number, slot, text);
      slot.busy = false;
      shared.outcomes[number - options.first] = outcome;
      if (outcome == kUnexpected || outcome == kGpuError)
        fmt::print("mutant {}: {} in {}: {}\n", number, kNames[outcome], kStageNames[slot.stage], text);
      std::fflush(stdout);
      if (outcome == kHang || outcome == kGpuError) ::_exit(0);  // destructors would wait for the device
    }
  }
  ::_exit(0);
}

// Crashes and endless loops before the driver gets the program are defects of Quintet.
bool isOurs(std::uint8_t stage) { return stage < kLink; }

struct Crash {
  std::uint64_t number;
  int signal;
  std::uint8_t stage;
  bool again;  // also alone
};

// Runs one mutant in a fresh process; returns the wait status and the stage.
std::pair<int, std::uint8_t> runAlone(const Options& options, const std::vector<Source>& sources, std::uint64_t number,
                                      Slot& slot) {
  std::fflush(stdout);
  const pid_t process = ::fork();
  if (process == 0) {
    ::alarm(kStuckSeconds);
    std::string text;
    Runner runner(options, sources);
    runner.run(number, slot, text);
    ::_exit(0);
  }
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return {status, slot.stage};
}

int supervise(const Options& options, const std::vector<Source>& sources) {
  const std::size_t bytes = sizeof(Shared) + options.count;
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return 2;
  auto* shared = new (memory) Shared;
  shared->next = options.first;
  std::vector<pid_t> workers(options.jobs, 0);
  std::vector<Crash> crashes;
  bool failed = false;
  const long begin = nowSeconds();
  long lastProgress = begin;
  const std::uint64_t end = options.first + options.count;
  while (true) {
    if (nowSeconds() - lastProgress >= kProgressSeconds) {
      lastProgress = nowSeconds();
      fmt::print(stderr, "{} of {} mutants, {} s\n",
                 std::min<std::uint64_t>(shared->next - options.first, options.count), options.count,
                 lastProgress - begin);
    }
    bool running = false;
    for (std::size_t w = 0; w < workers.size(); ++w) {
      if (workers[w] == 0 && shared->next < end) {
        std::fflush(stdout);
        shared->slots[w].busy = false;
        workers[w] = ::fork();
        if (workers[w] == 0) work(options, sources, *shared, shared->slots[w]);
      }
      running = running || workers[w] > 0;
    }
    if (!running) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    for (std::size_t w = 0; w < workers.size(); ++w) {
      Slot& slot = shared->slots[w];
      if (workers[w] > 0 && slot.busy && nowSeconds() - slot.started > kStuckSeconds) ::kill(workers[w], SIGKILL);
      int status = 0;
      if (workers[w] <= 0 || ::waitpid(workers[w], &status, WNOHANG) == 0) continue;
      workers[w] = 0;
      if (!WIFSIGNALED(status)) continue;
      const std::uint64_t number = slot.number;
      const bool stuck = WTERMSIG(status) == SIGKILL;
      // Without a mutant it crashed at its end, because of an earlier one.
      if (slot.busy) shared->outcomes[number - options.first] = stuck ? kStuck : kCrash;
      if (stuck) failed = failed || isOurs(slot.stage);
      if (!stuck) crashes.push_back({number, WTERMSIG(status), slot.busy ? slot.stage : std::uint8_t{kRun}, false});
      fmt::print("mutant {}: {} in {} (signal {}); {}\n", number, stuck ? "stuck" : "crash", kStageNames[slot.stage],
                 WTERMSIG(status), makeMutant(sources, options.seed, number).changes);
      std::fflush(stdout);
    }
  }
  std::size_t confirmed = 0;
  for (Crash& crash : crashes) {
    const auto [status, stage] = runAlone(options, sources, crash.number, shared->slots[0]);
    crash.again = WIFSIGNALED(status) && WTERMSIG(status) != SIGALRM;
    if (crash.again) crash.stage = stage, ++confirmed;
    failed = failed || options.strict || (isOurs(crash.stage) && crash.again);
    fmt::print("crash: mutant {} of {}, signal {} in {}{}\n", crash.number,
               makeMutant(sources, options.seed, crash.number).source->name, crash.signal, kStageNames[crash.stage],
               crash.again ? "" : ", not alone");
    keep(options, sources, crash.number);
  }
  std::array<std::uint64_t, kOutcomes> counts{};
  for (std::uint64_t i = 0; i < options.count; ++i) ++counts[shared->outcomes[i]];
  fmt::print("{} mutants of {} programs, seed {}, {} s:", options.count, sources.size(), options.seed,
             nowSeconds() - begin);
  for (std::size_t k = 0; k < kOutcomes; ++k)
    if (counts[k] > 0) fmt::print(" {} {},", counts[k], kNames[k]);
  fmt::print(" {} crashes of a worker, {} also alone\n", crashes.size(), confirmed);
  if (counts[kRendered] == 0) fmt::print("no mutant was rendered\n");
  return failed || counts[kUnexpected] > 0 || counts[kRendered] == 0 ? 1 : 0;
}

// In a process of its own, so that the workers start without the driver's threads.
bool hasDevice() {
  const pid_t process = ::fork();
  if (process == 0) {
    try {
      const gpu::Context context;
      ::_exit(0);
    } catch (const Error& error) {
      fmt::print(stderr, "quintet_fuzz: {}\n", error.what());
      ::_exit(2);
    }
  }
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--strict") {
      options.strict = true;
      continue;
    }
    if (i + 1 >= argc) return 2;
    const std::string value = argv[++i];
    if (name == "--root")
      options.root = value;
    else if (name == "--keep")
      options.keep = value;
    else if (name == "--count")
      options.count = std::stoull(value);
    else if (name == "--seed")
      options.seed = std::stoull(value);
    else if (name == "--first")
      options.first = std::stoull(value);
    else if (name == "--only")
      options.only = std::stoull(value);
    else if (name == "--jobs")
      options.jobs = std::min(64u, static_cast<unsigned>(std::stoul(value)));
    else
      return 2;
  }
  if (options.jobs == 0 || options.count == 0) {
    fmt::print(stderr, "quintet_fuzz: --jobs and --count must be at least 1\n");
    return 2;
  }
  gpu::prepareDriverEnvironment();
  const std::vector<Source> sources = findSources(options.root);
  if (sources.empty()) {
    fmt::print(stderr, "quintet_fuzz: {}: no programs found\n", options.root.string());
    return 2;
  }
  if (!hasDevice()) return 2;
  if (!options.only) return supervise(options, sources);
  keep(options, sources, *options.only);
  Slot slot;
  std::string text;
  fmt::print("{}: {}\n", makeMutant(sources, options.seed, *options.only).source->name,
             makeMutant(sources, options.seed, *options.only).changes);
  std::fflush(stdout);
  Runner runner(options, sources);
  const Outcome outcome = runner.run(*options.only, slot, text);
  fmt::print("{} in {} {}\n", kNames[outcome], kStageNames[slot.stage], text);
  std::fflush(stdout);
  ::_exit(0);
}

}  // namespace
}  // namespace quintet::fuzz

int main(int argc, char** argv) { return quintet::fuzz::main(argc, argv); }
