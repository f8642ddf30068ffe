// One scene rendered by the many-light system and by brute force, and how much the two pictures differ.
#pragma once

#include "tests/techniques/many_light/many_light.h"
#include "viewer/exposure.h"

namespace sunfleck::tests {

// Two renderers of one scene, frame for frame.
struct Pair {
    explicit Pair(void (*make)(assets::SceneBuilder&), const std::string& camera)
        : brute(make, camera), many(make, camera) {}
    void set(const gi::Settings& settings) {
        many.set(settings);
        gi::Settings baseline = gi::Settings().all_light_by("brute_force");
        baseline.lights = settings.lights;
        baseline.seed = settings.seed;
        baseline.shadow_filter = settings.shadow_filter;
        baseline.shadow_map_resolution = settings.shadow_map_resolution;
        baseline.bounces = settings.bounces;
        baseline.candidates = settings.candidates;
        brute.set(baseline);
    }
    void size(std::uint32_t width, std::uint32_t height) {
        for (GpuWorld* world : {&brute, &many}) {
            world->request.width = width;
            world->request.height = height;
        }
    }
    void tone_map() {
        for (GpuWorld* world : {&brute, &many}) {
            world->request.view = shared::view_final;
            world->request.tone_map = true;
            world->request.ev100 =
                viewer::scene_exposure(world->renderer->registry()).value_or(viewer::default_exposure);
        }
    }
    // Both see each step, since samples that movers take along have a past, but brute force draws no more of the
    // earlier ones than it must.
    void run_to(std::uint64_t step, float degrees) {
        const scene::CameraView start = many.request.camera;
        const std::uint32_t width = brute.request.width, height = brute.request.height;
        for (std::uint64_t k = 0; k <= step; ++k) {
            many.request.step = brute.request.step = k;
            many.request.camera = brute.request.camera = start.orbited(glm::radians(degrees) * float(k));
            brute.request.width = k == step ? width : 16;
            brute.request.height = k == step ? height : 16;
            many.render();
            brute.render();
        }
    }
    GpuWorld brute, many;
};

struct Difference {
    double mean = 0, beyond_8 = 0, largest = 0, mean_brightness = 0;
    double worst_block = 0; // mean of 32x32 pixels
};

inline Difference compare(Pair& pair) {
    const io::Picture a = pair.many.renderer->read_back().value(), b = pair.brute.renderer->read_back().value();
    Difference result;
    double pixels = 0;
    const std::size_t columns = a.width / 32;
    std::vector<double> blocks(columns * (a.height / 32), 0.0);
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        if (a.pixels[i].a != b.pixels[i].a)
            result.largest = 1e9;
        double largest = 0, mean = 0;
        for (int c = 0; c < 3; ++c) {
            const double d = std::abs(double(a.pixels[i][c]) - double(b.pixels[i][c]));
            largest = std::max(largest, d);
            mean += d / 3.0;
            result.mean_brightness += double(b.pixels[i][c]) / 3.0;
        }
        result.mean += mean;
        if (const std::size_t x = i % a.width / 32, y = i / a.width / 32; x < columns && y < a.height / 32)
            blocks[y * columns + x] += mean / 1024.0;
        result.largest = std::max(result.largest, largest);
        result.beyond_8 += largest > 8.0 / 255.0;
        pixels += 1;
    }
    result.mean /= pixels;
    result.beyond_8 /= pixels;
    result.mean_brightness /= pixels;
    result.worst_block = blocks.empty() ? 0.0 : *std::max_element(blocks.begin(), blocks.end());
    return result;
}

} // namespace sunfleck::tests
