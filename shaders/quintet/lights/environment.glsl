// SPDX-License-Identifier: Apache-2.0
// The environment, an equirectangular texture (bilinear) or a constant, and its importance sampling. A cell of the table
// is sampled by its probability, then a direction within the cell, uniform in solid angle: uniform in u and in cos θ. The
// density in a cell is its probability divided by its solid angle, which contains the sin θ of the map's Jacobian.
#ifndef QUINTET_LIGHTS_ENVIRONMENT_GLSL
#define QUINTET_LIGHTS_ENVIRONMENT_GLSL

#include "../sampling/hash.glsl"
#include "../shared/radiance.h"
#include "alias.glsl"
#include "equirect.glsl"
#include "light_sample.glsl"

vec3 environmentRadiance(vec3 direction) {
  const EnvironmentData e = frame.environment;
  if (e.texture == kNoTexture) return min(e.scale, kMaxRadiance);
  return min(e.scale * textureLod(textures[nonuniformEXT(e.texture)], equirectFromDirection(e, direction), 0.0).rgb, kMaxRadiance);
}

// Returns (cos θ_top - cos θ_bottom) / 2 of a row. The product form from the nearer pole avoids cancellation.
float environmentRowHeight(EnvironmentData e, uint row) {
  const float halfStep = 0.5 * kPi / float(e.height);
  const uint fromPole = min(row, e.height - 1u - row);
  return preciseSin(float(2u * fromPole + 1u) * halfStep) * preciseSin(halfStep);
}

// The table to sample. A program that combines light sampling with BSDF sampling at every surface, by MIS weights with
// environmentPdf, can define QUINTET_BALANCED_ENVIRONMENT: only what is brighter than the mean is sampled, because BSDF sampling
// finds the rest at least as well (Karlik et al. 2019, "MIS Compensation"). Light sampling alone would then miss light.
Address environmentTable(EnvironmentData e) {
#ifdef QUINTET_BALANCED_ENVIRONMENT
  return e.balancedTable;
#else
  return e.table;
#endif
}

float environmentCellAngle(EnvironmentData e, uint row) {
#ifdef QUINTET_WRONG_ENVIRONMENT_PDF
  return 4.0 * kPi / float(e.width * e.height);  // a wrong pdf without sin θ, for tests
#endif
  return 4.0 * kPi / float(e.width) * environmentRowHeight(e, row);
}

// Returns the density per solid angle of environmentSample.
float environmentPdf(vec3 direction) {
  const EnvironmentData e = frame.environment;
  if (e.table == 0ul) return 0.0;
  const uvec2 size = uvec2(e.width, e.height);
  const uvec2 cell = min(uvec2(equirectFromDirection(e, direction) * vec2(size)), size - 1u);
  return AliasArray(environmentTable(e)).at[cell.y * e.width + cell.x].probability / environmentCellAngle(e, cell.y);
}

// Returns a direction and its density. u is a point of the map, so stratified u stays stratified where the table keeps its
// entries. `bits`, independent of u, choose between entry and alias.
vec3 environmentSample(vec2 u, uint bits, out float pdf) {
  const EnvironmentData e = frame.environment;
  uvec2 fraction;
  const uint more = hash(bits);
  uint column = splitIndex(u.x, more, e.width, fraction.x);
  uint row = splitIndex(u.y, hash(more), e.height, fraction.y);
  float probability;
  const uint cell = resolveAlias(AliasArray(environmentTable(e)), row * e.width + column, fractionFloat(bits), probability);
  row = cell / e.width;
  column = cell - row * e.width;
  pdf = probability / environmentCellAngle(e, row);

  // sin²(θ/2) = (1 - cos θ)/2 from the nearer pole is precise close to the pole.
  const bool below = 2u * row >= e.height;
  const uint fromPole = below ? e.height - 1u - row : row;
  const float top = preciseSin(float(fromPole) * 0.5 * kPi / float(e.height));
  const float s = top * top + fractionFloat(below ? ~fraction.y : fraction.y) * environmentRowHeight(e, row);
  return directionFromEquirect(e, (float(column) + fractionFloat(fraction.x)) / float(e.width), s, below);
}

bool sampleEnvironmentLight(vec2 u, uint bits, inout LightSample s) {
  if (frame.environment.table == 0ul) return false;
  float pdf;
  const vec3 wi = environmentSample(u, bits, pdf);
  lightFromInfinity(wi, environmentRadiance(wi), false, s);
  s.pdf = pdf;
  return pdf > 0.0 && maxComponent(s.radiance) > 0.0;
}

#endif
