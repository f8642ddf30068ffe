#version 460
#extension GL_GOOGLE_include_directive : require
// An image of light before anything is added.
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) writeonly uniform image2D target;

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(pixel, imageSize(target))))
        imageStore(target, pixel, vec4(0.0));
}
