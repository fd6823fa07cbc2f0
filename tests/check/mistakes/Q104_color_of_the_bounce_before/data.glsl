struct Step { vec3 emission; vec3 position; bool done; };
