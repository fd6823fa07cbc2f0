// SPDX-License-Identifier: Apache-2.0
// Quintet's C++ API: a scene, a program of ray tracing shaders and a device give an image.
//
//   quintet::Device device;
//   quintet::Renderer renderer(device, quintet::Scene::load("scene.glb"), quintet::Program::load("pathtracer"));
//   renderer.render(64);
//   renderer.image().write("scene.png");
//
// Conventions. Lengths are in meters, angles in radians. Frames are right-handed with y up; a camera looks along its -z
// axis. Images are linear with Rec. 709 primaries, rows from the top. Failures are exceptions of quintet/error.h.
// Objects are movable; use an object from one thread at a time. The library never prints and never exits.
#ifndef QUINTET_QUINTET_H
#define QUINTET_QUINTET_H

#include <quintet/cancellation.h>
#include <quintet/device.h>
#include <quintet/diagnostic.h>
#include <quintet/error.h>
#include <quintet/explanation.h>
#include <quintet/film.h>
#include <quintet/program.h>
#include <quintet/renderer.h>
#include <quintet/scene.h>
#include <quintet/types.h>

#endif
