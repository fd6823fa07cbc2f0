// SPDX-License-Identifier: Apache-2.0
// Movements of the mouse and held keys as commands of the session.
#ifndef QUINTET_VIEWER_NAVIGATION_H
#define QUINTET_VIEWER_NAVIGATION_H

#include <optional>
#include <set>

#include "base/math.h"
#include "job/interactive/command.h"
#include "overlay/image_placement.h"
#include "viewer/bindings.h"

namespace quintet::viewer {

// The command of a drag by `moved` screen coordinates that began at `start`.
job::interactive::Command dragCommand(Drag drag, vec2 moved, vec2 start, const overlay::ImagePlacement& placement);

// The command of the wheel: `steps` > 0 moves closer, and the point below `position` stays.
job::interactive::Command wheelCommand(float steps, vec2 position, const overlay::ImagePlacement& placement);

// The command of held keys after `seconds`. `sceneSize`: meters, the diagonal of the scene, which is crossed in four
// seconds, or in one second if `fast`. Nothing if the directions cancel.
std::optional<job::interactive::Command> flyCommand(const std::set<Fly>& held, double seconds, float sceneSize,
                                                    bool fast);

}  // namespace quintet::viewer
#endif
