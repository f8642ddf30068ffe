#version 460
#extension GL_EXT_control_flow_attributes : require
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1) uniform writeonly image2D target;
layout(push_constant) uniform Constants {
    ivec2 source_size, target_size;
} constants;

// Weights of the four pixels about a place between the second and the third.
vec4 catmull_rom(float t) {
    return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)),
                      t * t * (t - 1.0));
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, constants.target_size)))
        return;
    const vec2 place = (vec2(pixel) + 0.5) * vec2(constants.source_size) / vec2(constants.target_size) - 0.5;
    const ivec2 corner = ivec2(floor(place));
    const vec2 t = place - vec2(corner);
    const vec4 across = catmull_rom(t.x), down = catmull_rom(t.y);
    vec3 sum = vec3(0.0), lowest = vec3(1.0), highest = vec3(0.0);
    [[unroll]] for (int y = 0; y < 4; ++y) {
        vec3 row = vec3(0.0);
        [[unroll]] for (int x = 0; x < 4; ++x) {
            const ivec2 at = clamp(corner + ivec2(x - 1, y - 1), ivec2(0), constants.source_size - 1);
            const vec3 colour = imageLoad(source, at).rgb;
            row += across[x] * colour;
            if ((x == 1 || x == 2) && (y == 1 || y == 2)) {
                lowest = min(lowest, colour);
                highest = max(highest, colour);
            }
        }
        sum += down[y] * row;
    }
    imageStore(target, pixel, vec4(clamp(sum, lowest, highest), 1.0));
}
