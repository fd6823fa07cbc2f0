struct Payload {
  vec3 color;
  float t;  // negative: nothing was hit
};

struct Shadow {
  uint visible;
};
