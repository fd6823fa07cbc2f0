struct GBuffer { vec3 position; vec3 normal; bool valid; };
