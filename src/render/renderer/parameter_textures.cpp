// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/parameter_textures.h"

#include <cassert>
#include <utility>

#include "base/memory_budget.h"
#include "gpu/uploader.h"
#include "io/codec.h"

namespace quintet::render {
namespace {

io::Image white() {
  io::Image image = io::makeImage(1, 1, 4, io::PixelType::u8, io::ColorEncoding::linear);
  for (std::uint8_t& sample : image.samples<std::uint8_t>()) sample = 255;
  return image;
}

io::Image loadImage(const program::Program& program, const program::ImageValue& value, std::size_t maxMemory) {
  if (value.file.empty()) return white();
  const std::string path = value.ofProgram ? program.path(value.file) : value.file;
  MemoryBudget budget(path, maxMemory);
  const auto own = value.ofProgram ? program.files.find(value.file) : program.files.end();
  if (own == program.files.end()) return io::readImage(path, budget);
  return io::decodeImage(std::as_bytes(std::span(own->second)), path, budget);
}

}  // namespace

ParameterTextures::ParameterTextures(gpu::Context& context, TextureSlots& slots, const program::Program& program,
                                     const program::ParameterValues& values, std::size_t maxMemory)
    : context_(context), maxMemory_(maxMemory), slots_(slots), images_(upload(program, values)) {
  if (images_.empty()) return;
  sampler_ = gpu::Sampler(context, {});
  indices_ = slots_.acquire(images_.size());
  setTextures();
}

void ParameterTextures::replace(const program::Program& program, const program::ParameterValues& values) {
  std::deque<gpu::Image> images = upload(program, values);
  assert(images.size() == images_.size());
  images_ = std::move(images);
  setTextures();
}

std::deque<gpu::Image> ParameterTextures::upload(const program::Program& program,
                                                 const program::ParameterValues& values) const {
  std::deque<gpu::Image> images;
  const std::vector<program::ImageValue> wanted = values.images();
  if (wanted.empty()) return images;
  gpu::Uploader uploader(context_);
  for (const program::ImageValue& value : wanted)
    addTexture(images, context_, uploader, loadImage(program, value, maxMemory_), value.sRgb,
               "parameter " + value.parameter);
  uploader.flush();
  return images;
}

void ParameterTextures::setTextures() {
  for (std::size_t i = 0; i < images_.size(); ++i) slots_.set().setTexture(indices_[i], images_[i], sampler_);
}

ParameterTextures::~ParameterTextures() { slots_.release(indices_); }

}  // namespace quintet::render
