// Work for nothing: makes a pass slower in the build that the frame-time gate tests itself with (slow_work.h).
#version 450
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer Result { float result[]; };

void main() {
    float value = float(gl_GlobalInvocationID.x);
    for (int i = 0; i < 32; ++i)
        value = value * 1.0001 + 0.5 * sin(value);
    result[gl_LocalInvocationID.x] = value;
}
