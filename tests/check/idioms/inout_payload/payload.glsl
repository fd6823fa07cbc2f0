struct Payload {
  vec3 color;
  float t;
  uint seed;
};

void shade(inout Payload p, vec3 color) {
  p.color = color;
  p.seed = p.seed * 747796405u + 1u;
}
