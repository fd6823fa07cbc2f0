// What stands behind the classes of quintet.h.
#ifndef QUINTET_API_IMPL_H
#define QUINTET_API_IMPL_H

#include <memory>

#include <quintet/quintet.h>

#include "gpu/context.h"
#include "gpu/pipeline_cache.h"
#include "program/program.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "shader/compiler.h"

namespace quintet {

struct Device::Impl {
  std::unique_ptr<gpu::Context> context;
  std::unique_ptr<shader::Compiler> compiler;
  std::unique_ptr<gpu::PipelineCache> pipelines;
};

struct Scene::Impl {
  scene::Scene scene;
};

struct Program::Impl {
  program::Program program;
};

struct Renderer::Impl {
  std::unique_ptr<render::DeviceScene> scene;
  std::unique_ptr<render::Renderer> renderer;
  bool framewise = false;  // the program accumulates itself
};

namespace api {
Diagnostic toPublic(const shader::Diagnostic& diagnostic);
}

}  // namespace quintet
#endif
