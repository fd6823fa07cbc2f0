struct TextureArgs {
  vec2 uv;
  vec3 color;
};
