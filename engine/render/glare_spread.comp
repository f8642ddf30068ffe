#version 460
// One level of the pyramid by which light spreads: half the size of the finer one, or added back to it.
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint adds = 0; // 0: `coarse` is not read
layout(set = 0, binding = 0) uniform sampler2D fine;
layout(set = 0, binding = 1) uniform sampler2D coarse;
layout(set = 0, binding = 2) writeonly uniform image2D target;
layout(push_constant) uniform Constants { ivec2 size; } constants;

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, constants.size)))
        return;
    const vec2 place = (vec2(pixel) + 0.5) / vec2(constants.size);
    if (adds != 0) {
        imageStore(target, pixel, vec4(texelFetch(fine, pixel, 0).rgb + textureLod(coarse, place, 0.0).rgb, 1.0));
        return;
    }
    // Sixteen pixels by four reads, each between four of them.
    const vec2 step = 1.0 / vec2(textureSize(fine, 0));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i)
        sum += textureLod(fine, place + step * (vec2(i & 1, i >> 1) * 2.0 - 1.0), 0.0).rgb;
    imageStore(target, pixel, vec4(0.25 * sum, 1.0));
}
