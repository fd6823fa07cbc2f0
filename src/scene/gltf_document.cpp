#include "scene/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "scene/gltf_accessor_layout.h"
#include "scene/gltf_extensions.h"
#include "scene/gltf_meshopt.h"
#include "scene/gltf_schema.h"
#include "scene/printable.h"

namespace quintet::scene {
namespace {

using nlohmann::json;

std::string lineAndColumn(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t start = before.rfind('\n') + 1;  // npos + 1 = 0
  return fmt::format("line {}, column {}", line, std::max<std::size_t>(1, before.size() - start));
}

// nlohmann's "[json.exception…] parse error at line 1, column 2: syntax error …": only what follows the place.
std::string afterPlace(std::string what) {
  const std::size_t bracket = what.find("] ");
  if (bracket != std::string::npos) what.erase(0, bracket + 2);
  const std::size_t colon = what.find(": ");
  if (what.starts_with("parse error at ") && colon != std::string::npos) what.erase(0, colon + 2);
  return what;
}

json parseJson(const std::filesystem::path& file, std::string_view text) {
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    throw FileError(file, lineAndColumn(text, error.byte),
                    "the JSON is broken: " + printable(afterPlace(error.what())));
  } catch (const json::exception& error) {  // a number beyond the range of double; no place is given
    const std::string problem = afterPlace(error.what());
    const std::size_t quote = problem.find('\'');
    const std::string token =
        quote == std::string::npos ? "" : problem.substr(quote + 1, problem.rfind('\'') - quote - 1);
    const std::size_t byte = token.empty() ? std::string_view::npos : text.find(token);
    throw FileError(file, byte == std::string_view::npos ? "" : lineAndColumn(text, byte + 1), printable(problem));
  }
}

void checkVersion(const Document& document, const json& asset) {
  const auto major = [&](const char* key) {
    const std::string version = asset.value(key, "2.0");
    if (!version.starts_with("2.")) {
      document.fail(fmt::format("/asset/{}", key),
                    fmt::format("glTF {} is not supported, only 2.x", version.substr(0, 20)));
    }
  };
  major("version");
  major("minVersion");
}

// Objects that another property makes necessary. A spot without "spot" has only defaults; tinygltf wants it.
void checkDependencies(const Document& document, json& checked) {
  const auto cameras = checked.find("cameras");
  for (std::size_t i = 0; cameras != checked.end() && i < cameras->size(); ++i) {
    const auto& type = (*cameras)[i]["type"].get_ref<const std::string&>();
    if (!(*cameras)[i].contains(type)) document.fail(fmt::format("/cameras/{}", i), type + " is missing");
  }
  const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
  if (!checked.contains(lights)) return;
  for (json& light : checked[lights])
    if (!light.contains("spot")) light["spot"] = json::object();
}

// Two things are kept from tinygltf 2.7.0 until it has read the file. It refuses index accessors without a
// buffer view, which are legal (Draco, sparse): they point to one view too many. And it refuses strides that are
// no multiple of four, which do no harm. Tests: GltfSparse.IndicesWithoutBufferView, GltfAccessor.OddStrides.
tinygltf::Model parseModel(const Document& document, json& checked) {
  json& views = checked["bufferViews"];
  const std::size_t viewCount = views.size();  // null has none
  std::vector<std::size_t> strides;
  for (json& view : views) {
    strides.push_back(view.value("byteStride", std::size_t{0}));
    view.erase("byteStride");
  }
  views.push_back({{"buffer", 0}, {"byteLength", 1}});
  if (const auto accessors = checked.find("accessors"); accessors != checked.end())
    for (json& accessor : *accessors)
      if (!accessor.contains("bufferView")) accessor["bufferView"] = viewCount;

  tinygltf::Model model;
  tinygltf::TinyGLTF parser;
  std::string error, warning;
  const std::string text = checked.dump();
  if (text.size() > std::numeric_limits<unsigned>::max()) document.fail("", "more than 4 GiB of JSON");
  if (!parser.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), ""))
    document.fail("", error.substr(0, error.find('\n')));

  model.bufferViews.pop_back();
  for (std::size_t i = 0; i < viewCount; ++i) model.bufferViews[i].byteStride = strides[i];
  for (tinygltf::Accessor& accessor : model.accessors)
    if (accessor.bufferView == static_cast<int>(viewCount)) accessor.bufferView = kNone;
  return model;
}

std::vector<ImageSource> readImageSources(const Document& document, const json& images) {
  std::vector<ImageSource> sources;
  for (std::size_t i = 0; i < images.size(); ++i) {
    ImageSource source{images[i].value("name", ""), images[i].value("uri", ""), images[i].value("bufferView", kNone)};
    if (source.uri.empty() == (source.bufferView == kNone))
      document.fail(fmt::format("/images/{}", i), "needs either a uri or a bufferView");
    sources.push_back(std::move(source));
  }
  return sources;
}

// A buffer without uri and BIN chunk gives a null span: EXT_meshopt_compression's fallback buffers are such.
std::vector<std::span<const std::byte>> loadBuffers(Document& document, const json& buffers,
                                                    const Container& container) {
  std::vector<std::span<const std::byte>> result;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const json& buffer = buffers[i];
    const std::string place = fmt::format("/buffers/{}", i);
    const auto length = buffer["byteLength"].get<std::uint64_t>();
    std::span<const std::byte> data;
    if (buffer.contains("uri")) {
      const auto& uri = buffer["uri"].get_ref<const std::string&>();
      data = document.storage.emplace_back(loadUri(document, uri, place + "/uri"));
      if (!isDataUri(uri)) document.files.push_back(pathOfUri(document, uri));
    } else if (i == 0 && container.binary.data()) {
      data = container.binary;
    } else {
      result.emplace_back();
      continue;
    }
    if (data.size() < length)
      document.fail(place + "/byteLength", fmt::format("{} bytes, but the buffer has only {}", length, data.size()));
    result.push_back(data.first(length));
  }
  return result;
}

void resolveBufferViews(Document& document, const json& bufferList,
                        std::span<const std::span<const std::byte>> buffers) {
  for (std::size_t i = 0; i < document.model.bufferViews.size(); ++i) {
    const tinygltf::BufferView& view = document.model.bufferViews[i];
    const std::string place = fmt::format("/bufferViews/{}", i);
    if (view.extensions.contains(kMeshopt)) {
      document.bufferViews.push_back(document.storage.emplace_back(
          decodeMeshopt(document, view, buffers, fmt::format("{}/extensions/{}", place, kMeshopt))));
      continue;
    }
    const auto buffer = static_cast<std::size_t>(view.buffer);
    const auto size = bufferList[buffer]["byteLength"].get<std::uint64_t>();
    const std::size_t end = view.byteOffset + view.byteLength;  // both < 2^53
    if (end > size) document.fail(place, fmt::format("{} bytes past the end of buffer {}", end - size, buffer));
    document.bufferViews.push_back(buffers[buffer].data() ? buffers[buffer].subspan(view.byteOffset, view.byteLength)
                                                          : std::span<const std::byte>{});
  }
}

}  // namespace

void Document::fail(std::string_view place, std::string_view problem) const {
  throw FileError(file, printable(place), printable(problem));
}

std::span<const std::byte> Document::view(int bufferView) const {
  const auto index = static_cast<std::size_t>(bufferView);
  if (!bufferViews[index].data())
    fail(fmt::format("/buffers/{}", model.bufferViews[index].buffer), "has no data: neither a uri nor a BIN chunk");
  return bufferViews[index];
}

Document readDocument(const std::filesystem::path& file) {
  Document document;
  document.file = file;
  document.files.push_back(file);
  const FileBytes& bytes = document.storage.emplace_back(readLargeFile(file));
  const Container container = splitContainer(file, bytes);
  json root = parseJson(file, container.json);
  json checked = checkSchema(file, root);
  if (const auto animations = root.find("animations"); animations != root.end() && animations->is_array())
    document.animationCount = animations->size();
  checkVersion(document, checked["asset"]);
  checkDependencies(document, checked);
  checkRequiredExtensions(document, checked.value("extensionsRequired", std::vector<std::string>{}));

  const json buffers = std::exchange(checked["buffers"], json::array());
  const json images = std::exchange(checked["images"], json::array());
  document.images = readImageSources(document, images);
  for (const ImageSource& image : document.images)
    if (!image.uri.empty() && !isDataUri(image.uri)) document.files.push_back(pathOfUri(document, image.uri));
  document.model = parseModel(document, checked);
  resolveBufferViews(document, buffers, loadBuffers(document, buffers, container));
  checkAccessors(document);
  return document;
}

}  // namespace quintet::scene
