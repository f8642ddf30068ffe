// Values that a host may hand over: good ones, or, while wrong_ is set, good ones with one mistake.
#pragma once

#include "tests/support/host_program.h"

#include <limits>
#include <map>
#include <random>

namespace sunfleck::tests {

// What became of calls.
struct Tally {
    std::uint64_t tried = 0, refused = 0, right = 0, wrong = 0;
    std::map<std::string, std::uint64_t> calls; // how often each was tried

    void add(const Tally& other) {
        tried += other.tried, refused += other.refused, right += other.right, wrong += other.wrong;
        for (const auto& [call, times] : other.calls)
            calls[call] += times;
    }
};

class RandomHostValues {
public:
    explicit RandomHostValues(std::uint32_t seed) : random_(seed) {}

protected:
    std::uint32_t pick(std::size_t count) { return std::uint32_t(random_() % count); }
    // As large as the contract allows, now and then.
    float place(float low, float high) { return pick(200) == 0 ? (chance() ? 0x1p60f : -0x1p60f) : real(low, high); }
    float real(float low, float high) { return low + (high - low) * float(random_() % 1000) / 999.0f; }
    bool chance() { return pick(2) == 0; }
    float bad_number() {
        constexpr float infinite = std::numeric_limits<float>::infinity(),
                        nan = std::numeric_limits<float>::quiet_NaN();
        constexpr float numbers[] = {nan, infinite, -infinite, 1e38f, -1e30f};
        return numbers[pick(std::size(numbers))];
    }
    // A value that was good, with one of its numbers replaced.
    void spoil(std::span<float> values) { values[pick(values.size())] = bad_number(); }
    struct Mesh {
        std::vector<float> positions, normals, texture_coordinates;
        std::vector<std::uint32_t> indices;
    };
    Mesh mesh() {
        const host::MeshData good = cube(chance());
        Mesh result{{good.positions.begin(), good.positions.end()},
                    {good.normals.begin(), good.normals.end()},
                    {},
                    {good.indices.begin(), good.indices.end()}};
        if (chance())
            result.normals.clear();
        if (chance())
            for (std::size_t i = 0; i < result.positions.size() / 3 * 2; ++i)
                result.texture_coordinates.push_back(real(-2, 2));
        if (wrong_)
            spoil_mesh(result);
        return result;
    }
    void spoil_mesh(Mesh& mesh) {
        if (!mesh.texture_coordinates.empty() && pick(4) == 0) {
            if (chance())
                spoil(mesh.texture_coordinates);
            else
                mesh.texture_coordinates.pop_back();
            return;
        }
        switch (pick(mesh.normals.empty() ? 4 : 6)) {
        case 0:
            spoil(mesh.positions);
            break;
        case 1:
            mesh.positions.pop_back();
            break;
        case 2:
            mesh.indices[pick(mesh.indices.size())] = 24 + pick(1000);
            break;
        case 3:
            mesh.indices.resize(chance() ? 0 : mesh.indices.size() - 1);
            break;
        case 4:
            spoil(mesh.normals);
            break;
        case 5:
            mesh.normals.resize(3 * pick(23) + 3);
            break;
        }
    }
    host::MaterialData material() {
        host::MaterialData data;
        data.albedo = {real(0, 1), real(0, 1), real(0, 1)};
        if (pick(4) == 0)
            data.emission = {real(0, 5), real(0, 5), 0};
        data.roughness = real(0, 1);
        if (chance()) {
            pixels_.assign(64, std::uint8_t(pick(256)));
            data.albedo_texture = {pixels_, 4, 4};
        }
        if (!wrong_)
            return data;
        switch (pick(5)) {
        case 0:
            data.albedo[pick(3)] = chance() ? 5.0f : bad_number();
            break;
        case 1:
            spoil(data.emission);
            break;
        case 2:
            data.metallic = chance() ? -0.5f : bad_number();
            break;
        case 3:
            data.roughness = chance() ? 1.5f : bad_number();
            break;
        case 4:
            pixels_.assign(64, 0);
            data.albedo_texture = {pixels_, chance() ? 0u : 0xffffffffu, 4};
            break;
        }
        return data;
    }
    host::Matrix4 matrix() {
        host::Matrix4 result = box_matrix(vec3(real(-1.5f, 1.5f), real(0.3f, 2), real(-1.5f, 1.5f)),
                                          vec3(real(0.1f, 0.8f), real(0.1f, 0.8f), pick(8) == 0 ? 0.0f : 0.4f));
        if (wrong_ && chance())
            result[4 * std::size_t(pick(4)) + 3] += 0.5f;
        else if (wrong_)
            spoil(result);
        return result;
    }
    host::LightData light() {
        host::LightData data;
        data.kind = host::LightKind(pick(4));
        data.strength = {real(0, 8), pick(200) == 0 ? 0x1p60f : real(0, 8), real(0, 8)};
        data.position = {place(-1.5f, 1.5f), place(0.2f, 2.3f), real(-1.5f, 1.5f)};
        data.direction = {real(-1, 1), -1, real(-1, 1)};
        data.outer_angle = real(0.2f, 1.5f);
        data.inner_angle = real(0, 1) * data.outer_angle;
        if (!wrong_)
            return data;
        switch (pick(6)) {
        case 0:
            data.kind = host::LightKind(77);
            break;
        case 1:
            data.strength[pick(3)] = chance() ? -1.0f : bad_number();
            break;
        case 2:
            data.kind = host::LightKind::spot;
            spoil(data.position);
            break;
        case 3:
            data.kind = chance() ? host::LightKind::spot : host::LightKind::directional;
            data.direction = {0, 0, 0};
            break;
        case 4:
            data.kind = host::LightKind::spot;
            std::swap(data.inner_angle, data.outer_angle);
            data.inner_angle += 0.1f;
            break;
        case 5:
            data.kind = host::LightKind::spot;
            data.outer_angle = chance() ? 9.0f : bad_number();
            break;
        }
        return data;
    }
    void spoil_images(host::FrameImages& images) {
        host::HostImage* const all[] = {&images.depth, &images.normals, &images.surface, &images.irradiance};
        host::HostImage& image = *all[pick(4)];
        switch (pick(9)) {
        case 0:
            images.width = chance() ? 0 : 0xffffffffu;
            break;
        case 1:
            image.image = VK_NULL_HANDLE;
            break;
        case 2:
            image.view = VK_NULL_HANDLE;
            break;
        case 3:
            image.format = VkFormat(chance() ? VK_FORMAT_BC1_RGB_UNORM_BLOCK : 123456);
            break;
        case 4:
            image.exit.layout = chance() ? VK_IMAGE_LAYOUT_UNDEFINED : VkImageLayout(123456);
            break;
        case 5:
            images.surface.entry.layout = VK_IMAGE_LAYOUT_UNDEFINED;
            break;
        case 6:
            (chance() ? image.entry : image.exit).stages = std::uint64_t(1) << (39 + pick(25));
            break;
        case 7:
            (chance() ? image.entry : image.exit).access = std::uint64_t(1) << (17 + pick(3));
            break;
        case 8:
            (image.image == images.depth.image ? images.normals : images.depth).image = image.image;
            break;
        }
    }
    host::Camera camera(host::Camera camera) {
        if (!wrong_)
            return camera;
        switch (pick(4)) {
        case 0:
            spoil(camera.position);
            break;
        case 1:
            camera.forward = chance() ? host::Vector3{0, 0, 0} : host::Vector3{bad_number(), 0, 0};
            break;
        case 2:
            camera.up = camera.forward;
            break;
        case 3:
            camera.vertical_field_of_view = chance() ? 0.0f : chance() ? 4.0f : bad_number();
            break;
        }
        return camera;
    }

    bool wrong_ = false;
    std::mt19937 random_;
    std::vector<std::uint8_t> pixels_; // of the last material
};

} // namespace sunfleck::tests
