struct Payload {
  vec3 color;
  vec3 normal;  // world space, unit
  float t;      // negative if the ray hit nothing
};
