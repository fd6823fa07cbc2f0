// SPDX-License-Identifier: Apache-2.0
// Renders until the error is below 5 %, for at most 60 seconds, with progress. Ctrl+C stops and keeps what there is.
// Continues from error_target.qfilm if it exists. Usage: error_target [SCENE]; writes error_target.png.
#include <csignal>
#include <cstdio>
#include <exception>

#include <quintet/quintet.h>

namespace {

volatile std::sig_atomic_t canceled = 0;

bool showProgress(const quintet::Progress& progress) {
  std::fprintf(stderr, "\r%3.0f %%  %.0f samples  %.1f s", 100 * progress.fraction, progress.samples, progress.seconds);
  if (progress.error) std::fprintf(stderr, "  error %.1f %%", 100 * *progress.error);
  return canceled == 0;
}

const char* text(quintet::StopReason reason) {
  switch (reason) {
    case quintet::StopReason::samples: return "all samples";
    case quintet::StopReason::time: return "time limit";
    case quintet::StopReason::error: return "error target reached";
    case quintet::StopReason::canceled: return "canceled";
    case quintet::StopReason::unknownError: return "error unknown";
  }
  return "";
}

}  // namespace

int main(int argc, char** argv) try {
  std::signal(SIGINT, [](int) { canceled = 1; });
  const quintet::Program program = quintet::Program::load("pathtracer");
  const quintet::Scene scene = argc > 1 ? quintet::Scene::load(argv[1]) : quintet::Scene::of(program);

  quintet::prepareDrivers();  // before the process has other threads
  quintet::Device device;
  quintet::Renderer renderer(device, scene, program, {.width = 240, .height = 160, .adaptive = true});
  if (renderer.resume("error_target.qfilm")) std::puts("resuming");
  const quintet::RenderReport report = renderer.render({.seconds = 60, .error = 0.05}, showProgress);
  std::fprintf(stderr, "\n");
  std::printf("%s after %.0f samples per pixel\n", text(report.reason), report.samples);
  if (report.error) std::printf("error: %.2f %%\n", 100 * *report.error);
  for (const std::string& warning : report.warnings) std::printf("warning: %s\n", warning.c_str());
  renderer.saveCheckpoint("error_target.qfilm");
  renderer.image().write("error_target.png");
} catch (const std::exception& error) {
  return std::fprintf(stderr, "error_target: %s\n", error.what()), 1;
}
