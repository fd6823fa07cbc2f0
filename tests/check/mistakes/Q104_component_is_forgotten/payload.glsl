struct Payload {
  vec4 color;  // w: distance, negative if the ray hit nothing
};
