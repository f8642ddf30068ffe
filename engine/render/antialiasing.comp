#version 460
#extension GL_EXT_control_flow_attributes : require
// Morphological anti-aliasing (see antialiasing.h).

layout(local_size_x = 8, local_size_y = 8) in;
// Pixels of an invocation, one below the other, which share what they read.
const int antialiasing_rows = 4;
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
// As far, a line that is thinner than a pixel is followed. It shows where it happens to meet the middle of one: in
// dashes, each a row farther than the one before.
const int line_reach = walk_lengths[walk_steps - 1];

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
// `beyond`. x: distance; y: 1 if the edge moves into the pixel's row there, -1 if it moves over the neighbour's, 0 if
// no end was found; z: brightness of the pixel's row there. One of the two sides may go on while a dash takes the
// other's place, as where a side face thinner than a pixel lies between them: the edge then moves towards the dash.
vec3 walk(ivec2 pixel, ivec2 along, ivec2 over, float centre, float beyond) {
    const float edge = 0.5 * (centre + beyond), limit = 0.25 * abs(beyond - centre);
    vec3 found = vec3(float(line_reach), 0.0, 0.0);
    bool on = true;
    int i = 0;
    do { // tested at its end, as below
        const ivec2 place = pixel + along * walk_lengths[i];
        const float own = at(place), other = at(place + over);
        on = abs(0.5 * (own + other) - edge) < limit;
        if (!on)
            found = vec3(float(walk_lengths[i]) - 0.5, abs(own - centre) > abs(other - beyond) ? 1.0 : -1.0, own);
    } while (++i < walk_steps && on);
    return found;
}

// How far the neighbour over the edge reaches into a pixel.
struct Cover {
    float share; // of the pixel
    float run;   // length of the edge's line, in pixels
    int end;     // steps to the nearer end, if the edge moves into the pixel's row there: < 0 before, > 0 after; else 0
    float there; // brightness at that end
};

// The edge crosses from the middle of one end of its line to the other's, so only the half of the line at the nearer
// end is covered.
Cover cover_of(ivec2 pixel, ivec2 along, ivec2 over, float centre, float beyond) {
    const vec3 before = walk(pixel, -along, over, centre, beyond), after = walk(pixel, along, over, centre, beyond);
    const bool first = before.x < after.x;
    const vec3 end = first ? before : after;
    const float run = before.x + after.x;
    const float side = end.y > 0.0 ? (first ? -1.0 : 1.0) : 0.0;
    return Cover(side != 0.0 ? max(0.5 - end.x / run, 0.0) : 0.0, run, int(side * (end.x + 0.5)), end.z);
}

// Whether something is brighter than both of what lies beside it, or darker than both.
bool is_apart(float value, float one, float other) {
    return (value - one) * (value - other) > 0.0 && min(abs(value - one), abs(value - other)) > least_contrast;
}

// Steps to the first pixel that is not as bright as `value`; more than line_reach if there is none so near.
int steps_to_end(ivec2 pixel, ivec2 along, float value, float limit) {
    bool inside = true;
    int i = 0;
    do { // tested at its end, as above
        ++i;
        inside = abs(at(pixel + along * i) - value) < limit;
    } while (inside && i < line_reach);
    return inside ? line_reach + 1 : i;
}

// Pixels between the end of a dash, of which `end` is the first beyond, and the line's next one, in the row beside it;
// more than line_reach if there is none so near.
int gap_after(ivec2 end, ivec2 along, ivec2 over, float value, float limit) {
    bool gap = true;
    int i = 0;
    do {
        const ivec2 place = end + along * i;
        gap = min(abs(at(place + over) - value), abs(at(place - over) - value)) >= limit;
        ++i;
    } while (gap && i <= line_reach);
    return gap ? line_reach + 1 : i - 1;
}

// Share of a pixel, in the row of a dash and `outside` the dash's end, that a straight line of such dashes and gaps
// covers: it is dash / (dash + gap) wide, and has left the row's middle at the dash's end.
float share_of_line(float outside, float dash, float gap) {
    return clamp(0.5 - outside / (dash + gap), 0.0, dash / (dash + gap));
}

// A pixel in a dash of a line thinner than a pixel, or in a gap.
struct LinePixel {
    bool across, first; // whether its edge lies across; whether it is at the first of the two sides
    int end;            // of a gap: see Cover; 0: it is in a dash
    float run;          // of a gap: see Cover; a whole number
};

// As 16 bits, which are not all 0.
uint line_code(LinePixel line) {
    return 1u | uint(line.across) << 1u | uint(line.first) << 2u | uint(line.end + 16) << 3u |
           uint(line.run + 0.5) << 8u;
}
LinePixel line_of(uint code) {
    return LinePixel((code & 2u) != 0u, (code & 4u) != 0u, int(code >> 3u & 31u) - 16, float(code >> 8u));
}

ivec2 along_edge(bool across) { return across ? ivec2(1, 0) : ivec2(0, 1); }
ivec2 over_edge(bool across, bool first) { return (across ? ivec2(0, 1) : ivec2(1, 0)) * (first ? -1 : 1); }

// `shown`: the pixel without the line. A line that goes on beside a dash's end is no thinner than a pixel. Where no next
// dash is seen, short ones alone are taken for such: others may be the end of something that is a pixel wide.
void draw_line(ivec2 pixel, LinePixel line, vec4 shown) {
    const bool in_gap = line.end != 0;
    const ivec2 along = along_edge(line.across) * (line.end < 0 ? -1 : 1), over = over_edge(line.across, line.first);
    const ivec2 place = pixel + along * abs(line.end); // in the dash
    const vec4 dash = load(place), one = load(place + over), other = load(place - over);
    const float limit = 0.5 * min(abs(dash.a - one.a), abs(dash.a - other.a));
    const int back = steps_to_end(place, -along, dash.a, limit), on = steps_to_end(place, along, dash.a, limit);
    const int near = min(back, on), far = max(back, on);
    const ivec2 ahead = back < on ? -along : along, behind = place - ahead * far;
    const int gap = gap_after(place + ahead * near, ahead, over, dash.a, limit);
    const bool goes_on = gap == 0 || (far <= line_reach && min(abs(at(behind + over) - dash.a),
                                                               abs(at(behind - over) - dash.a)) < limit);
    const float length = float(near + min(far, line_reach) - 1);
    const float after = at(place + along * on); // where the row leaves the dash, on the edge's other side
    const bool crosses = on > line_reach || abs(after - one.a) < abs(after - other.a);
    vec4 result = shown;
    if (in_gap) {
        if (is_apart(dash.a, one.a, other.a) && crosses)
            result.rgb = mix(shown.rgb, dash.rgb, share_of_line(float(abs(line.end) - back) + 0.5,
                                                                min(length, float(line_reach)), line.run));
    } else if (!goes_on && near <= line_reach && (gap <= line_reach || length <= float(line_reach))) {
        const float share = share_of_line(0.5 - float(near), length, float(min(gap, line_reach)));
        result = vec4(mix(0.5 * (one.rgb + other.rgb), dash.rgb, share), 1.0);
    }
    imageStore(target, pixel, result);
}

// A pixel at which there is an edge: what it shows, as 4 x 8 bits, and its line_code, or 0.
uvec2 smooth_edge(ivec2 pixel) {
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
    const ivec2 along = along_edge(across), over = over_edge(across, first);
    const Cover cover = cover_of(pixel, along, over, n.centre, first ? one : other);
    const float high = max(n.centre, max(max(n.up, n.down), max(n.left, n.right)));
    const float low = min(n.centre, min(min(n.up, n.down), min(n.left, n.right)));
    const float mean = (2.0 * (n.up + n.down + n.left + n.right) + n.up_left + n.up_right + n.down_left + n.down_right) / 12.0;
    const float alone = smoothstep(0.0, 1.0, min(abs(mean - n.centre) / (high - low), 1.0));
    const bool in_dash = is_apart(n.centre, one, other);
    const bool in_gap = cover.end != 0 && is_apart(cover.there, n.centre, first ? one : other);
    const float share = max(cover.share, most_blur * alone * alone);
    const vec4 result = vec4(mix(centre.rgb, load(pixel + over).rgb, share), 1.0);
    imageStore(target, pixel, result);
    const uint line = line_code(LinePixel(across, first, in_dash ? 0 : cover.end, in_dash ? 0.0 : cover.run));
    return uvec2(packUnorm4x8(result), in_dash || in_gap ? line : 0u);
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
            imageStore(target, pixel, vec4(centre.rgb, 1.0));
            if (high - low > max(least_contrast, relative_contrast * high))
                edges |= 1u << i;
        }
        above = centre;
        centre = below;
    }
    // A loop, not a branch for each pixel: a CPU device runs it as often as the pixel column with the most edges of a
    // group asks for, and once more if it is tested at its head.
    uvec4 shown = uvec4(0u), codes = uvec4(0u);
    uint lines = 0u;
    if (edges != 0u) do {
        const int i = findLSB(edges);
        edges &= edges - 1u;
        const uvec2 result = smooth_edge(first + ivec2(0, i));
        const bvec4 here = equal(ivec4(i), ivec4(0, 1, 2, 3));
        shown = mix(shown, uvec4(result.x), here);
        codes = mix(codes, uvec4(result.y), here);
        lines |= result.y != 0u ? 1u << i : 0u;
    } while (edges != 0u);
    if (lines != 0u) do { // in a loop of its own, since few pixels ask for it
        const int i = findLSB(lines);
        lines &= lines - 1u;
        const uvec2 here = i == 0 ? uvec2(shown.x, codes.x) : i == 1 ? uvec2(shown.y, codes.y)
                         : i == 2 ? uvec2(shown.z, codes.z) : uvec2(shown.w, codes.w);
        draw_line(first + ivec2(0, i), line_of(here.y), unpackUnorm4x8(here.x));
    } while (lines != 0u);
}
