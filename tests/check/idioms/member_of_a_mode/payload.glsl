struct Payload {
  vec3 color;
  vec3 weight;  // of mode 1
  int mode;
};
