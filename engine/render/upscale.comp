#version 460
#extension GL_EXT_control_flow_attributes : require
// A bicubic enlargement: upscale.h.

// Twice the size is the usual case: there, four pixels share the sixteen that they are made of.
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint doubling = 0;
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

vec3 load(ivec2 pixel) { return imageLoad(source, clamp(pixel, ivec2(0), constants.source_size - 1)).rgb; }

void write_one(ivec2 pixel) {
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
            const vec3 colour = load(corner + ivec2(x - 1, y - 1));
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

// The pixels between the middles of four source pixels, a quarter and three quarters of the way.
void write_four(ivec2 corner) {
    const vec4 quarter = catmull_rom(0.25), rest = catmull_rom(0.75);
    vec3 sums[4] = {vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0)};
    vec3 lowest = vec3(1.0), highest = vec3(0.0);
    [[unroll]] for (int y = 0; y < 4; ++y) {
        vec3 left = vec3(0.0), right = vec3(0.0);
        [[unroll]] for (int x = 0; x < 4; ++x) {
            const vec3 colour = load(corner + ivec2(x - 1, y - 1));
            left += quarter[x] * colour;
            right += rest[x] * colour;
            if ((x == 1 || x == 2) && (y == 1 || y == 2)) {
                lowest = min(lowest, colour);
                highest = max(highest, colour);
            }
        }
        sums[0] += quarter[y] * left;
        sums[1] += quarter[y] * right;
        sums[2] += rest[y] * left;
        sums[3] += rest[y] * right;
    }
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 pixel = 2 * corner + 1 + ivec2(i & 1, i >> 1);
        if (all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, constants.target_size)))
            imageStore(target, pixel, vec4(clamp(sums[i], lowest, highest), 1.0));
    }
}

void main() {
    const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (doubling != 0)
        write_four(place - 1);
    else
        write_one(place);
}
