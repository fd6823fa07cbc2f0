struct Payload {
  vec3 color;
  float t;  // negative if the ray hit nothing
};
