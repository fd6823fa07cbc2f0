// What the rays bring back. Shadow rays have a payload of their own, at location 1.
struct Hit {
  vec3 color;      // base colour, or the background
  vec3 position;   // world
  vec3 normal;     // shading normal on the viewer's side, world
  vec3 away;       // position, moved off the surface by its error bound
  float roughness; // perceptual
  bool met;
};
