struct Payload {
  float weights[2];
  vec3 color;
};
