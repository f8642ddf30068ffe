#version 460
layout(set = 0, binding = 2) readonly buffer Atlas { uint texels[]; }; // coverage, one byte per texel
layout(push_constant) uniform Constants {
    vec2 scale;
    vec2 white;
    uvec2 atlas;
    uint first_index, first_vertex;
} constants;

layout(location = 0) in vec4 in_colour;
layout(location = 1) in vec2 in_coordinate;
layout(location = 0) out vec4 out_colour;

float coverage(uvec2 texel) {
    const uint place = min(texel.y, constants.atlas.y - 1u) * constants.atlas.x + min(texel.x, constants.atlas.x - 1u);
    return float((texels[place >> 2] >> (8u * (place & 3u))) & 255u) / 255.0;
}

void main() {
    float alpha = 1.0;
    if (in_coordinate != constants.white) {
        const vec2 place = max(in_coordinate * vec2(constants.atlas) - 0.5, 0.0);
        const uvec2 corner = uvec2(place);
        const vec2 t = place - vec2(corner);
        alpha = mix(mix(coverage(corner), coverage(corner + uvec2(1, 0)), t.x),
                    mix(coverage(corner + uvec2(0, 1)), coverage(corner + uvec2(1, 1)), t.x), t.y);
    }
    out_colour = vec4(in_colour.rgb, in_colour.a * alpha);
}
