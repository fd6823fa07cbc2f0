#include "render/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "base/error.h"

namespace quintet::render {
namespace {

static_assert(shared::kMaxOutputs == 16, "program_parser.cpp refuses more outputs than this");

gpu::Buffer pixelBuffer(gpu::Context& context, VkDeviceSize bytes, const std::string& name) {
  gpu::BufferOptions options;
  options.size = bytes;
  options.name = name;
  return gpu::Buffer(context, options);
}

std::unique_ptr<gpu::ComputePipeline> makeAddPipeline(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler) {
  shader::Source source;
  source.stage = shader::Stage::compute;
  source.name = "film_add.comp";
  source.text = "#version 460\n#include <quintet/passes/film_add.glsl>\n";
  const shader::Result result = compiler.compile(source);
  if (!result.ok()) throw Error(result.diagnostics.empty() ? "film_add.comp does not compile" : result.diagnostics[0].format());
  return std::make_unique<gpu::ComputePipeline>(context, set, result.spirv, VK_NULL_HANDLE, "film add");
}

}  // namespace

Film::Film(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler, Region region,
           const std::vector<std::string>& outputs, program::Accumulation accumulation)
    : context_(context), region_(region), outputs_(outputs), accumulation_(accumulation), add_(makeAddPipeline(context, set, compiler)) {
  const VkDeviceSize pixels = VkDeviceSize{region.width} * region.height;
  if (outputs.size() > shared::kMaxOutputs) throw UsageError(fmt::format("{} outputs: at most {} are possible", outputs.size(), shared::kMaxOutputs));
  for (const std::string& name : outputs) {
    batch_.push_back(pixelBuffer(context, pixels * sizeof(vec4), "film batch " + name));
    total_.push_back(pixelBuffer(context, pixels * sizeof(vec4), "film total " + name));
  }
  statistics_ = pixelBuffer(context, pixels * sizeof(uvec2), "film statistics");
  clear();
}

void Film::clear() {
  context_.submit([&](gpu::Commands& commands) {
    for (const gpu::Buffer& buffer : total_) commands.fill(buffer, 0);
    commands.fill(statistics_, 0);
  });
}

std::uint64_t Film::bytes() const {
  std::uint64_t sum = statistics_.size();
  for (std::size_t i = 0; i < batch_.size(); ++i) sum += batch_[i].size() + total_[i].size();
  return sum;
}

void Film::describe(shared::Frame& frame) const {
  frame.filmOffset = {region_.x, region_.y};
  frame.filmWidth = region_.width;
  frame.filmHeight = region_.height;
  frame.statistics = statistics_.address();
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    frame.outputs[i] = batch_[i].address();
    if (accumulation_ == program::Accumulation::program) frame.previousOutputs[i] = total_[i].address();
  }
}

void Film::beginBatch(gpu::Commands& commands) {
  commands.barrier(gpu::Stage::all, gpu::Stage::transfer);
  for (const gpu::Buffer& buffer : batch_) commands.fill(buffer, 0);
  commands.barrier(gpu::Stage::transfer, gpu::Stage::rayTracing);
}

void Film::endBatch(gpu::Commands& commands) {
  if (accumulation_ == program::Accumulation::program) {
    commands.barrier(gpu::Stage::rayTracing, gpu::Stage::transfer);
    for (std::size_t i = 0; i < batch_.size(); ++i) commands.copy(batch_[i], total_[i], total_[i].size());
    commands.barrier(gpu::Stage::transfer, gpu::Stage::all);
    return;
  }
  commands.barrier(gpu::Stage::rayTracing, gpu::Stage::compute);
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    shared::FilmAdd pass{};
    pass.total = total_[i].address();
    pass.batch = batch_[i].address();
    pass.count = region_.width * region_.height;
    // Rows of workgroups: one dimension alone would exceed the limit for large images.
    const std::uint32_t groups = (pass.count + shared::kFilmAddGroupSize - 1) / shared::kFilmAddGroupSize;
    const std::uint32_t columns = std::min(groups, shared::kFilmAddColumns);
    add_->dispatch(commands, std::as_bytes(std::span(&pass, 1)), columns, (groups + columns - 1) / columns);
  }
}

io::Image Film::download(std::size_t output, std::uint64_t sampleCount) const {
  assert(output < total_.size());
  io::Image image = io::makeImage(region_.width, region_.height, 4, io::PixelType::f32, io::ColorEncoding::linear);
  image.premultiplied = true;
  total_[output].download(image.data);
  if (accumulation_ == program::Accumulation::program) return image;
  const float scale = sampleCount ? 1.0f / static_cast<float>(sampleCount) : 0.0f;
  for (float& value : image.samples<float>()) value *= scale;
  return image;
}

std::vector<vec4> Film::downloadBatch(std::size_t output) const {
  return batch_[output].downloadAs<vec4>(std::size_t{region_.width} * region_.height);
}

RayCount Film::countRays() const {
  RayCount count;
  for (const uvec2& pixel : statistics_.downloadAs<uvec2>(std::size_t{region_.width} * region_.height)) {
    count.rays += pixel.x;
    count.droppedSamples += pixel.y;
  }
  return count;
}

}  // namespace quintet::render
