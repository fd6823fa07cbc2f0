// SPDX-License-Identifier: Apache-2.0
// The solids that a path is in, and what a surface separates (C. Schmidt and B. Budge, "Simple Nested Dielectrics in Ray
// Traced Images", Journal of Graphics Tools 7(2), 2002). Solids can overlap: a liquid reaches into the wall of its glass.
// There, the solid with the highest dielectric priority fills the space, and of equal ones the one that the path has
// entered last. A surface between two points that the same solid fills does not exist: the path passes it straight on.
//
// The set of solids is a uvec4: 1 + index of the material of each, the one that was entered last first; 0: no further
// one. Entering a fifth solid removes the one that was entered first. Scenes without priorities do not have the set
// (kHasNestedMedia): leaving any solid leads outside.
#ifndef QUINTET_MEDIA_GLSL
#define QUINTET_MEDIA_GLSL

#include "material.glsl"

float mediumPriority(uint medium) { return MaterialArray(frame.materials).at[medium - 1u].dielectricPriority; }

// Returns the solid that fills the space, or 0.
uint fillingMedium(uvec4 media) {
  uint filling = media.x;
  for (int i = 1; i < int(kMaxMedia); ++i)
    if (media[i] != 0u && mediumPriority(media[i]) > mediumPriority(filling)) filling = media[i];
  return filling;
}

vec3 mediumAbsorption(uint medium) {
  return medium == 0u ? vec3(0.0) : MaterialArray(frame.materials).at[medium - 1u].absorption;
}

uvec4 cameraMedia() { return frame.cameraMedia; }
// The solid that fills the space around the camera, or 0.
uint cameraMedium() { return kHasNestedMedia ? fillingMedium(cameraMedia()) : frame.cameraMedia.x; }

// Index of refraction of a medium for the path's channel, at least 1.
float mediumIor(uint medium, uint channel) {
  if (medium == 0u) return 1.0;
  MaterialArray materials = MaterialArray(frame.materials);
  const float ior = max(materials.at[medium - 1u].ior, 1.0);
  return kHasDispersion ? dispersedIor(ior, materials.at[medium - 1u].dispersion, channel & 3u) : ior;
}

uvec4 mediaEntered(uvec4 media, uint medium) { return uvec4(medium, media.xyz); }

uvec4 mediaLeft(uvec4 media, uint medium) {
  if (media.x == medium) return uvec4(media.yzw, 0u);
  if (media.y == medium) return uvec4(media.x, media.zw, 0u);
  if (media.z == medium) return uvec4(media.xy, media.w, 0u);
  return media.w == medium ? uvec4(media.xyz, 0u) : media;
}

// A surface, seen by a path that is in `media`.
struct MediaInterface {
  uvec4 behind;  // the solids of a path that the surface transmits
  uint outside;  // the solid that fills the space on the outer side, without the solid of the surface itself, or 0
  bool exists;   // false: the same solid fills both sides
};

MediaInterface mediaInterface(uvec4 media, Surface surface) {
  const uint inside = surface.material + 1u;
  const uint here = fillingMedium(media);
  if ((MaterialArray(frame.materials).at[surface.material].flags & kMaterialSolid) == 0u) return MediaInterface(media, here, true);
  MediaInterface i;
  if (surface.frontFace) {
    i.behind = mediaEntered(media, inside);
    i.outside = here;
    i.exists = here != inside && fillingMedium(i.behind) == inside;
    return i;
  }
  // Open meshes and CSG trees can be left by a surface of a solid that the path has not entered. It then leaves the solid
  // that fills the space.
  const bool known = any(equal(media, uvec4(inside)));
  i.behind = mediaLeft(media, known ? inside : here);
  i.outside = fillingMedium(i.behind);
  i.exists = !known || (here == inside && i.outside != inside);
  return i;
}

// Makes the index of refraction relative to the solid outside. Call it after disperse(). Thin walls keep their index,
// because shadow rays pass panes without a path.
void setOutside(inout BsdfParameters p, uint outside, uint channel) {
  if (outside == 0u || p.ior < 1.0 || (p.thin && p.transmission > 0.0)) return;
  const float dispersion = MaterialArray(frame.materials).at[outside - 1u].dispersion;
  if (kHasDispersion && dispersion > 0.0 && !isDispersive(p) && !p.thin && p.transmission > 0.0) {
    p.dispersion = dispersion;
    chooseChannel(p, channel);
  }
  p.ior /= mediumIor(outside, channel);
}

#endif
