// What the vertex shaders of the geometry pass share.

#include "engine/render/draw_position.glsl"

vec3 world_normal(vec3 normal) {
    return draw.normal_colour[0].xyz * normal.x + draw.normal_colour[1].xyz * normal.y +
           draw.normal_colour[2].xyz * normal.z;
}

// After gl_Position.
void write_motion() {
    out_current = out_previous = vec4(0.0, 0.0, 0.0, 1.0);
    if (with_motion == 0)
        return;
    const uint row = surface_row(draw.surface);
    out_previous = camera.previous_view_projection * (rows[row].previous_model * vec4(in_position, 1.0));
    out_current = gl_Position;
}
