#version 460
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
// Temporal anti-aliasing and enlargement (see temporal_enlargement.h). An invocation makes one pixel; to twice the size,
// the four that one pixel of the source covers, which share what they read.
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint doubling = 0;
const int side = doubling != 0 ? 2 : 1; // of the block of pixels
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform sampler2D motion_image;
layout(set = 0, binding = 3, r32ui) uniform readonly uimage2D history;
layout(set = 0, binding = 4, r32ui) uniform writeonly uimage2D new_history;
layout(set = 0, binding = 5, rgba8) uniform image2D target;
layout(push_constant) uniform Constants {
    ivec2 source_size, target_size;
    vec2 offset; // of samples from the middles of their pixels
    uint has_history; // 0: the target holds what was shown last
} constants;

// A history that was this far out of the range of the new picture's colours counts no more.
const float most_correction = 0.25;
// Of the history, in whole samples; and of a picture that was made by itself.
const float most_weight = 4.0, weight_of_single = 2.0;

#include "engine/render/temporal_samples.glsl"

// A pixel of the history is one word, since a CPU device reads each channel by itself: display values of 9, 10 and 8
// bits, which a mean of five samples comes near enough to, and in 5 bits what it weighs, up to four samples.
const vec3 colour_steps = vec3(511.0, 1023.0, 255.0);
const float most_steps = 31.0, steps_of_sample = 7.75;
uint history_word(vec3 colour, float weight) {
    const uvec3 value = uvec3(clamp(colour, 0.0, 1.0) * colour_steps + 0.5);
    return value.r | value.g << 9u | value.b << 19u | uint(min(weight * steps_of_sample, most_steps) + 0.5) << 27u;
}
vec4 of_history(uint word) {
    return vec4(vec3(word & 511u, word >> 9u & 1023u, word >> 19u & 255u) / colour_steps, float(word >> 27u) / steps_of_sample);
}

// Weights of the four pixels about a place between the second and the third.
vec4 catmull_rom(float t) {
    return 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)),
                      t * t * (t - 1.0));
}

// Of two distances that belong to different surfaces.
const float nearer_by = 1.1;

// The nearest of the surfaces in and about a pixel decides, so that its edge moves with it. On one surface it is the
// pixel itself: its neighbours on one side are always nearer, and what is drawn would drift with them.
vec2 motion_at(ivec2 pixel) {
    ivec2 nearest = pixel;
    float depth = texelFetch(depth_image, pixel, 0).r;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 corner = clamp(pixel + ivec2((i & 1) * 2 - 1, (i >> 1) * 2 - 1), ivec2(0), constants.source_size - 1);
        const float other = texelFetch(depth_image, corner, 0).r;
        const bool nearer = other > nearer_by * depth;
        nearest = nearer ? corner : nearest;
        depth = nearer ? other : depth;
    }
    return texelFetch(motion_image, nearest, 0).rg;
}

void main() {
    const ivec2 first = ivec2(gl_GlobalInvocationID.xy) * side;
    const vec2 scale = vec2(constants.source_size) / vec2(constants.target_size);
    // The pixel of the source about which nine are read.
    const ivec2 middle = clamp(ivec2((vec2(first) + 0.5) * scale), ivec2(0), constants.source_size - 1);
    vec3 colour[9], lowest = vec3(1.0), highest = vec3(0.0);
    [[unroll]] for (int i = 0; i < 9; ++i) {
        colour[i] = imageLoad(source, clamp(middle + ivec2(i % 3, i / 3) - 1, ivec2(0), constants.source_size - 1)).rgb;
        lowest = min(lowest, colour[i]);
        highest = max(highest, colour[i]);
    }

    // Where the block's first pixel was, and the history about it.
    const vec2 motion = motion_at(middle) * vec2(constants.target_size);
    const vec2 was = vec2(first) + motion;
    const ivec2 corner = ivec2(floor(was));
    const vec2 t = was - vec2(corner);
    const vec4 across = catmull_rom(t.x), down = catmull_rom(t.y);
    vec4 rows[4 + side - 1][side];
    [[unroll]] for (int y = 0; y < 4 + side - 1; ++y) {
        vec4 texels[4 + side - 1];
        [[unroll]] for (int x = 0; x < 4 + side - 1; ++x)
            texels[x] = of_history(imageLoad(history, clamp(corner + ivec2(x, y) - 1, ivec2(0), constants.target_size - 1)).r);
        [[unroll]] for (int x = 0; x < side; ++x)
            rows[y][x] = across.x * texels[x] + across.y * texels[x + 1] + across.z * texels[x + 2] + across.w * texels[x + 3];
    }

    [[unroll]] for (int y = 0; y < side; ++y)
        [[unroll]] for (int x = 0; x < side; ++x) {
            const ivec2 pixel = first + ivec2(x, y);
            const vec2 place = (vec2(pixel) + 0.5) * scale;
            const vec2 away = vec2(middle) + 0.5 + constants.offset - place;
            const vec4 sampled = sample_near(colour, away, scale);

            vec4 before = down.x * rows[y][x] + down.y * rows[y + 1][x] + down.z * rows[y + 2][x] + down.w * rows[y + 3][x];
            if (constants.has_history == 0u)
                before = vec4(imageLoad(target, min(pixel, constants.target_size - 1)).rgb, weight_of_single);
            const vec3 kept = clamp(before.rgb, lowest, highest);
            const vec3 correction = abs(before.rgb - kept);
            const vec2 place_before = (vec2(pixel) + 0.5 + motion) / vec2(constants.target_size);
            const bool seen = all(greaterThanEqual(place_before, vec2(0.0))) && all(lessThanEqual(place_before, vec2(1.0)));
            const float trust = seen ? max(1.0 - largest(correction) / most_correction, 0.0) : 0.0;
            const float weight_before = min(max(before.a, 0.0), most_weight) * trust;
            // Where little is known, all samples about the pixel count: it is blurred, which a few frames mend.
            const float known = min(weight_before, 1.0);
            const vec3 now = mix(blurred(colour, away), sampled.rgb, known);
            const float weight = max(sampled.a, 0.25 * (1.0 - known));
            const vec3 shown = mix(kept, now, weight / (weight + weight_before));
            if (all(lessThan(pixel, constants.target_size))) {
                imageStore(new_history, pixel, uvec4(history_word(shown, weight + weight_before)));
                imageStore(target, pixel, vec4(shown, 1.0));
            }
        }
}
