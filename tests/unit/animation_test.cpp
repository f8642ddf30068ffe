// Key frames: what they say at any time, and how they come out of a glTF file, good or damaged.
#include "engine/core/file.h"
#include "engine/io/gltf.h"
#include "engine/scene/animation.h"
#include "engine/simulation/path_movers.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using scene::AnimationCurve;
using scene::AnimationInterpolation;
using scene::AnimationTarget;

TEST(AnimationCurve, FollowsItsKeys) {
    AnimationCurve curve;
    curve.times = {1.0f, 2.0f, 4.0f};
    curve.values = {vec4(0.0f), vec4(2.0f, 0.0f, 0.0f, 0.0f), vec4(2.0f, 4.0f, 0.0f, 0.0f)};
    EXPECT_EQ(curve.at(0.0f), curve.values[0]);
    EXPECT_EQ(curve.at(9.0f), curve.values[2]);
    EXPECT_EQ(curve.at(1.25f), vec4(0.5f, 0.0f, 0.0f, 0.0f));
    EXPECT_EQ(curve.at(3.0f), vec4(2.0f, 2.0f, 0.0f, 0.0f));
    curve.interpolation = AnimationInterpolation::step;
    EXPECT_EQ(curve.at(1.99f), curve.values[0]);
    EXPECT_EQ(curve.at(2.0f), curve.values[1]);
    // A cubic through (0, 0) and (2, 8) with the slopes of x^3 there is x^3.
    AnimationCurve cubic;
    cubic.interpolation = AnimationInterpolation::cubic_spline;
    cubic.times = {0.0f, 2.0f};
    cubic.values = {vec4(9.0f), vec4(0.0f), vec4(0.0f), vec4(12.0f), vec4(8.0f), vec4(9.0f)};
    for (float t = 0.0f; t <= 2.0f; t += 0.125f)
        EXPECT_NEAR(cubic.at(t).x, t * t * t, 1e-5f);
    // Rotations: even speed, along the shorter arc, of unit length.
    AnimationCurve turn;
    turn.target = AnimationTarget::rotation;
    turn.times = {0.0f, 1.0f};
    const quat end = glm::angleAxis(1.2f, vec3(0.0f, 1.0f, 0.0f));
    turn.values = {vec4(0.0f, 0.0f, 0.0f, 1.0f), -vec4(end.x, end.y, end.z, end.w)};
    for (float t = 0.0f; t <= 1.0f; t += 0.1f) {
        const vec4 value = turn.at(t);
        EXPECT_NEAR(std::abs(value.w), std::cos(0.6f * t), 1e-5f);
        EXPECT_NEAR(glm::length(value), 1.0f, 1e-5f);
    }
}

class AnimatedFile : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("sunfleck_animation_" + std::to_string(getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    // A node that moves from the origin to (0, 3, 0) in two seconds. `channel` and `accessor` replace parts of it.
    Result<io::ImportReport> import(const std::string& path, int sampler, int values, std::vector<float> times) {
        const float positions[] = {0, 0, 0, 0, 3, 0};
        std::string bytes(sizeof positions + times.size() * 4, '\0');
        std::memcpy(bytes.data(), positions, sizeof positions);
        std::memcpy(bytes.data() + sizeof positions, times.data(), times.size() * 4);
        EXPECT_TRUE(write_file(folder / "a.bin", bytes));
        const std::string length = std::to_string(bytes.size()), count = std::to_string(times.size());
        const std::string text =
            R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"box"}],
            "buffers":[{"uri":"a.bin","byteLength":)" +
            length + R"(}],
            "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":24},{"buffer":0,"byteOffset":24,"byteLength":)" +
            std::to_string(times.size() * 4) + R"(}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":)" +
            std::to_string(values) + R"(,"type":"VEC3"},
                         {"bufferView":1,"componentType":5126,"count":)" +
            count + R"(,"type":"SCALAR"}],
            "animations":[{"samplers":[{"input":1,"output":0,"interpolation":"LINEAR"}],
                           "channels":[{"sampler":)" +
            std::to_string(sampler) + R"(,"target":{"node":0,"path":")" + path + R"("}}]}]})";
        EXPECT_TRUE(write_file(folder / "a.gltf", text));
        world = std::make_unique<ecs::Registry>();
        scene::register_components(*world);
        return io::import_gltf(folder / "a.gltf", *world, meshes, textures);
    }
    fs::path folder;
    std::unique_ptr<ecs::Registry> world;
    scene::MeshStore meshes;
    scene::TextureStore textures;
};

TEST_F(AnimatedFile, MovesItsNode) {
    ASSERT_TRUE(import("translation", 0, 2, {0.0f, 2.0f}));
    ecs::Registry& registry = *world;
    const ecs::Entity box = scene::find_by_name(registry, "box");
    EXPECT_FALSE(scene::is_static(registry, box));
    for (const std::uint64_t step : {0ull, 30ull, 60ull, 90ull, 150ull}) {
        simulation::set_movers_to_step(registry, step);
        const double seconds = std::fmod(double(step) * simulation::step_seconds, 2.0);
        EXPECT_NEAR(registry.get<scene::Transform>(box).position.y, 1.5 * seconds, 1e-5);
    }
}

TEST_F(AnimatedFile, DamageIsReported) {
    EXPECT_FALSE(import("translation", 7, 2, {0.0f, 2.0f})) << "no such sampler";
    EXPECT_FALSE(import("translation", 0, 3, {0.0f, 2.0f})) << "values outside the buffer";
    EXPECT_FALSE(import("translation", 0, 1, {0.0f, 2.0f})) << "fewer values than keys";
    EXPECT_FALSE(import("rotation", 0, 2, {0.0f, 2.0f})) << "three numbers for a quaternion";
    EXPECT_FALSE(import("colour", 0, 2, {0.0f, 2.0f}));
    EXPECT_FALSE(import("translation", 0, 2, {2.0f, 0.0f})) << "time runs backwards";
    EXPECT_FALSE(import("translation", 0, 2, {0.0f, std::nanf("")}));
    EXPECT_FALSE(import("weights", 0, 2, {0.0f, 2.0f})) << "weights are no vectors";
}

} // namespace
} // namespace sunfleck
