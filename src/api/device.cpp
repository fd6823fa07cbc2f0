#include "api/impl.h"
#include "gpu/driver_environment.h"

namespace quintet {

Device::Device(const DeviceOptions& options) : impl_(std::make_unique<Impl>()) {
  gpu::prepareDriverEnvironment();
  gpu::ContextOptions context;
  context.device = options.choice;
  if (options.onWarning)
    context.log = [warn = options.onWarning](LogLevel level, const std::string& text) {
      if (level == LogLevel::warning) warn(text);
    };
  impl_->context = std::make_unique<gpu::Context>(context);
  const auto part = [&](const char* name) {
    return options.cacheFolder.empty() ? options.cacheFolder : options.cacheFolder / name;
  };
  shader::CompilerOptions compiler;
  compiler.cacheFolder = part("shaders");
  impl_->compiler = std::make_unique<shader::Compiler>(compiler);
  impl_->pipelines = std::make_unique<gpu::PipelineCache>(*impl_->context, part("pipelines"));
}
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
Device::~Device() = default;

std::string Device::name() const { return impl_->context->info().name; }
std::string Device::driver() const { return impl_->context->info().driver; }

}  // namespace quintet
