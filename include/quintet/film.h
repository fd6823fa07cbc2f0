// SPDX-License-Identifier: Apache-2.0
// What a render returns: images, layers (AOVs) as arrays, and files of them.
#ifndef QUINTET_FILM_H
#define QUINTET_FILM_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <quintet/error.h>

namespace quintet {

// RGBA floats, linear, premultiplied, rows from the top.
struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> pixels{};  // 4 · width · height
  bool toneMap = true;          // .png: Khronos PBR Neutral before the sRGB curve; false if values are not radiance
  std::array<float, 4> at(std::uint32_t x, std::uint32_t y) const;  // (0, 0) is the top left; throws UsageError
  // Writes .png (sRGB, 8 bits), .exr (half, linear) or .hdr in one step. Throws FileError, UsageError. Like Film::write(), not
  // to standard output.
  void write(const std::filesystem::path& file) const;
};

// An array of height · width · channels values, rows from the top, channels interleaved. Ids are integers: 1 + the index of
// an object of the scene, 0 for none; `ids` then holds them and `values` is empty. All else is floats: linear colors, unit
// vectors, meters.
struct Layer {
  std::string name{};
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::string> channels{};  // "R", "G", "B"; "X"; names with ranks for Cryptomatte
  std::vector<float> values{};
  std::vector<std::uint32_t> ids{};
};

// What Film::write() stores besides the image.
struct WriteOptions {
  std::vector<std::string> layers{};  // .exr: names of layers beside the image, or "all"
  bool floats = false;    // .exr: colors as 32-bit floats instead of half; all other layers are always floats
  double exposure = 0;    // .png: stops, -100 to 100
  std::string toneMap{};  // .png: "linear", "aces", "agx" or "neutral"; default: neutral for colors, linear for data
  unsigned pngBits = 8;   // .png: bits per channel, 8 or 16
};

// The result of a render in host memory: the image, the layers that were rendered, the exact sums of samples, and how the
// image was made. Copies share their data, which never changes, so a film can be used from several threads.
class Film {
 public:
  // Reads a .qfilm file: a checkpoint or a part of a render. `maxMemory`: bytes of host memory that the file can request;
  // 0 means 80 % of the machine's memory. Throws FileError; MemoryError above the limit, before the memory is allocated.
  static Film load(const std::filesystem::path& file, std::size_t maxMemory = 0);
  // Joins parts of one render (Settings::batches) into the bytes of one render of all samples. Throws FileError if the
  // parts belong to different renders or share samples. `maxMemory` of each part: as for load().
  static Film merge(const std::vector<std::filesystem::path>& parts, std::size_t maxMemory = 0);

  std::uint32_t width() const;              // pixels, of the rendered region
  std::uint32_t height() const;             // pixels, of the rendered region
  double sampleCount() const;               // per pixel, an average for adaptive sampling; or frames
  std::vector<std::string> layers() const;  // the names that layer() and WriteOptions::layers accept
  // The mean of the samples, or the last frame. An empty name means the first output. Throws UsageError for an unknown name
  // and for an output that was not rendered.
  Image image(const std::string& output = {}) const;
  // Also the first output under its name, as image() with the channels R, G, B and A. Throws UsageError.
  Layer layer(const std::string& name) const;
  // How the image was made: (name, text) of scene, program, parameters, camera, device, samples, …
  std::vector<std::pair<std::string, std::string>> metadata() const;
  // Writes .png, .exr with layers, .hdr, or .qfilm (everything, for load() and merge()) in one step. Throws FileError,
  // UsageError.
  void write(const std::filesystem::path& file, const WriteOptions& options = {}) const;

 private:
  friend class Renderer;
  struct Impl;
  const Impl& impl() const;  // throws UsageError for an empty object
  std::shared_ptr<const Impl> impl_;
};

}  // namespace quintet
#endif
