// What a picture would be if every light sample's shadow were traced by rays: the same samples, no maps.
#pragma once

#include "tests/support/gpu_world.h"

#include "engine/core/jobs.h"
#include "gi_module/transport/arrival.h"

namespace sunfleck::tests {

// Irradiance at the pixels of the frame that the world drew last. Each sample is taken as shadowed, or as not, where it
// is so at all pixels of the same surface up to `reach` pixels away; `least` and `most` have the samples that differ
// there out and in.
struct TracedPixel {
    bool surface = false;
    vec3 position{0.0f}, normal{0.0f}; // in the scene's space
    double exact = 0.0, least = 0.0, most = 0.0;
    double unshadowed = 0.0; // if nothing cast shadows
};

class TracedLight {
public:
    explicit TracedLight(GpuWorld& world, int reach, bool punctual_only = false)
        : world_(world), width_(int(world.request.width)), height_(int(world.request.height)), reach_(reach),
          pixels_(std::size_t(width_) * std::size_t(height_)) {
        const scene::CameraView camera = world.renderer->space().view(world.request.camera);
        const shared::CameraRow row = scene::make_camera_row(camera, world.request.width, world.request.height);
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                find_surface(row, x, y);
        const auto samples = world.renderer->lighting().samples();
        arrived_.resize(pixels_.size());
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (samples[i].punctual || !punctual_only)
                add(samples[i]);
    }
    const std::vector<TracedPixel>& pixels() const { return pixels_; }

private:
    TracedPixel& at(int x, int y) { return pixels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)]; }

    void find_surface(const shared::CameraRow& row, int x, int y) {
        const raytrace::RayScene& rays = world_.renderer->rays();
        const raytrace::Ray view{vec3(row.position), shared::camera_ray(row, vec2(float(x), float(y)) + 0.5f), 0.0f,
                                 1e30f};
        const auto hit = rays.closest_hit(view);
        if (!hit)
            return;
        const raytrace::SurfacePoint point = rays.surface(view, *hit);
        const float side = glm::dot(point.geometric_normal, view.direction) < 0.0f ? 1.0f : -1.0f;
        at(x, y) = {true, point.on_triangle + side * point.offset * point.geometric_normal,
                    side * point.geometric_normal};
    }

    // Light of a sample at a pixel, unshadowed; and whether it arrives.
    struct Arrived {
        double light = 0.0;
        bool lit = false;
    };

    void add(const gi::LightSample& sample) {
        const raytrace::RayScene& rays = world_.renderer->rays();
        const gi::System& lighting = world_.renderer->lighting();
        const float far = 4.0f * glm::length(world_.renderer->gpu_scene().bounds().extent());
        parallel_for_chunks(pixels_.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const TracedPixel& pixel = pixels_[i];
                arrived_[i] = {};
                if (!pixel.surface)
                    continue;
                const gi::Arrival light = gi::arrival(lighting.sample_set().rows()[sample.index],
                                                      gi::light_class(sample.kind), pixel.position, far);
                const float cosine = glm::dot(pixel.normal, glm::normalize(light.to_light));
                if (cosine <= 0.0f)
                    continue;
                const vec3 e = light.irradiance;
                const raytrace::Ray shadow{pixel.position, light.to_light, 0.0f, 0.9999f};
                arrived_[i] = {double(cosine) * double(e.x + e.y + e.z) / 3.0, !rays.occluded(shadow)};
            }
        });
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                add_to(x, y);
    }

    void add_to(int x, int y) {
        TracedPixel& pixel = at(x, y);
        const auto arrived = [&](int u, int v) -> const Arrived& {
            return arrived_[std::size_t(v) * std::size_t(width_) + std::size_t(u)];
        };
        const Arrived here = arrived(x, y);
        if (here.light <= 0.0)
            return;
        bool all = here.lit, any = here.lit;
        for (int v = std::max(y - reach_, 0); v <= std::min(y + reach_, height_ - 1); ++v)
            for (int u = std::max(x - reach_, 0); u <= std::min(x + reach_, width_ - 1); ++u)
                if (at(u, v).surface && glm::dot(at(u, v).normal, pixel.normal) > 0.99f) {
                    all = all && arrived(u, v).lit;
                    any = any || arrived(u, v).lit;
                }
        pixel.unshadowed += here.light;
        pixel.exact += here.lit ? here.light : 0.0;
        pixel.least += all ? here.light : 0.0;
        pixel.most += any ? here.light : 0.0;
    }

    GpuWorld& world_;
    int width_, height_, reach_;
    std::vector<TracedPixel> pixels_;
    std::vector<Arrived> arrived_; // of one sample
};

} // namespace sunfleck::tests
