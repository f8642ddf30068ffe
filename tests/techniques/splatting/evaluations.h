// How much work splatted light is, by its view.
#pragma once

#include "gi_module/splatting/splatting_shared.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::tests {

// Of lights, in all pixels of the next picture.
inline double evaluations(GpuWorld& world) {
    world.request.lighting_view = "overdraw";
    double sum = 0.0;
    for (const vec4& pixel : world.picture().pixels)
        sum += double(pixel.x) * double(shared::most_overdraw);
    world.request.lighting_view.clear();
    return sum;
}

} // namespace sunfleck::tests
