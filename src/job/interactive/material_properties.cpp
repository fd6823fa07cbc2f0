// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/material_properties.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "base/suggestion.h"

namespace quintet::job::interactive {
namespace {

using scene::Material;
using Member = std::variant<float Material::*, vec3 Material::*, vec4 Material::*, bool Material::*>;

constexpr std::array<std::pair<std::string_view, Member>, 32> kMaterialProperties{{
    {"baseColor", &Material::baseColor},
    {"metallic", &Material::metallic},
    {"roughness", &Material::roughness},
    {"normalScale", &Material::normalScale},
    {"emissive", &Material::emissive},
    {"alphaCutoff", &Material::alphaCutoff},
    {"doubleSided", &Material::doubleSided},
    {"unlit", &Material::unlit},
    {"ior", &Material::ior},
    {"transmission", &Material::transmission},
    {"thickness", &Material::thickness},
    {"attenuationDistance", &Material::attenuationDistance},
    {"attenuationColor", &Material::attenuationColor},
    {"specular", &Material::specular},
    {"specularColor", &Material::specularColor},
    {"clearcoat", &Material::clearcoat},
    {"clearcoatRoughness", &Material::clearcoatRoughness},
    {"clearcoatNormalScale", &Material::clearcoatNormalScale},
    {"sheenColor", &Material::sheenColor},
    {"sheenRoughness", &Material::sheenRoughness},
    {"diffuseTransmission", &Material::diffuseTransmission},
    {"diffuseTransmissionColor", &Material::diffuseTransmissionColor},
    {"anisotropy", &Material::anisotropy},
    {"anisotropyRotation", &Material::anisotropyRotation},
    {"iridescence", &Material::iridescence},
    {"iridescenceIor", &Material::iridescenceIor},
    {"iridescenceThicknessMinimum", &Material::iridescenceThicknessMinimum},
    {"iridescenceThicknessMaximum", &Material::iridescenceThicknessMaximum},
    {"dispersion", &Material::dispersion},
    {"multiscatterColor", &Material::multiscatterColor},
    {"scatterAnisotropy", &Material::scatterAnisotropy},
    {"dielectricPriority", &Material::dielectricPriority},
}};

// Components of a value; a base color can omit alpha.
struct Assign {
  Material& material;
  std::span<const double> values;

  bool operator()(float Material::*member) const {
    if (values.size() != 1) return false;
    material.*member = static_cast<float>(values[0]);
    return true;
  }
  bool operator()(bool Material::*member) const {
    if (values.size() != 1 || (values[0] != 0 && values[0] != 1)) return false;
    material.*member = values[0] == 1;
    return true;
  }
  bool operator()(vec3 Material::*member) const {
    if (values.size() != 3) return false;
    material.*member = vec3(values[0], values[1], values[2]);
    return true;
  }
  bool operator()(vec4 Material::*member) const {
    if (values.size() != 3 && values.size() != 4) return false;
    const double alpha = values.size() == 4 ? values[3] : static_cast<double>((material.*member).a);
    material.*member = vec4(values[0], values[1], values[2], alpha);
    return true;
  }
};

struct Read {
  const Material& material;

  std::vector<double> operator()(float Material::*member) const { return {material.*member}; }
  std::vector<double> operator()(bool Material::*member) const { return {material.*member ? 1.0 : 0.0}; }
  std::vector<double> operator()(vec3 Material::*member) const {
    const vec3& v = material.*member;
    return {v.x, v.y, v.z};
  }
  std::vector<double> operator()(vec4 Material::*member) const {
    const vec4& v = material.*member;
    return {v.x, v.y, v.z, v.w};
  }
};

// Of the values that Assign takes.
const char* formOf(const Member& member) {
  constexpr const char* kForms[] = {"a number", "three numbers", "three or four numbers", "true or false"};
  return kForms[member.index()];
}

}  // namespace

std::vector<std::string> materialProperties() {
  std::vector<std::string> names;
  for (const auto& [name, member] : kMaterialProperties) names.emplace_back(name);
  return names;
}

namespace {

const Member& findMember(const std::string& name) {
  const auto found = std::ranges::find(kMaterialProperties, name, &std::pair<std::string_view, Member>::first);
  if (found == kMaterialProperties.end())
    throw UsageError(
        fmt::format("materials have no property '{}'{}", name, suggestionOrList(name, materialProperties())));
  return found->second;
}

}  // namespace

void setMaterialProperty(Material& material, const std::string& name, std::span<const double> values) {
  const Member& member = findMember(name);
  if (!std::visit(Assign{material, values}, member))
    throw UsageError(fmt::format("the property '{}' of a material is {}", name, formOf(member)));
}

std::vector<double> materialPropertyValue(const Material& material, const std::string& name) {
  return std::visit(Read{material}, findMember(name));
}

}  // namespace quintet::job::interactive
