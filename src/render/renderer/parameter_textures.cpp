// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/parameter_textures.h"

#include "gpu/uploader.h"
#include "io/codec.h"

namespace quintet::render {
namespace {

io::Image white() {
  io::Image image = io::makeImage(1, 1, 4, io::PixelType::u8, io::ColorEncoding::linear);
  for (std::uint8_t& sample : image.samples<std::uint8_t>()) sample = 255;
  return image;
}

io::Image loadImage(const program::Program& program, const program::ImageValue& value) {
  if (value.file.empty()) return white();
  if (!value.ofProgram) return io::readImage(value.file);
  const auto own = program.files.find(value.file);
  if (own == program.files.end()) return io::readImage(program.path(value.file));
  return io::decodeImage(std::as_bytes(std::span(own->second)), program.path(value.file));
}

}  // namespace

ParameterTextures::ParameterTextures(gpu::Context& context, TextureSlots& slots, const program::Program& program,
                                     const program::ParameterValues& values)
    : slots_(slots) {
  const std::vector<program::ImageValue> images = values.images();
  if (images.empty()) return;
  gpu::Uploader uploader(context);
  for (const program::ImageValue& value : images)
    addTexture(images_, context, uploader, loadImage(program, value), value.sRgb, "parameter " + value.parameter);
  uploader.flush();
  sampler_ = gpu::Sampler(context, {});
  indices_ = slots_.acquire(images.size());
  for (std::size_t i = 0; i < images_.size(); ++i) slots_.set().setTexture(indices_[i], images_[i], sampler_);
}

ParameterTextures::~ParameterTextures() { slots_.release(indices_); }

}  // namespace quintet::render
