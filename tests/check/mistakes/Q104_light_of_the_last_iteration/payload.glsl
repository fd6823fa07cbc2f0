struct Payload {
  vec3 color;
  bool lit;
};
