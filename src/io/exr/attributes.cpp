// SPDX-License-Identifier: Apache-2.0
#include "io/exr/attributes.h"

#include <ImfBoxAttribute.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFramesPerSecond.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfRationalAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfStringVectorAttribute.h>
#include <ImfTimeCodeAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/error.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

// Attributes that OpenEXR itself uses.
constexpr std::array<std::string_view, 18> kOwn{"channels",
                                                "chunkCount",
                                                "compression",
                                                "dataWindow",
                                                "displayWindow",
                                                "lineOrder",
                                                "pixelAspectRatio",
                                                "preview",
                                                "name",
                                                "screenWindowCenter",
                                                "screenWindowWidth",
                                                "tiles",
                                                "type",
                                                "version",
                                                "view",
                                                "multiView",
                                                "deepImageState",
                                                "maxSamplesPerPixel"};

bool isOwn(std::string_view name) { return std::ranges::find(kOwn, name) != kOwn.end(); }

// m44f is row-major and multiplies row vectors, so its rows are the columns of our matrix for column vectors.
Imath::M44f toImath(const mat4& m) {
  Imath::M44f result;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      result[row][column] = m[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  return result;
}
mat4 fromImath(const Imath::M44f& m) {
  mat4 result;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      result[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = m[row][column];
  return result;
}

struct Inserter {
  Imf::Header& header;
  const std::string& name;

  void operator()(const std::string& text) const { header.insert(name, Imf::StringAttribute(text)); }
  void operator()(std::int32_t value) const { header.insert(name, Imf::IntAttribute(value)); }
  void operator()(float value) const { header.insert(name, Imf::FloatAttribute(value)); }
  void operator()(double value) const { header.insert(name, Imf::DoubleAttribute(value)); }
  void operator()(const vec2& v) const { header.insert(name, Imf::V2fAttribute({v.x, v.y})); }
  void operator()(const vec3& v) const { header.insert(name, Imf::V3fAttribute({v.x, v.y, v.z})); }
  void operator()(const mat4& m) const { header.insert(name, Imf::M44fAttribute(toImath(m))); }
  void operator()(const std::vector<std::string>& list) const { header.insert(name, Imf::StringVectorAttribute(list)); }
  void operator()(const ExrRational& r) const {
    header.insert(name, Imf::RationalAttribute({r.numerator, static_cast<int>(r.denominator)}));
  }
  void operator()(const ExrChromaticities& c) const {
    const auto toV2f = [](const vec2& v) { return Imath::V2f(v.x, v.y); };
    header.insert(name, Imf::ChromaticitiesAttribute({toV2f(c.red), toV2f(c.green), toV2f(c.blue), toV2f(c.white)}));
  }
};

void checkName(const Imf::Header& header, const std::string& name) {
  if (isOwn(name) || header.find(name) != header.end())
    throw UsageError(fmt::format("the metadata keyword '{}' is given twice or reserved by OpenEXR", name));
}

// Returns no value for types that ExrValue does not support.
std::optional<ExrValue> valueOf(const Imf::Attribute& attribute) {
  if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) return text->value();
  if (const auto* whole = dynamic_cast<const Imf::IntAttribute*>(&attribute)) return std::int32_t{whole->value()};
  if (const auto* real = dynamic_cast<const Imf::FloatAttribute*>(&attribute)) return real->value();
  if (const auto* real = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) return real->value();
  if (const auto* v = dynamic_cast<const Imf::V2fAttribute*>(&attribute)) return vec2(v->value().x, v->value().y);
  if (const auto* v = dynamic_cast<const Imf::V3fAttribute*>(&attribute))
    return vec3(v->value().x, v->value().y, v->value().z);
  if (const auto* m = dynamic_cast<const Imf::M44fAttribute*>(&attribute)) return fromImath(m->value());
  if (const auto* list = dynamic_cast<const Imf::StringVectorAttribute*>(&attribute)) return list->value();
  if (const auto* r = dynamic_cast<const Imf::RationalAttribute*>(&attribute))
    return ExrRational{r->value().n, r->value().d};
  if (const auto* c = dynamic_cast<const Imf::ChromaticitiesAttribute*>(&attribute)) {
    const auto toVec2 = [](const Imath::V2f& v) { return vec2(v.x, v.y); };
    const Imf::Chromaticities& value = c->value();
    return ExrChromaticities{toVec2(value.red), toVec2(value.green), toVec2(value.blue), toVec2(value.white)};
  }
  return std::nullopt;
}

struct Describer {
  std::string operator()(const std::string& text) const { return text; }
  std::string operator()(std::int32_t value) const { return fmt::format("{}", value); }
  std::string operator()(float value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(const vec2& v) const { return fmt::format("{}, {}", v.x, v.y); }
  std::string operator()(const vec3& v) const { return fmt::format("{}, {}, {}", v.x, v.y, v.z); }
  std::string operator()(const mat4& m) const {
    std::string text;
    for (std::size_t row = 0; row < 4; ++row)
      text += fmt::format("{}{}, {}, {}, {}", row == 0 ? "" : "; ", m[row].x, m[row].y, m[row].z, m[row].w);
    return text;
  }
  std::string operator()(const std::vector<std::string>& list) const {
    return fmt::format("{}", fmt::join(list, ", "));
  }
  std::string operator()(const ExrRational& r) const { return fmt::format("{}/{}", r.numerator, r.denominator); }
  std::string operator()(const ExrChromaticities& c) const {
    return fmt::format("red {}, {}; green {}, {}; blue {}, {}; white {}, {}", c.red.x, c.red.y, c.green.x, c.green.y,
                       c.blue.x, c.blue.y, c.white.x, c.white.y);
  }
};

std::string textOf(const Imf::Attribute& attribute) {
  if (const auto value = valueOf(attribute)) return std::visit(Describer{}, *value);
  if (const auto* v = dynamic_cast<const Imf::V2iAttribute*>(&attribute))
    return fmt::format("{}, {}", v->value().x, v->value().y);
  if (const auto* b = dynamic_cast<const Imf::Box2iAttribute*>(&attribute))
    return fmt::format("{}, {}, {}, {}", b->value().min.x, b->value().min.y, b->value().max.x, b->value().max.y);
  return "";
}

}  // namespace

ExrRational exrFrameRate(double framesPerSecond) {
  const Imf::Rational rate = Imf::guessExactFps(framesPerSecond);
  return {rate.n, rate.d};
}

void addMetadata(Imf::Header& header, const Metadata& metadata) {
  checkMetadata(metadata);
  for (const auto& [key, text] : metadata) {
    checkName(header, key);
    header.insert(key, Imf::StringAttribute(text));
  }
}

void addAttributes(Imf::Header& header, const std::vector<ExrAttribute>& attributes) {
  for (const ExrAttribute& attribute : attributes) {
    checkMetadata({{attribute.name, ""}});
    checkName(header, attribute.name);
    std::visit(Inserter{header, attribute.name}, attribute.value);
  }
}

Metadata readStrings(const Imf::Header& header) {
  Metadata metadata;
  for (auto it = header.begin(); it != header.end(); ++it)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
      if (!isOwn(it.name())) metadata.emplace_back(it.name(), text->value());
  return metadata;
}

std::vector<ExrAttribute> readAttributes(const Imf::Header& header) {
  std::vector<ExrAttribute> attributes;
  for (auto it = header.begin(); it != header.end(); ++it) {
    if (isOwn(it.name()) || dynamic_cast<const Imf::StringAttribute*>(&it.attribute())) continue;
    if (auto value = valueOf(it.attribute())) attributes.push_back({it.name(), std::move(*value)});
  }
  return attributes;
}

std::vector<ExrPartInfo::Attribute> describeAttributes(const Imf::Header& header) {
  std::vector<ExrPartInfo::Attribute> attributes;
  for (auto it = header.begin(); it != header.end(); ++it)
    if (!isOwn(it.name())) attributes.push_back({it.name(), it.attribute().typeName(), textOf(it.attribute())});
  return attributes;
}

}  // namespace quintet::io
