// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <imgui.h>

#include "gui/widgets.h"
#include "panels/panels.h"

namespace quintet::viewer {
namespace {

// Rows that edit one material.
class Editor {
 public:
  Editor(ViewState& state, const std::string& material) : state_(state), material_(material) {}

  void number(const char* label, const char* property, float value, const NumberRange& range, const char* help) {
    double edited = value;
    if (numberField(label, edited, range, help)) set(property, {edited});
  }
  void color(const char* label, const char* property, vec3 value, const char* help) {
    if (colorField(label, value, help)) set(property, {value.r, value.g, value.b});
  }
  void flag(const char* label, const char* property, bool value, const char* help) {
    if (checkBox(label, value, help)) set(property, {value ? 1.0 : 0.0});
  }

 private:
  void set(const char* property, std::vector<double> numbers) {
    state_.apply(job::interactive::EditMaterial{material_, {{property, std::move(numbers)}}});
  }

  ViewState& state_;
  const std::string& material_;
};

constexpr NumberRange kUnit{.least = 0.0, .most = 1.0};

}  // namespace

void materialProperties(ViewState& state, std::size_t index) {
  const SceneOutline& scene = *state.snapshot->scene;
  const scene::Material& material = materialOf(scene, state.snapshot->state, index);
  Editor edit(state, scene.materialNames[index]);
  ImGui::PushID("material");
  ImGui::PushID(static_cast<int>(index));
  textRow("Material", scene.materialNames[index]);
  edit.color("Base color", "baseColor", vec3(material.baseColor),
             material.baseColorTexture.used() ? "Linear Rec. 709; multiplies the texture" : "Linear Rec. 709");
  edit.number("Metallic", "metallic", material.metallic, kUnit, "0: dielectric, 1: metal");
  edit.number("Roughness", "roughness", material.roughness, kUnit, "Perceptual; alpha is its square");
  edit.color("Emission", "emissive", material.emissive, "Radiance, W/(sr·m²)");
  edit.number("Index of refraction", "ior", material.ior, {.least = 1.0, .most = 3.0},
              "Index of refraction of dielectrics");
  edit.number("Transmission", "transmission", material.transmission, kUnit,
              "Fraction of light that enters the surface");
  if (material.transmission > 0.0f || material.thickness > 0.0f) {
    edit.number("Thickness", "thickness", material.thickness, {.least = 0.0, .most = 10.0, .unit = "m"},
                "0: a thin wall; above 0: a closed solid");
    if (std::isfinite(material.attenuationDistance))
      edit.number("Attenuation distance", "attenuationDistance", material.attenuationDistance,
                  {.least = 1e-4, .most = 1e5, .logarithmic = true, .unit = "m"},
                  "After this distance, white light has the attenuation color");
    edit.color("Attenuation color", "attenuationColor", material.attenuationColor, "Linear Rec. 709");
    edit.number("Dispersion", "dispersion", material.dispersion, {.least = 0.0, .most = 2.0},
                "20 / Abbe number; solids refract colors differently");
    edit.color("Scattering", "multiscatterColor", material.multiscatterColor,
               "Color after many scatterings in the solid; black: it only absorbs");
    if (material.multiscatterColor != vec3(0.0f))
      edit.number("Scatter anisotropy", "scatterAnisotropy", material.scatterAnisotropy, {.least = -0.99, .most = 0.99},
                  "Above 0: forwards");
    edit.number("Dielectric priority", "dielectricPriority", material.dielectricPriority,
                {.least = -10.0, .most = 10.0},
                "Where solids overlap, the one with the highest priority fills the space");
  }
  edit.number("Specular", "specular", material.specular, kUnit, "Strength of the dielectric reflection");
  edit.number("Clearcoat", "clearcoat", material.clearcoat, kUnit, "Strength of the clear coat");
  if (material.clearcoat > 0.0f)
    edit.number("Clearcoat roughness", "clearcoatRoughness", material.clearcoatRoughness, kUnit, "Perceptual");
  edit.color("Sheen color", "sheenColor", material.sheenColor, "Linear Rec. 709; black: no sheen");
  if (material.sheenColor != vec3(0.0f))
    edit.number("Sheen roughness", "sheenRoughness", material.sheenRoughness, kUnit, "Perceptual");
  edit.number("Diffuse transmission", "diffuseTransmission", material.diffuseTransmission, kUnit,
              "Part of the diffuse light that passes to the other side");
  if (material.diffuseTransmission > 0.0f)
    edit.color("Diffuse transmission color", "diffuseTransmissionColor", material.diffuseTransmissionColor,
               "Linear Rec. 709");
  edit.number("Anisotropy", "anisotropy", material.anisotropy, kUnit, "Reflections are longer in one direction");
  if (material.anisotropy > 0.0f)
    edit.number("Anisotropy rotation", "anisotropyRotation", material.anisotropyRotation,
                {.least = -3.1416, .most = 3.1416, .unit = "rad"}, "From the tangent to the bitangent");
  edit.number("Iridescence", "iridescence", material.iridescence, kUnit, "Weight of a thin film over the surface");
  if (material.iridescence > 0.0f) {
    edit.number("Film index of refraction", "iridescenceIor", material.iridescenceIor, {.least = 1.0, .most = 3.0},
                "Index of refraction of the thin film");
    edit.number("Film thickness", "iridescenceThicknessMaximum", material.iridescenceThicknessMaximum,
                {.least = 0.0, .most = 2000.0, .unit = "nm"}, "Where the texture is 1, and without a texture");
    if (material.iridescenceThicknessTexture.used())
      edit.number("Least film thickness", "iridescenceThicknessMinimum", material.iridescenceThicknessMinimum,
                  {.least = 0.0, .most = 2000.0, .unit = "nm"}, "Where the texture is 0");
  }
  if (material.alphaMode == scene::AlphaMode::mask)
    edit.number("Alpha cutoff", "alphaCutoff", material.alphaCutoff, kUnit, "Less opaque points are invisible");
  edit.flag("Double-sided", "doubleSided", material.doubleSided, "The back is visible too");
  edit.flag("Unlit", "unlit", material.unlit, "The base color is the outgoing radiance");
  ImGui::PopID();
  ImGui::PopID();
}

}  // namespace quintet::viewer
