// A bicubic enlargement; with LISTS_EDGES, it says where edges are.
#extension GL_EXT_control_flow_attributes : require

// Twice the size is the usual case: there, four pixels share the sixteen that they are made of.
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint doubling = 0;
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1) uniform writeonly image2D target;
#ifdef LISTS_EDGES
#include "engine/render/edge_places.glsl"
#endif
layout(push_constant) uniform Constants {
    ivec2 source_size, target_size;
} constants;

// Display values that differ by less than this show no edge.
const float least_contrast = 1.0 / 32.0;

// Weights of the four pixels about a place between the second and the third.
vec4 catmull_rom(float t) {
    return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)),
                      t * t * (t - 1.0));
}

vec3 load(ivec2 pixel) { return imageLoad(source, clamp(pixel, ivec2(0), constants.source_size - 1)).rgb; }

// For subpixel_edges.comp, which draws such places again.
void list_if_edge(ivec2 place, vec3 lowest, vec3 highest) {
#ifdef LISTS_EDGES
    const vec3 difference = highest - lowest;
    if (max(difference.r, max(difference.g, difference.b)) < least_contrast)
        return;
    const uint at = atomicAdd(edges.count, 1u);
    edges.places[at] = uint(place.x + 1) | uint(place.y + 1) << 16u;
    const uint group = at / places_of_group;
    if (at % places_of_group == 0u && group < most_groups)
        atomicAdd(edges.groups[0], 1u);
    else if (at % places_of_group == 0u)
        atomicMax(edges.groups[1], group / most_groups + 1u);
#endif
}

void write_one(ivec2 pixel) {
    if (any(greaterThanEqual(pixel, constants.target_size)))
        return;
    const vec2 place = (vec2(pixel) + 0.5) * vec2(constants.source_size) / vec2(constants.target_size) - 0.5;
    const ivec2 corner = ivec2(floor(place));
    const vec2 t = place - vec2(corner);
    const vec4 across = catmull_rom(t.x), down = catmull_rom(t.y);
    vec3 sum = vec3(0.0), lowest = vec3(1.0), highest = vec3(0.0), low = vec3(1.0), high = vec3(0.0);
    [[unroll]] for (int y = 0; y < 4; ++y) {
        vec3 row = vec3(0.0);
        [[unroll]] for (int x = 0; x < 4; ++x) {
            const vec3 colour = load(corner + ivec2(x - 1, y - 1));
            row += across[x] * colour;
            if ((x == 1 || x == 2) && (y == 1 || y == 2)) {
                lowest = min(lowest, colour);
                highest = max(highest, colour);
            }
            low = min(low, colour);
            high = max(high, colour);
        }
        sum += down[y] * row;
    }
    imageStore(target, pixel, vec4(clamp(sum, lowest, highest), 1.0));
    list_if_edge(pixel, low, high); // its samples lie between others of the sixteen, too
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
    if (corner.x < constants.source_size.x && corner.y < constants.source_size.y)
        list_if_edge(corner, lowest, highest);
}

void main() {
    const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (doubling != 0)
        write_four(place - 1);
    else
        write_one(place);
}
