// What a host does from frame to frame while its calls, or Vulkan's, fail: a closed room, a box that moves in it,
// settings that change, a picture that has another size for a while, and other images.
#pragma once

#include "tests/support/host_program.h"
#include "tests/support/test_size.h"

#include <cstdlib>

namespace sunfleck::tests {

inline std::uint64_t number_from_environment(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

// The bench goes through all of a test, piece by piece (bench.sh); other runs have a share of it.
inline bool is_piece_of_bench() {
    return std::getenv("SUNFLECK_FIRST_SEED") != nullptr;
}

inline const int frames = int(number_from_environment("SUNFLECK_FRAMES", by_size(12u, 60u)));

// A scene that changes from frame to frame; step `frame` of it. Steps may be repeated.
struct Story {
    std::uint32_t extra = ~0u;

    // What the frame's picture is like. From a third on, normals have to be converted.
    static HostOptions show(HostProgram& program, int frame) {
        program.resize(frame >= frames / 2 && frame < frames * 2 / 3);
        HostOptions options;
        options.shading_normals = frame >= frames / 3 && frame < frames * 5 / 6;
        return options;
    }
    static Status begin(host::Context& context) {
        const HostCall call;
        for (const auto& [name, value] : {std::pair("lights", "12"), std::pair("shadow_map_resolution", "32")})
            SUNFLECK_TRY(context.set(name, value));
        SUNFLECK_ASSIGN(const std::uint32_t in, context.add_mesh(cube(true)));
        SUNFLECK_ASSIGN(const std::uint32_t out, context.add_mesh(cube(false)));
        SUNFLECK_TRY(context.add_instance(
            {in, box_matrix(vec3(0, 1.25f, 0), vec3(4, 2.5f, 4)), host::Mobility::fixed, {0.7f, 0.6f, 0.5f}}));
        SUNFLECK_TRY(context.add_instance({out, host::identity, host::Mobility::moving}));
        SUNFLECK_TRY(context.add_light({host::LightKind::point, {5, 4, 3}, {-0.5f, 2.0f, 0.5f}}));
        return {};
    }
    Status step(host::Context& context, int frame) {
        const HostCall call;
        const float t = 0.1f * float(frame);
        SUNFLECK_TRY(context.set_transform(1, box_matrix(vec3(std::sin(t), 0.6f, std::cos(t)), vec3(0.6f))));
        if (frame == frames / 4 && extra == ~0u) {
            SUNFLECK_ASSIGN(extra, context.add_instance({1, box_matrix(vec3(-1, 0.5f, -1), vec3(0.5f))}));
        }
        if (frame == frames * 5 / 12)
            SUNFLECK_TRY(context.set("shadow_map_resolution", "64"));
        if (frame == frames * 7 / 12)
            SUNFLECK_TRY(context.set_surface(0, {0.5f, 0.7f, 0.5f}, {0, 0, 0}));
        if (frame == frames * 3 / 4 && extra != ~0u) {
            SUNFLECK_TRY(context.remove_instance(extra));
            extra = ~0u;
        }
        return {};
    }
};

} // namespace sunfleck::tests
