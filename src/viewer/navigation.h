// SPDX-License-Identifier: Apache-2.0
// Movements of the mouse and held keys as commands of the session.
#ifndef QUINTET_VIEWER_NAVIGATION_H
#define QUINTET_VIEWER_NAVIGATION_H

#include <optional>
#include <set>

#include "base/math.h"
#include "job/interactive/command.h"
#include "viewer/bindings.h"

namespace quintet::viewer {

// Where the image is on the screen. Both have their origin in the top left corner.
struct ImagePlacement {
  vec2 origin{0.0f};   // of the image, screen coordinates
  float scale = 1.0f;  // screen coordinates per pixel of the image, > 0
  uvec2 size{0};       // of the image, pixels

  vec2 toImage(vec2 screen) const { return (screen - origin) / scale; }
  // The pixel below a position on the screen; nothing outside of the image.
  std::optional<uvec2> pixelAt(vec2 screen) const;
};

// The largest placement of an image in a rectangle of the screen, in its middle. At most `maxScale`; whole pixels if
// the scale is 1.
ImagePlacement fitImage(uvec2 image, vec2 origin, vec2 area, float maxScale);

// The command of a drag by `moved` screen coordinates that began at `start`.
job::interactive::Command dragCommand(Drag drag, vec2 moved, vec2 start, const ImagePlacement& placement);

// The command of the wheel: `steps` > 0 moves closer, and the point below `position` stays.
job::interactive::Command wheelCommand(float steps, vec2 position, const ImagePlacement& placement);

// The command of held keys after `seconds`. `sceneSize`: meters, the diagonal of the scene, which is crossed in four
// seconds, or in one second if `fast`. Nothing if the directions cancel.
std::optional<job::interactive::Command> flyCommand(const std::set<Fly>& held, double seconds, float sceneSize,
                                                    bool fast);

}  // namespace quintet::viewer
#endif
