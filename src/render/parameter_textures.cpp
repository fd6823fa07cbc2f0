#include "render/parameter_textures.h"

#include <fmt/format.h>

#include "base/error.h"
#include "io/codec.h"
#include "render/scene_upload.h"

namespace quintet::render {
namespace {

io::Image white() {
  io::Image image = io::makeImage(1, 1, 4, io::PixelType::u8, io::ColorEncoding::linear);
  for (std::uint8_t& sample : image.samples<std::uint8_t>()) sample = 255;
  return image;
}

io::Image load(const program::Program& program, const program::ImageValue& value) {
  if (value.file.empty()) return white();
  if (!value.ofProgram) return io::readImage(value.file);
  const auto own = program.files.find(value.file);
  if (own == program.files.end()) return io::readImage(program.path(value.file));
  return io::decodeImage(std::as_bytes(std::span(own->second)), program.path(value.file));
}

}  // namespace

TextureSlots::TextureSlots(gpu::BindlessSet& set, std::uint32_t first, std::uint32_t count) : set_(set) {
  for (std::uint32_t i = count; i > 0; --i) free_.push_back(first + i - 1);
}

std::vector<std::uint32_t> TextureSlots::take(std::size_t count) {
  if (count > free_.size())
    throw UsageError(fmt::format("{} image parameters: the scene has room for {} more", count, free_.size()));
  const std::vector<std::uint32_t> slots(free_.rbegin(), free_.rbegin() + static_cast<std::ptrdiff_t>(count));
  free_.resize(free_.size() - count);
  return slots;
}

void TextureSlots::giveBack(std::span<const std::uint32_t> slots) {
  free_.insert(free_.end(), slots.rbegin(), slots.rend());
}

ParameterTextures::ParameterTextures(gpu::Context& context, TextureSlots& slots, const program::Program& program,
                                     const program::ParameterValues& values)
    : slots_(slots) {
  const std::vector<program::ImageValue> wanted = values.images();
  if (wanted.empty()) return;
  gpu::Uploader uploader(context);
  for (const program::ImageValue& value : wanted)
    addTexture(images_, context, uploader, load(program, value), value.sRgb, "parameter " + value.parameter);
  uploader.flush();
  sampler_ = gpu::Sampler(context, {});
  indices_ = slots_.take(wanted.size());
  for (std::size_t i = 0; i < images_.size(); ++i) slots_.set().setTexture(indices_[i], images_[i], sampler_);
}

ParameterTextures::~ParameterTextures() { slots_.giveBack(indices_); }

}  // namespace quintet::render
