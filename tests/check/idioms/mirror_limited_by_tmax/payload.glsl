struct Payload {
  vec3 color;
  uint depth;  // of the ray, from 0
  float t;  // negative if the ray hit nothing
};
