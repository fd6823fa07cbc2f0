// The steps that `render` and `run` share, in their order. A step throws and leaves what was there; with
// --watch the steps from the scene on are repeated.
#ifndef QUINTET_APP_SESSION_H
#define QUINTET_APP_SESSION_H

#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "aov.h"
#include "gpu/context.h"
#include "gpu/pipeline_cache.h"
#include "metadata.h"
#include "output.h"
#include "progress.h"
#include "render/film_file.h"
#include "render/renderer.h"
#include "render_loop.h"
#include "render_options.h"
#include "scene_loading.h"
#include "scene_source.h"
#include "shader/compiler.h"
#include "warnings.h"

namespace quintet::app {

// A file by whose name a program's folder may be watched: shaders and descriptions, not the pictures that are
// written there.
bool isProgramSource(const std::filesystem::path& name);

class Session {
 public:
  // `options` outlives the session.
  explicit Session(const RenderOptions& options);

  void prepare();  // the program, its parameters, the files: all that can be wrong without a device
  void openDevice();
  void loadScene();  // reads it, decides on camera, size and light, builds it on the device
  void link();       // compiles and links the program into a renderer that has rendered nothing yet

  // For --watch: whether prepare() still wants the scene that loadScene() built, and every file on disk that was read.
  bool sceneLoaded() const { return sceneLoaded_; }
  std::vector<std::filesystem::path> files() const;
  std::vector<std::filesystem::path> sceneFiles() const;  // of the latter, those that are the scene's

  // Moves the scene's instances and empties the film: what is rendered next is this frame of an animation.
  void beginFrame(std::uint32_t frame);
  bool animated() const { return deviceScene_->animated(); }

  // Writes the picture of each chosen output, or the film.
  void write(const RenderOutcome& outcome, std::optional<std::uint32_t> frame = std::nullopt);
  std::string written() const { return record_.files.empty() ? "" : record_.files.back(); }  // last
  // Says what the compiler and the check of the link found: on standard error; with --json and an error among
  // them as an array on standard output, too.
  void tell(const std::vector<shader::Diagnostic>& diagnostics);
  // Warnings, --json, and one line on what was written last.
  void report();

  // The film as it is, with what is known about it; and of that, what other films of this rendering say alike, as the
  // files were when the program was linked.
  render::FilmFile film(const RenderOutcome& outcome);
  const render::FilmFacts& identity();

  render::Renderer& renderer() { return *renderer_; }
  const std::string& deviceName() const { return record_.device; }
  const program::Program& program() const { return program_; }
  Progress& progress() { return progress_; }
  Warnings& warnings() { return warnings_; }
  const Stopwatch& clock() const { return clock_; }

 private:
  struct SceneInfo {
    scene::Camera camera;
    uvec2 size{0};
    std::string cameraDescription;
    std::string environment;
    std::string hash, environmentHash;
    std::vector<std::filesystem::path> files;  // that a scene file names
    CoverageNames names;                       // with --aov only
    double loadSeconds = 0;
    scene::ImportSeconds import;
    double hashSeconds = 0;
    double viewSeconds = 0;  // camera, size and light decided
  };

  uvec2 picturePart(uvec2 size) const;
  void describe(const scene::Scene& scene, const ChosenEnvironment& environment);
  void fillRecord(const RenderOutcome& outcome);
  void writeFilm(const RenderOutcome& outcome);
  void fillLoading();  // stages and memory
  void compileEarly();
  render::RenderSettings settings() const;
  std::vector<std::size_t> chosenOutputs() const;
  std::vector<std::string> wantedOutputs() const;  // of the optional ones
  void checkSizes(uvec2 size) const;               // of film and file, as far as the size is known
  std::vector<std::byte> exrFile(std::size_t output) const;

  const RenderOptions& options_;
  const Stopwatch clock_;
  Progress progress_;
  Warnings warnings_;
  RenderRecord record_;
  double startedRendering_ = 0;  // on clock_

  program::Program program_;
  std::vector<AovLayer> aovs_;
  SceneSource sceneSource_;
  SceneLoading loading_;
  SceneInfo sceneInfo_;
  bool sceneLoaded_ = false;
  program::ParameterValues parameters_{{}};
  render::FilmFacts identity_;             // empty: not asked for yet
  std::unique_ptr<gpu::Context> context_;  // outlives all that follows
  std::unique_ptr<gpu::PipelineCache> pipelineCache_;
  std::unique_ptr<shader::Compiler> compiler_;
  std::unique_ptr<render::DeviceScene> deviceScene_;
  std::unique_ptr<render::Renderer> renderer_;
  // Of the first link: compiled while the scene is read and built. Last: it uses what stands above.
  std::future<render::CompiledShaders> earlyShaders_;
};

}  // namespace quintet::app
#endif
