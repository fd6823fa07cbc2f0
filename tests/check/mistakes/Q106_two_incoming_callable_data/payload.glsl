struct Payload {
  vec3 color;
};
