// SPDX-License-Identifier: Apache-2.0
#include <imgui.h>

#include "gui/widgets.h"
#include "panels/panels.h"
#include "viewer/labels.h"

namespace quintet::viewer {

void instanceProperties(ViewState& state, std::size_t index) {
  const SceneOutline& scene = *state.snapshot->scene;
  const InstanceOutline& instance = scene.instances[index];
  ImGui::PushID(static_cast<int>(index));
  textRow("Object", instance.name);
  if (!instance.mesh.empty() && instance.mesh != instance.name) textRow("Mesh", instance.mesh);
  if (instance.triangles > 0) textRow("Triangles", groupedDigits(instance.triangles));
  if (instance.boxes > 0) textRow("Primitives", groupedDigits(instance.boxes));
  const mat4 transform = transformOf(scene, state.snapshot->state, index);
  if (instance.animated) {
    ImGui::TextDisabled("Keyframes move this object.");
  } else {
    double position[3] = {transform[3].x, transform[3].y, transform[3].z};
    if (vectorField("Position", position, 3, {}, "World space, meters")) {
      mat4 moved = transform;
      moved[3] = {position[0], position[1], position[2], 1.0};
      state.apply(job::interactive::SetTransform{instance.name, moved});
    }
  }
  if (button("Show", "Move the camera so that the object fills the image (F)"))
    state.apply(job::interactive::Frame{instance.name});
  sameLineIfFits("Reset");
  if (button("Reset", "Restore the transform of the file", state.snapshot->state.transforms.count(index) > 0))
    state.apply(job::interactive::SetTransform{instance.name, instance.worldFromObject});
  for (const std::size_t material : instance.materials) {
    ImGui::Separator();
    materialProperties(state, material);
  }
  ImGui::PopID();
}

}  // namespace quintet::viewer
