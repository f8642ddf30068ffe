// What would take more memory than the process may, or than the device's buffers hold, is refused before it is taken,
// by a message that says what asked for how much and what to lower.
#include "engine/core/memory_limit.h"
#include "tests/support/visibility_world.h"

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

TEST_F(MemoryBounds, RaysAmongManyTriangles) {
    scene::MeshStore meshes;
    ecs::Registry registry;
    scene::Mesh mesh;
    constexpr std::uint32_t side = 512; // 2 * side^2 triangles, whose trees take 130 MiB
    for (std::uint32_t i = 0; i <= side; ++i)
        for (std::uint32_t j = 0; j <= side; ++j)
            mesh.positions.push_back(vec3(float(i), 0.0f, float(j)));
    mesh.normals.assign(mesh.positions.size(), vec3(0, 1, 0));
    for (std::uint32_t i = 0; i < side; ++i)
        for (std::uint32_t j = 0; j < side; ++j) {
            const std::uint32_t corner = i * (side + 1) + j;
            for (const std::uint32_t index : {0u, 1u, side + 1, side + 1, 1u, side + 2})
                mesh.indices.push_back(corner + index);
        }
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
