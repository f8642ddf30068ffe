// Damaged files and odd numbers, all the way that a file goes: import, surface patches, Embree, and a sample of the
// path tracer. Each is refused with a message, or gives a picture of finite light.
#include "assets/test_rooms.h"
#include "engine/scene/deformation.h"
#include "engine/scene/scene_space.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/reference/path_tracer.h"
#include "gi_module/visibility/surface_patches.h"
#include "tests/support/mutated_files.h"
#include "tests/support/test_size.h"
#include "viewer/scene_renderer.h"

#include <chrono>
#include <cmath>
#include <functional>
#include <sys/resource.h>

namespace sunfleck {
namespace {

using nlohmann::json;
using tests::World;

struct Counts {
    int tried = 0, refused = 0, right = 0, wrong = 0;
    double slowest = 0.0; // s
    ~Counts() {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        std::printf("%d tried, %d refused, %d right, %d wrong; the slowest took %.2f s, at most %ld MB\n", tried,
                    refused, right, wrong, slowest, usage.ru_maxrss / 1024);
    }
};

// Everything that is made of a scene before its first frame, without a GPU, and one sample of 8x8 pixels.
Status trace(World& world) {
    viewer::add_default_light(world.registry);
    scene::deform_meshes(world.registry, world.meshes);
    SUNFLECK_ASSIGN(const auto rays, raytrace::RayScene::create());
    SUNFLECK_TRY(rays->update(world.registry, world.meshes, &world.textures));
    const Bounds bounds = viewer::scene_bounds(world.registry, world.meshes);
    SUNFLECK_ASSIGN(const scene::CameraView camera, viewer::find_camera(world.registry, bounds, ""));
    gi::StaticBlockers blockers;
    gi::SurfacePatches patches;
    gi::PatchOptions options;
    std::vector<scene::PlacedMesh> geometry;
    world.registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& place) {
            geometry.push_back({instance.mesh, place.matrix});
        });
    options.space = scene::space_of(geometry, world.meshes);
    patches.build(world.registry, world.meshes, options, blockers);
    const gi::reference::PathTracer tracer(*rays, gi::collect_emitters(world.registry, world.meshes, bounds),
                                           gi::collect_backgrounds(world.registry));
    gi::reference::ReferenceSettings settings;
    settings.width = settings.height = 8;
    gi::reference::Accumulation picture;
    tracer.accumulate(picture, camera, settings, 1);
    for (const double sum : picture.sums)
        if (!std::isfinite(sum) || sum < 0.0)
            return Error{"light that is not finite", ErrorCode::stopped};
    return {};
}

// A refused file has left nothing behind and says why.
void judge(Counts& counts, const std::string& what, const std::function<Status(World&)>& import) {
    World world;
    ++counts.tried;
    const auto start = std::chrono::steady_clock::now();
    Status status = import(world);
    const bool imported = bool(status);
    bool right = imported || (world.registry.entity_count() == 0 && !status.error().message.empty());
    if (imported) {
        tests::expect_sound(world, what);
        status = trace(world);
        right = status || status.error().code != ErrorCode::stopped;
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    counts.slowest = std::max(counts.slowest, seconds.count());
    EXPECT_LT(seconds.count(), 20.0) << what;
    EXPECT_TRUE(right) << what << ": " << (status ? "" : status.error().message);
    (!right ? counts.wrong : status ? counts.right : counts.refused) += 1;
}

void judge_bytes(Counts& counts, const std::string& what, const std::string& bytes) {
    judge(counts, what, [&](World& world) {
        const auto report = world.import(bytes);
        return report ? Status() : Status(report.error());
    });
}

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

std::uint32_t number_from(const char* variable, std::uint32_t otherwise) {
    const char* const text = std::getenv(variable);
    return text != nullptr ? std::uint32_t(std::strtoul(text, nullptr, 10)) : otherwise;
}

// Seeds as bench.sh gives them: the short size has 400, the long one 4,000.
TEST(RobustDamagedFiles, MutationsAreRefusedOrTraced) {
    std::vector<std::string> files = tests::sample_files();
    const std::vector<std::string> rooms = built_in_files();
    files.insert(files.end(), rooms.begin(), rooms.end());
    EXPECT_GE(files.size(), 30u);
    const std::uint32_t first = number_from("SUNFLECK_FIRST_SEED", 1),
                        last = number_from("SUNFLECK_LAST_SEED", std::uint32_t(tests::by_size(400, 4000)));
    Counts counts;
    for (std::uint32_t seed = first; seed <= last; ++seed)
        judge_bytes(counts, "seed " + std::to_string(seed), tests::mutated(files[seed % files.size()], seed));
    constexpr std::uint32_t once_wrong[] = {5158}; // a lamp of 4e12 m: its density's square was beyond floats
    for (const std::uint32_t seed : once_wrong)
        judge_bytes(counts, "seed " + std::to_string(seed), tests::mutated(files[seed % files.size()], seed));
    EXPECT_GT(counts.right, int(last - first) / 20) << "mutations that all fail early test little";
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    if (!tests::sanitized()) { // whose own memory would count
        EXPECT_LT(usage.ru_maxrss / 1024, 2000);
    }
}

const std::vector<std::string> odd_numbers = {"NaN",   "Infinity", "-1e999", "1e39", "1e38", "-1e38",           "1e20",
                                              "-1e20", "1e-38",    "1e-320", "-0",   "-0.0", "9007199254740992"};

// Calls visit(text) with the JSON where one number after the other is one of the odd ones.
void replace_each_number(const json& file,
                         const std::function<void(const std::string& what, const std::string&)>& visit) {
    const json flat = file.flatten();
    for (const auto& [pointer, value] : flat.items()) {
        if (!value.is_number())
            continue;
        json changed = file;
        changed[json::json_pointer(pointer)] = "@number@";
        const std::string text = changed.dump();
        const std::size_t at = text.find("\"@number@\"");
        for (const std::string& number : odd_numbers) {
            std::string copy = text;
            copy.replace(at, 10, number);
            std::string what = pointer;
            what.append(" = ").append(number);
            visit(what, copy);
        }
    }
}

TEST(RobustDamagedFiles, OddNumbersInEachFieldOfGltf) {
    Counts counts;
    for (const char* name : {"all.gltf", "square.gltf"}) {
        const json file = json::parse(read_file(std::string(SUNFLECK_SOURCE_DIR "/tests/corpus/gltf/") + name).value());
        replace_each_number(file, [&](const std::string& what, const std::string& text) {
            judge_bytes(counts, std::string(name) + " " + what, text);
        });
    }
    EXPECT_GT(counts.right, 100);
}

TEST(RobustDamagedFiles, OddNumbersInEachVertex) {
    Counts counts;
    tests::GltfBuilder file;
    file.add_square();
    for (std::size_t at = 0; at < 12; ++at)
        for (const float value : {NAN, INFINITY, -INFINITY, 1e38f, -1e38f, 1e20f, 1e-38f, 1e-44f, -0.0f, 0x1p53f}) {
            tests::GltfBuilder changed = file;
            std::memcpy(changed.binary.data() + at * sizeof value, &value, sizeof value);
            judge_bytes(counts, "coordinate " + std::to_string(at) + " = " + std::to_string(value), changed.glb());
        }
    EXPECT_GT(counts.right, 30);
}

// Every built-in scene's own components; the geometry is the file's, once.
TEST(RobustDamagedFiles, OddNumbersInEachFieldOfSceneFiles) {
    Counts counts;
    const tests::Folder folder;
    const std::filesystem::path path = folder.path / "scene.scene.json";
    const std::size_t scenes = tests::by_size<std::size_t>(2, 6);
    for (const assets::BuiltInScene& built_in : std::span(assets::built_in_scenes()).first(scenes)) {
        World saved;
        assets::SceneBuilder builder(saved.registry, saved.meshes);
        built_in.make(builder);
        ASSERT_TRUE(io::save_scene(path, saved.registry, saved.meshes, saved.textures));
        json file = json::parse(read_file(path).value());
        file.erase("checksum");
        replace_each_number(file, [&](const std::string& what, const std::string& text) {
            ASSERT_TRUE(write_file(path, text));
            judge(counts, std::string(built_in.name) + " " + what, [&](World& world) {
                const auto report = io::load_scene(path, world.registry, world.meshes, world.textures);
                return report ? Status() : Status(report.error());
            });
        });
    }
    EXPECT_GT(counts.right, tests::by_size(20, 50));
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
