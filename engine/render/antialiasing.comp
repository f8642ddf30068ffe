#version 460
#extension GL_EXT_control_flow_attributes : require
// Morphological anti-aliasing (see antialiasing.h).
#extension GL_GOOGLE_include_directive : require
#include "engine/render/edge_code.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
// Pixels of an invocation, one below the other, which share what they read.
const int antialiasing_rows = 4;
layout(constant_id = 0) const uint writes_codes = 0; // 1: the picture as it is, with edge codes as its alpha
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1) uniform writeonly image2D target;
layout(push_constant) uniform Constants { ivec2 size; }
constants;

// Contrast, of display values, below which nothing is done: at least, and relative to the brightest.
const float least_contrast = 1.0 / 32.0, relative_contrast = 1.0 / 10.0;
// A line of the edge's stairs is followed so far to either side, in pixels; the last steps are longer ones.
const int walk_steps = 8;
const int walk_lengths[walk_steps] = int[](1, 2, 3, 4, 6, 8, 11, 15);
// Of its difference from its surroundings, what a pixel that stands alone loses at most.
const float most_blur = 0.5;
// A speck is one pixel wide, between pixels that are both brighter or both darker, and ends within so many pixels to
// either side: what is thinner than a pixel and shows where it happens to meet the middle of one. It keeps the share of
// its contrast that such things cover in the mean.
const int longest_speck = 8;
const float speck_share = 0.35;
// Shorter lines are those of slopes, which an enlargement draws well by itself.
const float shortest_coded_run = 2.0;

vec4 load(ivec2 pixel) { return imageLoad(source, clamp(pixel, ivec2(0), constants.size - 1)); }
float at(ivec2 pixel) { return load(pixel).a; }

// Brightness of a pixel and its eight neighbours.
struct Neighbourhood {
    float centre, up, down, left, right, up_left, up_right, down_left, down_right;
};

// How much the rows differ, or the columns: an edge that lies across is one between rows.
bool lies_across(Neighbourhood n) {
    const float rows = abs(n.up_left - 2.0 * n.left + n.down_left) + 2.0 * abs(n.up - 2.0 * n.centre + n.down) +
                       abs(n.up_right - 2.0 * n.right + n.down_right);
    const float columns = abs(n.up_left - 2.0 * n.up + n.up_right) + 2.0 * abs(n.left - 2.0 * n.centre + n.right) +
                          abs(n.down_left - 2.0 * n.down + n.down_right);
    return rows >= columns;
}

// From the middle of a pixel, of brightness `centre`, to the end of its line of the edge to what is as bright as
// `beyond`. x: distance; y: 1 if the edge moves into the pixel's row there, -1 if it moves over the neighbour's, 0 if no
// end was found. One of the two sides may go on while a speck takes the other's place, as where a side face thinner than
// a pixel lies between them: the edge then moves towards the speck.
vec2 walk(ivec2 pixel, ivec2 along, ivec2 over, float centre, float beyond) {
    const float edge = 0.5 * (centre + beyond), limit = 0.25 * abs(beyond - centre);
    vec2 found = vec2(float(walk_lengths[walk_steps - 1]), 0.0);
    bool on = true;
    int i = 0;
    do { // tested at its end, as below
        const ivec2 place = pixel + along * walk_lengths[i];
        const float own = at(place), other = at(place + over);
        on = abs(0.5 * (own + other) - edge) < limit;
        if (!on)
            found = vec2(float(walk_lengths[i]) - 0.5, abs(own - centre) > abs(other - beyond) ? 1.0 : -1.0);
    } while (++i < walk_steps && on);
    return found;
}

// How far the neighbour over the edge reaches into a pixel.
struct Cover {
    float share; // of the pixel
    float slope; // how that rises along the edge, a pixel
    float run;   // length of the edge's line, in pixels
};

// The edge crosses from the middle of one end of its line to the other's, so only the half of the line at the nearer
// end is covered.
Cover cover_of(ivec2 pixel, ivec2 along, ivec2 over, float centre, float beyond) {
    const vec2 before = walk(pixel, -along, over, centre, beyond), after = walk(pixel, along, over, centre, beyond);
    const vec2 end = before.x < after.x ? before : after;
    const float run = before.x + after.x;
    const bool covered = end.y > 0.0;
    return Cover(covered ? max(0.5 - end.x / run, 0.0) : 0.0, covered ? (before.x < after.x ? -1.0 : 1.0) / run : 0.0,
                 run);
}

// Of the two quarters of the pixel at the edge, which are what the neighbour covers first.
float code_of(ivec2 along, ivec2 over, Cover cover) {
    const vec2 quarters = clamp(2.0 * (cover.share + vec2(-0.25, 0.25) * cover.slope), 0.0, 1.0);
    return edge_code(over.x + over.y > 0, along.x == 0, quarters);
}

// Whether what a pixel shows ends within a speck's length, and does not go on beside its end, as a slanted line does.
bool ends(ivec2 pixel, ivec2 along, ivec2 over, float centre, float limit) {
    bool inside = true, alone = false;
    int i = 1;
    do { // tested at its end, as above
        const ivec2 place = pixel + along * i;
        inside = abs(at(place) - centre) < limit;
        if (!inside)
            alone = min(abs(at(place + over) - centre), abs(at(place - over) - centre)) >= limit;
    } while (++i <= longest_speck && inside);
    return alone;
}

bool is_speck(ivec2 pixel, ivec2 along, ivec2 over, float centre, float beyond, float behind) {
    const float one = centre - beyond, other = centre - behind, limit = 0.5 * min(abs(one), abs(other));
    bool speck = one * other > 0.0 && limit > 0.5 * least_contrast;
    if (speck)
        speck = ends(pixel, along, over, centre, limit) && ends(pixel, -along, over, centre, limit);
    return speck;
}

// A pixel at which there is an edge.
void smooth_edge(ivec2 pixel) {
    const vec4 centre = load(pixel);
    Neighbourhood n;
    n.centre = centre.a;
    n.up = at(pixel + ivec2(0, -1));
    n.down = at(pixel + ivec2(0, 1));
    n.left = at(pixel + ivec2(-1, 0));
    n.right = at(pixel + ivec2(1, 0));
    n.up_left = at(pixel + ivec2(-1, -1));
    n.up_right = at(pixel + ivec2(1, -1));
    n.down_left = at(pixel + ivec2(-1, 1));
    n.down_right = at(pixel + ivec2(1, 1));
    const bool across = lies_across(n);
    const float one = across ? n.up : n.left, other = across ? n.down : n.right;
    const bool first = abs(one - n.centre) >= abs(other - n.centre);
    const ivec2 along = across ? ivec2(1, 0) : ivec2(0, 1);
    const ivec2 over = (across ? ivec2(0, 1) : ivec2(1, 0)) * (first ? -1 : 1);
    const Cover cover = cover_of(pixel, along, over, n.centre, first ? one : other);
    const float high = max(n.centre, max(max(n.up, n.down), max(n.left, n.right)));
    const float low = min(n.centre, min(min(n.up, n.down), min(n.left, n.right)));
    const float mean = (2.0 * (n.up + n.down + n.left + n.right) + n.up_left + n.up_right + n.down_left + n.down_right) / 12.0;
    const float alone = smoothstep(0.0, 1.0, min(abs(mean - n.centre) / (high - low), 1.0));
    const bool speck = is_speck(pixel, along, over, n.centre, first ? one : other, first ? other : one);
    const bool coded = writes_codes != 0 && cover.run >= shortest_coded_run && !speck;
    const float share = coded ? 0.0 : max(cover.share, most_blur * alone * alone);
    const float alpha = writes_codes == 0 ? 1.0 : coded ? code_of(along, over, cover) : 0.0;
    const vec3 beyond = load(pixel + over).rgb;
    const vec3 colour = speck ? mix(0.5 * (beyond + load(pixel - over).rgb), centre.rgb, speck_share)
                              : mix(centre.rgb, beyond, share);
    imageStore(target, pixel, vec4(colour, alpha));
}

void main() {
    const ivec2 first = ivec2(gl_GlobalInvocationID.xy) * ivec2(1, antialiasing_rows);
    if (first.x >= constants.size.x)
        return;
    vec4 above = load(first + ivec2(0, -1)), centre = load(first);
    uint edges = 0u;
    [[unroll]] for (int i = 0; i < antialiasing_rows; ++i) {
        const ivec2 pixel = first + ivec2(0, i);
        const vec4 below = load(pixel + ivec2(0, 1));
        const float left = at(pixel + ivec2(-1, 0)), right = at(pixel + ivec2(1, 0));
        const float high = max(centre.a, max(max(above.a, below.a), max(left, right)));
        const float low = min(centre.a, min(min(above.a, below.a), min(left, right)));
        if (pixel.y < constants.size.y) {
            imageStore(target, pixel, vec4(centre.rgb, writes_codes != 0 ? 0.0 : 1.0));
            if (high - low > max(least_contrast, relative_contrast * high))
                edges |= 1u << i;
        }
        above = centre;
        centre = below;
    }
    // A loop, not a branch for each pixel: a CPU device runs it as often as the pixel column with the most edges of a
    // group asks for, and once more if it is tested at its head.
    if (edges != 0u) do {
        const int i = findLSB(edges);
        edges &= edges - 1u;
        smooth_edge(first + ivec2(0, i));
    } while (edges != 0u);
}
