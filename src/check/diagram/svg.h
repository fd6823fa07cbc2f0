// SPDX-License-Identifier: Apache-2.0
// A diagram as a picture: SVG 1.1 with its own colors, which needs neither scripts nor fonts beyond a monospaced one.
#ifndef QUINTET_CHECK_DIAGRAM_SVG_H
#define QUINTET_CHECK_DIAGRAM_SVG_H

#include <string>

#include "check/diagram/diagram.h"

namespace quintet::check {

std::string svgText(const Diagram& diagram);

}  // namespace quintet::check
#endif
