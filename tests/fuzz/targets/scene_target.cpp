// SPDX-License-Identifier: Apache-2.0
#include "scene_target.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <vector>

#include "io/codec.h"
#include "scene/animation/pose.h"
#include "scene/model/content_hash.h"
#include "scene/model/validate.h"

namespace quintet::fuzz {
namespace {

namespace fs = std::filesystem;

void writeBytes(const fs::path& file, Input bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) reportFinding("cannot write " + file.string());
}

// One triangle.
constexpr std::string_view kPart =
    R"({"asset":{"version":"2.0"},"buffers":[{"uri":"data.bin","byteLength":36}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"materials":[{"name":"red"}],
"meshes":[{"name":"triangle","primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})";

std::vector<std::byte> imageBytes() {
  io::Image image = io::makeImage(2, 2, 4, io::PixelType::u8, io::ColorEncoding::sRgb);
  std::ranges::fill(image.data, std::byte{0x80});
  return io::encodePng(image);
}

// The temporary folder of the process.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "quintet-fuzz-XXXXXX").string();
    if (!mkdtemp(pattern.data())) reportFinding("cannot create a temporary folder");
    path_ = pattern;
    std::array<float, 64> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i * i % 7) / 4.0f;
    writeBytes(path_ / "data.bin", std::as_bytes(std::span(numbers)));
    writeBytes(path_ / "image.png", imageBytes());
    writeBytes(path_ / "part.gltf", std::as_bytes(std::span(kPart)));
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const Folder& folder() {
  static const Folder kFolder;
  return kFolder;
}

void checkValid(const scene::Scene& scene, std::string_view when) {
  try {
    scene::validate(scene);
  } catch (const Error& error) {
    reportFinding("the scene is not valid " + std::string(when) + ": " + error.what());
  }
}

}  // namespace

InputFile::InputFile(const std::string& name) : path_(folder().path() / name) {}

void InputFile::write(Input input) const { writeBytes(path_, input); }

scene::LoadOptions loadOptions() {
  scene::LoadOptions options;
  options.animation = "";
  options.missingTextures = scene::MissingTextures::warn;
  options.maxMemory = kMaxMemory;
  return options;
}

void checkScene(scene::Scene scene) {
  checkValid(scene, "at rest");
  (void)scene::contentHash(scene);
  const float last = scene::lastFrame(scene);
  if (last <= 0.0f) return;
  for (const double frame : {0.4 * static_cast<double>(last), static_cast<double>(last)}) {
    scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), frame));
    checkValid(scene, "in its animation");
  }
}

}  // namespace quintet::fuzz
