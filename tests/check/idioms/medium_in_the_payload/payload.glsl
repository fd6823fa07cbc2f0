struct Payload {
  vec3 color;
  vec3 origin;
  float t;  // negative if the ray hit nothing
  float absorption;  // of the medium in which the path is
};
