// What would take more memory than the process may, or than the device's buffers hold, is refused before it is taken,
// by a message that says what asked for how much and what to lower.
#include "engine/core/memory_limit.h"
#include "tests/support/visibility_world.h"

#include <fstream>

namespace sunfleck::gi {
namespace {

class MemoryBounds : public testing::Test {
protected:
    ~MemoryBounds() override { set_memory_limit(0); }
    // Above what the process has, in MiB.
    static void allow(std::uint64_t more) { set_memory_limit(memory_in_use() + (more << 20)); }
    static void expect_refused(const Error& error, std::initializer_list<const char*> words) {
        EXPECT_EQ(error.code, ErrorCode::memory);
        for (const char* word : words)
            EXPECT_NE(error.message.find(word), std::string::npos) << error.message;
    }
};

// A grid of hills: 2 * side^2 triangles, no two of which lie in one plane.
scene::Mesh make_hills(std::uint32_t side) {
    scene::Mesh mesh;
    for (std::uint32_t i = 0; i <= side; ++i)
        for (std::uint32_t j = 0; j <= side; ++j)
            mesh.positions.push_back(vec3(float(i), float((i * i * 7 + j * j * 13 + i * j) % 11), float(j)));
    mesh.normals.assign(mesh.positions.size(), vec3(0, 1, 0));
    for (std::uint32_t i = 0; i < side; ++i)
        for (std::uint32_t j = 0; j < side; ++j) {
            const std::uint32_t corner = i * (side + 1) + j;
            for (const std::uint32_t index : {0u, 1u, side + 1, side + 1, 1u, side + 2})
                mesh.indices.push_back(corner + index);
        }
    return mesh;
}

TEST_F(MemoryBounds, RaysAmongManyTriangles) {
    scene::MeshStore meshes;
    ecs::Registry registry;
    scene::Mesh mesh = make_hills(512); // whose trees take 130 MiB
    const ecs::Entity entity = registry.create();
    registry.emplace<scene::MeshInstance>(entity, {meshes.add(std::move(mesh))});
    registry.emplace<scene::Transform>(entity, {});
    scene::update_world_transforms(registry);
    const auto rays = raytrace::RayScene::create().value();
    allow(64);
    const Status refused = rays->update(registry, meshes);
    ASSERT_FALSE(refused);
    expect_refused(refused.error(), {"rays among 524288 triangles", "130.0 MiB", "the level's detail", "--memory"});
    set_memory_limit(0);
    EXPECT_TRUE(rays->update(registry, meshes)) << "what was refused can be tried again";
}

// The most that the process has had since clear_refs was written to.
std::uint64_t peak_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (word == "VmHWM:") {
            std::uint64_t kibibytes = 0;
            status >> kibibytes;
            return kibibytes << 10;
        }
    return 0;
}

// What is counted for the blockers among them is what they take, at the most.
TEST_F(MemoryBounds, VisibilityOfManyTriangles) {
    scene::MeshStore meshes;
    ecs::Registry registry;
    const ecs::Entity entity = registry.create();
    registry.emplace<scene::MeshInstance>(entity, {meshes.add(make_hills(512))});
    registry.emplace<scene::Transform>(entity, {});
    registry.emplace<scene::Material>(entity, {});
    scene::update_world_transforms(registry);
    {
        SurfacePatches patches;
        StaticBlockers blockers;
        if (!(std::ofstream("/proc/self/clear_refs") << 5 << std::flush))
            GTEST_SKIP() << "the system does not forget what was the most";
        const std::uint64_t before = memory_in_use();
        ASSERT_TRUE(patches.build(registry, meshes, {}, blockers));
        EXPECT_EQ(blockers.polygons(), 2u * 512 * 512);
        EXPECT_LE(peak_memory() - before, std::uint64_t(150) << 20) << "what is counted below";
    }
    VisibilityDatabase database;
    const std::vector<LightSample> one(1);
    allow(64);
    EXPECT_FALSE(database.build(registry, meshes, one, {}));
    set_memory_limit(0);
    expect_refused(database.problem(), {"524288 triangles", "150.0 MiB", "the level's detail", "--memory"});
}

TEST_F(MemoryBounds, VisibilityOfManySamples) {
    VisibilityWorld world(assets::make_four_pillars);
    VisibilityDatabase database;
    ASSERT_TRUE(database.build(world.registry, world.meshes, world.samples, {}));
    const std::uint64_t roots = database.patches().roots();
    // As many pairs as take 96 MiB at five bytes each.
    std::vector<LightSample> many((std::uint64_t(96) << 20) / 5 / roots + 1, world.samples.front());
    allow(32);
    EXPECT_FALSE(database.build(world.registry, world.meshes, many, {}));
    set_memory_limit(0);
    const std::string what = std::to_string(roots) + " surfaces from " + std::to_string(many.size()) + " light samples";
    expect_refused(database.problem(), {what.c_str(), "MiB of memory", "lights", "--memory"});
    EXPECT_TRUE(database.build(world.registry, world.meshes, world.samples, {}));
}

} // namespace
} // namespace sunfleck::gi
