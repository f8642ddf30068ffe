// Damaged files of all kinds, all the way that a file goes (traced_files.h).
#include "assets/test_rooms.h"
#include "tests/support/test_size.h"
#include "tests/support/traced_files.h"

namespace sunfleck {
namespace {

using tests::World;

// The built-in scenes that are small, as files.
std::vector<std::string> built_in_files() {
    const tests::Folder folder;
    std::vector<std::string> result;
    for (const assets::BuiltInScene& built_in : assets::built_in_scenes()) {
        World world;
        assets::SceneBuilder builder(world.registry, world.meshes);
        built_in.make(builder);
        const std::filesystem::path path = folder.path / "scene.glb";
        if (!io::export_gltf(path, world.registry, world.meshes, world.textures))
            continue;
        if (std::string bytes = read_file(path).value(); bytes.size() < 3000000)
            result.push_back(std::move(bytes));
    }
    return result;
}

// Seeds as bench.sh gives them: the short size has 400, the long one 4,000.
TEST(RobustDamagedFiles, MutationsAreRefusedOrTraced) {
    std::vector<std::string> files = tests::sample_files();
    const std::vector<std::string> rooms = built_in_files();
    files.insert(files.end(), rooms.begin(), rooms.end());
    EXPECT_GE(files.size(), 30u);
    const tests::Seeds seeds = tests::seeds_to_try(std::uint32_t(tests::by_size(400, 4000)));
    tests::FileCounts counts;
    for (std::uint32_t seed = seeds.first; seed <= seeds.last; ++seed)
        judge_bytes(counts, "seed " + std::to_string(seed), tests::mutated(files[seed % files.size()], seed));
    constexpr std::uint32_t once_wrong[] = {5158}; // a lamp of 4e12 m: its density's square was beyond floats
    for (const std::uint32_t seed : once_wrong)
        judge_bytes(counts, "seed " + std::to_string(seed), tests::mutated(files[seed % files.size()], seed));
    EXPECT_GT(counts.right, int(seeds.last - seeds.first) / 20) << "mutations that all fail early test little";
    EXPECT_LT(tests::FileCounts::most_megabytes(), 2000) << "a sanitizer's own memory counts, too";
}

// What damaged files lead to: rays from anywhere, and movers scaled to nothing.
TEST(RobustRays, RaysBeyondWhatEmbreeComputesWithMeetNothing) {
    World world;
    tests::GltfBuilder square;
    square.add_square();
    ASSERT_TRUE(world.import(square.glb()));
    const ecs::Entity entity = scene::find_by_name(world.registry, "square");
    world.registry.emplace<scene::Mover>(entity);
    const auto rays = raytrace::RayScene::create().value();
    const raytrace::Ray straight{vec3(0.6f, 0.4f, 1.0f), vec3(0.0f, 0.0f, -1.0f)};
    for (const float scale : {1.0f, 1e-12f, 1e-30f, 0.0f, 1.0f}) {
        world.registry.patch<scene::Transform>(entity, [&](scene::Transform& place) { place.scale = vec3(scale); });
        scene::update_world_transforms(world.registry);
        ASSERT_TRUE(rays->update(world.registry, world.meshes));
        EXPECT_EQ(rays->closest_hit(straight).has_value(), scale == 1.0f) << scale;
        raytrace::ShadowPacket packet;
        packet.active = 0xffffu;
        packet.rays.fill(straight);
        packet.rays[3].origin.x = NAN;
        packet.rays[5].direction.y = 1e30f;
        packet.rays[7].origin.z = -INFINITY;
        EXPECT_EQ(rays->occluded(packet), scale == 1.0f ? 0xff57u : 0u) << scale;
        for (const float value : {NAN, INFINITY, -1e25f, 1e38f})
            for (int axis = 0; axis < 3; ++axis) {
                raytrace::Ray origin = straight, direction = straight;
                origin.origin[axis] = direction.direction[axis] = value;
                EXPECT_FALSE(rays->closest_hit(origin)) << value;
                EXPECT_FALSE(rays->occluded(direction)) << value;
            }
    }
}

} // namespace
} // namespace sunfleck
