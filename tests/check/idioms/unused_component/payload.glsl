struct Payload {
  vec4 color;  // w is not used
};
