struct Payload {
  vec3 color;
  int depth;
};
