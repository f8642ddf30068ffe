// What runs under the address and undefined-behaviour sanitizers besides the CPU tests: loading, saving, one frame.
#include "tests/support/gpu_world.h"

#include "engine/core/file.h"
#include "engine/core/random.h"

#include <filesystem>

namespace sunfleck::tests {
namespace {

namespace fs = std::filesystem;

struct Folder {
    Folder() : path(fs::path(testing::TempDir()) / "sunfleck_smoke") { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
};

class Smoke : public GpuTest {};

TEST_F(Smoke, OneFrameOfEveryScene) {
    for (const assets::BuiltInScene& scene : assets::built_in_scenes())
        for (const gi::Settings& technique : {gi::Settings::brute_force(), gi::Settings()}) {
            GpuWorld world(scene.make);
            gi::Settings settings = technique;
            settings.lights = 40;
            settings.shadow_map_resolution = 32;
            settings.count_clamped = true;
            settings.count_passes = std::string(scene.name) == "cornell"; // slow where patches are many
            settings.shadow_filter = true;
            world.set(settings);
            world.request.tone_map = true;
            world.request.show_samples = true;
            world.request.view = shared::view_final;
            double sum = 0;
            for (world.request.step = 0; world.request.step < 3; ++world.request.step)
                for (const vec4& pixel : world.picture().pixels)
                    sum += double(pixel.x);
            EXPECT_GT(sum, 30.0) << scene.name;
        }
}

// Every false-colour view of the many-light system.
TEST_F(Smoke, FalseColours) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 40;
    settings.shadow_map_resolution = 32;
    world.set(settings);
    world.request.view = shared::view_false_colours;
    for (std::uint32_t show = shared::show_tiles; show <= shared::show_light_maps; ++show) {
        world.request.show = show;
        double sum = 0;
        for (const vec4& pixel : world.picture().pixels)
            sum += double(pixel.x + pixel.y + pixel.z);
        EXPECT_GT(sum, 10.0) << show;
    }
}

TEST(SceneFiles, EverySceneComesBackAsItWas) {
    const Folder folder;
    for (const assets::BuiltInScene& built_in : assets::built_in_scenes()) {
        ecs::Registry before, after;
        scene::MeshStore meshes, read;
        assets::SceneBuilder builder(before, meshes);
        built_in.make(builder);
        const fs::path file = folder.path / (std::string(built_in.name) + ".scene.json");
        ASSERT_TRUE(io::save_scene(file, before, meshes));
        const auto report = io::load_scene(file, after, read);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_TRUE(report->notes.empty());
        int compared = 0;
        before.view<scene::Name>().each([&](ecs::Entity old_entity, const scene::Name& name) {
            const ecs::Entity entity = scene::find_by_name(after, name.name);
            ASSERT_FALSE(entity.is_null()) << name.name;
            ++compared;
            const auto near = [](vec3 a, vec3 b) { return glm::length(a - b) <= 1e-5f * (1.0f + glm::length(a)); };
            if (const auto* t = before.try_get<scene::Transform>(old_entity)) {
                const auto& u = after.get<scene::Transform>(entity);
                EXPECT_TRUE(near(t->position, u.position) && near(t->scale, u.scale));
                EXPECT_NEAR(std::abs(glm::dot(t->rotation, u.rotation)), 1.0f, 1e-5f);
            }
            if (const auto* m = before.try_get<scene::Material>(old_entity)) {
                const auto& n = after.get<scene::Material>(entity);
                EXPECT_TRUE(near(m->base_colour, n.base_colour) && near(m->emission, n.emission));
                EXPECT_EQ(m->specular, n.specular);
            }
            if (const auto* m = before.try_get<scene::MeshInstance>(old_entity)) {
                const scene::Mesh& a = meshes[m->mesh];
                const scene::Mesh& b = read[after.get<scene::MeshInstance>(entity).mesh];
                EXPECT_EQ(a.positions, b.positions);
                EXPECT_EQ(a.normals, b.normals);
                EXPECT_EQ(a.indices, b.indices);
            }
            if (const auto* c = before.try_get<scene::Camera>(old_entity)) {
                EXPECT_NEAR(c->vertical_field_of_view, after.get<scene::Camera>(entity).vertical_field_of_view, 1e-6f);
            }
            if (const auto* m = before.try_get<scene::Mover>(old_entity)) {
                { EXPECT_EQ(m->path, after.get<scene::Mover>(entity).path); }
                EXPECT_EQ(m->period, after.get<scene::Mover>(entity).period);
            }
            if (const auto* l = before.try_get<scene::AreaLight>(old_entity)) {
                EXPECT_EQ(l->radiance, after.get<scene::AreaLight>(entity).radiance);
            }
            if (const auto* l = before.try_get<scene::SpotLight>(old_entity)) {
                EXPECT_TRUE(near(l->intensity, after.get<scene::SpotLight>(entity).intensity));
            }
        });
        EXPECT_GT(compared, 2);
    }
}

// Damaged files give an error or a scene, never a crash: every prefix, and bytes changed at random.
TEST(SceneFiles, DamagedFilesAreErrors) {
    const Folder folder;
    ecs::Registry registry;
    scene::MeshStore meshes;
    assets::SceneBuilder builder(registry, meshes);
    assets::make_gap_room(builder);
    ASSERT_TRUE(io::save_scene(folder.path / "good.scene.json", registry, meshes));
    const std::string good = read_file(folder.path / "good.glb").value();
    int errors = 0;
    for (std::uint32_t i = 0; i < 300; ++i) {
        std::string bad = good;
        if (i < 100)
            bad.resize(good.size() * i / 100);
        else
            for (std::uint32_t k = 0; k < 1 + i % 8; ++k)
                bad[pcg_hash(i * 16 + k) % bad.size()] = char(pcg_hash(i * 31 + k));
        ASSERT_TRUE(write_file(folder.path / "bad.glb", bad));
        ecs::Registry target;
        scene::MeshStore store;
        const auto report = io::load_scene(folder.path / "bad.glb", target, store);
        if (!report) {
            ++errors;
            EXPECT_NE(report.error().message.find("bad.glb"), std::string::npos);
            EXPECT_EQ(target.entity_count(), 0u) << "nothing half-loaded";
        }
    }
    EXPECT_GT(errors, 100);
    for (const std::string& text :
         {std::string("{}"), std::string("[]"), std::string(200000, '['), std::string(),
          std::string(R"({"sunfleck_scene":1,"gltf":"good.glb","entities":{"lamp":{"AreaLight":{"width":-1}}}})"),
          std::string(R"({"sunfleck_scene":1,"gltf":"good.glb","entities":{"lamp":{"Nonsense":{}}}})"),
          std::string(R"({"sunfleck_scene":1,"gltf":"../../etc/passwd"})")}) {
        ASSERT_TRUE(write_file(folder.path / "bad.scene.json", text));
        ecs::Registry target;
        scene::MeshStore store;
        EXPECT_FALSE(io::load_scene(folder.path / "bad.scene.json", target, store)) << text.substr(0, 80);
    }
}

} // namespace
} // namespace sunfleck::tests
