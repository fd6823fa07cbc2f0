struct Info {
  int depth;
  float ior;
};
struct Payload {
  vec3 color;
  Info info;
};
