struct Payload {
  vec3 color;
  float t;  // negative: nothing was hit
};
