// SPDX-License-Identifier: Apache-2.0
// The properties of materials, lights, cameras and environments that an animation can change, by KHR_animation_pointer or
// by keyframes of a scene file.
#ifndef QUINTET_SCENE_ANIMATION_PROPERTIES_H
#define QUINTET_SCENE_ANIMATION_PROPERTIES_H

#include <optional>
#include <string_view>

#include "scene/model/scene.h"

namespace quintet::scene {

// A property by its index in the table of its kind of object.
struct PropertyInfo {
  std::size_t index = 0;
  std::size_t size = 1;  // number of floats
  // The member of a material whose texture the property transforms; null for other properties.
  TextureUse Material::*texture = nullptr;
};

// `pointer`: the JSON pointer in the glTF object, without a leading slash: "pbrMetallicRoughness/roughnessFactor". No
// value for a property that is unknown or that cannot change the image.
std::optional<PropertyInfo> findMaterialProperty(std::string_view pointer);
std::optional<PropertyInfo> findLightProperty(std::string_view pointer);
std::optional<PropertyInfo> findCameraProperty(std::string_view pointer);

// The property that a key of [[material]], [[light]], [[camera]] or [environment] in a scene file sets: "outer_angle".
// Angles are in radians.
std::optional<PropertyInfo> findMaterialKey(std::string_view key);
std::optional<PropertyInfo> findLightKey(std::string_view key);
std::optional<PropertyInfo> findCameraKey(std::string_view key);
std::optional<PropertyInfo> findEnvironmentKey(std::string_view key);

// Set a property; a value outside the range of the property is clamped. Properties must be set in the order of their
// indices, because some use those before them: the emissive strength and the intensity of a light multiply the color;
// the target of a light gives it a direction from its position; look_from, look_at and up of a camera, set together,
// make its frame, and look_at its focus distance. A direction or frame that is undefined stays as it is.
void setMaterialValue(Material&, std::size_t property, const vec4& value);
void setLightValue(Light&, std::size_t property, const vec4& value);
void setCameraValue(Camera&, std::size_t property, const vec4& value);
void setEnvironmentValue(Environment&, std::size_t property, const vec4& value);

}  // namespace quintet::scene
#endif
