// World position of a vertex, by the rows of the model matrix in the push constants `draw`.
vec3 world_position(vec3 position) {
    const vec4 p = vec4(position, 1.0);
    return vec3(dot(draw.model[0], p), dot(draw.model[1], p), dot(draw.model[2], p));
}
