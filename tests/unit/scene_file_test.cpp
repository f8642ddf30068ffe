// Scene files: what is saved comes back, damage is told, and no interruption loses both the old and the new.
#include "assets/test_rooms.h"
#include "engine/core/random.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sys/resource.h>
#include <sys/wait.h>

namespace sunfleck::tests {
namespace {

namespace fs = std::filesystem;

struct Loaded {
    ecs::Registry registry;
    scene::MeshStore meshes;
};

bool nearly(vec3 a, vec3 b) {
    return glm::length(a - b) <= 1e-5f * (1.0f + glm::length(a));
}

void expect_same_shape(const Loaded& before, ecs::Entity old_entity, const Loaded& after, ecs::Entity entity) {
    if (const auto* t = before.registry.try_get<scene::Transform>(old_entity)) {
        const auto& u = after.registry.get<scene::Transform>(entity);
        EXPECT_TRUE(nearly(t->position, u.position) && nearly(t->scale, u.scale));
        EXPECT_NEAR(std::abs(glm::dot(t->rotation, u.rotation)), 1.0f, 1e-5f);
    }
    if (const auto* m = before.registry.try_get<scene::MeshInstance>(old_entity)) {
        const scene::Mesh& a = before.meshes[m->mesh];
        const scene::Mesh& b = after.meshes[after.registry.get<scene::MeshInstance>(entity).mesh];
        EXPECT_EQ(a.positions, b.positions);
        EXPECT_EQ(a.normals, b.normals);
        EXPECT_EQ(a.indices, b.indices);
    }
}

void expect_same_rest(const ecs::Registry& before, ecs::Entity old_entity, const ecs::Registry& after,
                      ecs::Entity entity) {
    if (const auto* m = before.try_get<scene::Material>(old_entity)) {
        const auto& n = after.get<scene::Material>(entity);
        EXPECT_TRUE(nearly(m->base_colour, n.base_colour) && nearly(m->emission, n.emission));
        EXPECT_EQ(m->specular, n.specular);
    }
    if (const auto* c = before.try_get<scene::Camera>(old_entity)) {
        EXPECT_NEAR(c->vertical_field_of_view, after.get<scene::Camera>(entity).vertical_field_of_view, 1e-6f);
    }
    if (const auto* m = before.try_get<scene::Mover>(old_entity)) {
        EXPECT_EQ(m->path, after.get<scene::Mover>(entity).path);
        EXPECT_EQ(m->period, after.get<scene::Mover>(entity).period);
    }
    if (const auto* l = before.try_get<scene::AreaLight>(old_entity)) {
        EXPECT_EQ(l->radiance, after.get<scene::AreaLight>(entity).radiance);
    }
    if (const auto* l = before.try_get<scene::SpotLight>(old_entity)) {
        EXPECT_TRUE(nearly(l->intensity, after.get<scene::SpotLight>(entity).intensity));
    }
}

TEST(SceneFiles, EverySceneComesBackAsItWas) {
    const Folder folder;
    for (const assets::BuiltInScene& built_in : assets::built_in_scenes()) {
        Loaded before, after;
        scene::TextureStore textures;
        assets::SceneBuilder builder(before.registry, before.meshes);
        built_in.make(builder);
        const fs::path file = folder.path / (std::string(built_in.name) + ".scene.json");
        ASSERT_TRUE(io::save_scene(file, before.registry, before.meshes, textures));
        const auto report = io::load_scene(file, after.registry, after.meshes, textures);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_TRUE(report->notes.empty());
        int compared = 0;
        before.registry.view<scene::Name>().each([&](ecs::Entity old_entity, const scene::Name& name) {
            const ecs::Entity entity = scene::find_by_name(after.registry, name.name);
            ASSERT_FALSE(entity.is_null()) << name.name;
            ++compared;
            expect_same_shape(before, old_entity, after, entity);
            expect_same_rest(before.registry, old_entity, after.registry, entity);
        });
        EXPECT_GT(compared, 2);
    }
}

// good.scene.json and good.glb.
void save_good_scene(const fs::path& folder) {
    World world;
    assets::SceneBuilder builder(world.registry, world.meshes);
    assets::make_gap_room(builder);
    ASSERT_TRUE(io::save_scene(folder / "good.scene.json", world.registry, world.meshes, world.textures));
}

TEST(SceneFiles, DamagedFilesAreErrors) {
    const Folder folder;
    save_good_scene(folder.path);
    scene::TextureStore textures;
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
        const auto report = io::load_scene(folder.path / "bad.glb", target, store, textures);
        if (!report) {
            ++errors;
            EXPECT_NE(report.error().message.find("bad.glb"), std::string::npos);
            EXPECT_EQ(target.entity_count(), 0u) << "nothing half-loaded";
        }
    }
    EXPECT_GT(errors, 100);
}

TEST(SceneFiles, DamagedJsonIsAnError) {
    const Folder folder;
    save_good_scene(folder.path);
    scene::TextureStore textures;
    for (const std::string& text :
         {std::string("{}"), std::string("[]"), std::string(200000, '['), std::string(),
          std::string(R"({"sunfleck_scene":1,"gltf":"good.glb","entities":{"lamp":{"AreaLight":{"width":-1}}}})"),
          std::string(R"({"sunfleck_scene":1,"gltf":"good.glb","entities":{"lamp":{"Nonsense":{}}}})"),
          std::string(R"({"sunfleck_scene":1,"gltf":"../../etc/passwd"})")}) {
        ASSERT_TRUE(write_file(folder.path / "bad.scene.json", text));
        ecs::Registry target;
        scene::MeshStore store;
        EXPECT_FALSE(io::load_scene(folder.path / "bad.scene.json", target, store, textures)) << text.substr(0, 80);
    }
}

// By no spelling and no link does a scene reach what lies beside its folder, unless that is allowed.
TEST(SceneFiles, WhatLiesOutsideIsNotRead) {
    const Folder folder;
    const fs::path inner = folder.path / "inner";
    fs::create_directories(inner / "deeper");
    save_good_scene(inner);
    save_good_scene(folder.path);
    const fs::path picture = SUNFLECK_SOURCE_DIR "/tests/corpus/image/two.hdr";
    fs::copy_file(picture, inner / "sky.hdr");
    fs::copy_file(picture, folder.path / "sky.hdr");
    fs::create_directory_symlink("..", inner / "up");
    fs::create_directory_symlink(folder.path, inner / "deeper" / "far");
    for (const char* name : {"good.glb", "sky.hdr"})
        fs::create_symlink(fs::path("..") / name, inner / (std::string("link_") + name));
    const auto load = [&](const std::string& gltf, const std::string& sky, bool allowed) {
        const nlohmann::json file = {
            {"sunfleck_scene", 2},
            {"gltf", gltf},
            {"entities", {{"sky", {{"Environment", {{"radiance", {1, 1, 1}}}}, {"EnvironmentMap", {{"file", sky}}}}}}}};
        EXPECT_TRUE(write_file(inner / "a.scene.json", file.dump()));
        World world;
        io::ImportOptions options;
        options.allow_outside = allowed;
        const auto report =
            io::load_scene(inner / "a.scene.json", world.registry, world.meshes, world.textures, options);
        if (!report)
            return report.error().message;
        bool has_picture = false;
        world.registry.view<scene::EnvironmentMap>().each(
            [&](ecs::Entity, const scene::EnvironmentMap& map) { has_picture = map.image != nullptr; });
        EXPECT_NE(has_picture, !report->notes.empty()) << "a scene without its picture says why";
        return report->notes.empty() ? std::string() : report->notes.back();
    };
    ASSERT_EQ(load("good.glb", "sky.hdr", false), "");
    EXPECT_EQ(load("./deeper/../good.glb", "up/inner/sky.hdr", false), "") << "it lies inside, whichever way";
    for (const std::string& way : {std::string("../"), std::string("deeper/../../"), std::string("up/"),
                                   std::string("deeper/far/"), std::string("link_"), folder.path.string() + "/"}) {
        for (const std::string& message :
             {load(way + "good.glb", "sky.hdr", false), load("good.glb", way + "sky.hdr", false)})
            EXPECT_NE(message.find("lies outside the scene's folder"), std::string::npos) << way << ": " << message;
        EXPECT_EQ(load(way + "good.glb", way + "sky.hdr", true), "") << way;
    }
}

// Every byte of a scene file and its .glb matters: one bit changed anywhere is told (or was in white space).
TEST(SceneFiles, ChecksumsTellDamage) {
    const Folder folder;
    World world;
    assets::SceneBuilder builder(world.registry, world.meshes);
    assets::make_cornell(builder);
    const fs::path path = folder.path / "box.scene.json";
    ASSERT_TRUE(io::save_scene(path, world.registry, world.meshes, world.textures, {{}, {{"lights", "600"}}}));
    const auto load = [&] {
        World fresh;
        return io::load_scene(path, fresh.registry, fresh.meshes, fresh.textures);
    };
    const auto report = load();
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->settings.at("lights"), "600");
    for (const char* name : {"box.scene.json", "box.glb"}) {
        const std::string good = read_file(folder.path / name).value();
        for (std::uint32_t i = 0; i < 60; ++i) {
            std::string bad = good;
            const std::size_t at = pcg_hash(i) % bad.size();
            if (std::isspace(static_cast<unsigned char>(bad[at])))
                continue;
            bad[at] = char(bad[at] ^ 1);
            ASSERT_TRUE(write_file(folder.path / name, bad));
            EXPECT_FALSE(load()) << name << ", byte " << at;
        }
        ASSERT_TRUE(write_file(folder.path / name, good));
    }
    EXPECT_TRUE(load());
}

// A scene that refers to a glTF file keeps what was changed, and leaves that file alone.
// The floor's colour and place, a light without a name, and one with.
void edit(ecs::Registry& registry) {
    const ecs::Entity floor = scene::find_by_name(registry, "floor");
    registry.patch<scene::Material>(floor, [](scene::Material& m) { m.base_colour = vec3(0.123456789f, 0.2f, 0.3f); });
    registry.patch<scene::Transform>(floor, [](scene::Transform& t) { t.position.y = -0.1f; });
    registry.emplace<scene::PointLight>(registry.create());
    const ecs::Entity lamp = registry.create();
    registry.emplace<scene::Name>(lamp, {"new lamp"});
    registry.emplace<scene::Transform>(lamp, {vec3(0.1f, 0.2f, 0.3f)});
    registry.emplace<scene::PointLight>(lamp, {vec3(1.0f / 3.0f)});
}

TEST(SceneFiles, ReferencesKeepChanges) {
    const Folder folder;
    World world;
    assets::SceneBuilder builder(world.registry, world.meshes);
    assets::make_cornell(builder);
    ASSERT_TRUE(io::export_gltf(folder.path / "artist.glb", world.registry, world.meshes, world.textures));
    const std::string before = read_file(folder.path / "artist.glb").value();
    World edited;
    ASSERT_TRUE(io::load_scene(folder.path / "artist.glb", edited.registry, edited.meshes, edited.textures));
    edit(edited.registry);
    const fs::path path = folder.path / "edit.scene.json";
    ASSERT_TRUE(io::save_scene(path, edited.registry, edited.meshes, edited.textures, {"artist.glb", {}}));
    EXPECT_EQ(read_file(folder.path / "artist.glb").value(), before);
    World after;
    const auto report = io::load_scene(path, after.registry, after.meshes, after.textures);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(after.registry.get<scene::Material>(scene::find_by_name(after.registry, "floor")).base_colour,
              vec3(0.123456789f, 0.2f, 0.3f))
        << "to the last bit";
    EXPECT_EQ(after.registry.get<scene::Transform>(scene::find_by_name(after.registry, "floor")).position.y, -0.1f);
    EXPECT_EQ(after.registry.get<scene::PointLight>(scene::find_by_name(after.registry, "new lamp")).intensity,
              vec3(1.0f / 3.0f));
    // Saved again, the file is the same.
    ASSERT_TRUE(io::save_scene(folder.path / "again.scene.json", after.registry, after.meshes, after.textures,
                               {"artist.glb", {}}));
    EXPECT_EQ(read_file(path).value(), read_file(folder.path / "again.scene.json").value());
}

// A scene of version `number`, told by its exposure.
void fill(World& world, int number) {
    assets::SceneBuilder builder(world.registry, world.meshes);
    assets::make_cornell(builder);
    world.registry.patch<scene::Exposure>(scene::find_by_name(world.registry, "exposure"),
                                          [&](scene::Exposure& e) { e.ev100 = float(number % 30); });
    builder.box("box " + std::to_string(number), vec3(0.0f), vec3(1.0f), assets::diffuse(vec3(0.5f)));
}

// The number of the scene that the file holds; the .glb and the scene file must be of one version.
int loaded_number(const fs::path& path) {
    World world;
    const auto report = io::load_scene(path, world.registry, world.meshes, world.textures);
    EXPECT_TRUE(report) << report.error().message;
    const ecs::Entity exposure = scene::find_by_name(world.registry, "exposure");
    const int number = report ? int(world.registry.get<scene::Exposure>(exposure).ev100) : -1;
    bool found = false;
    world.registry.view<scene::Name>().each([&](ecs::Entity, const scene::Name& name) {
        found = found || (name.name.compare(0, 4, "box ") == 0 && std::stoi(name.name.substr(4)) % 30 == number);
    });
    EXPECT_TRUE(found) << "geometry and scene file are of different saves";
    return number;
}

bool save_number(const fs::path& path, int number) {
    World world;
    fill(world, number);
    return bool(io::save_scene(path, world.registry, world.meshes, world.textures));
}

// Microseconds that a child takes which saves once, on this machine and in this build.
double microseconds_of_a_save(const fs::path& path) {
    const auto start = std::chrono::steady_clock::now();
    const pid_t child = fork();
    if (child == 0)
        _exit(save_number(path, 0) ? 0 : 1);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

TEST(SceneFiles, KillingASaveLosesNothing) {
    const Folder folder;
    const fs::path path = folder.path / "killed.scene.json";
    double save = microseconds_of_a_save(path); // the shortest of five
    for (int i = 1; i < 5; ++i)
        save = std::min(save, microseconds_of_a_save(path));
    int changed = 0, last = 0;
    for (int attempt = 1; attempt <= 100; ++attempt) {
        const pid_t child = fork();
        if (child == 0) // saves one version after the other until it is killed
            for (int number = attempt * 100;; ++number)
                if (!save_number(path, number))
                    _exit(1);
        usleep(useconds_t(save * 4.0 * (pcg_hash(std::uint32_t(attempt)) * 0x1p-32))); // in one of the first few saves
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_TRUE(WIFSIGNALED(status)) << "a save failed";
        const int number = loaded_number(path);
        changed += number != last;
        last = number;
    }
    EXPECT_GT(changed, 20) << "the saves were too slow to be interrupted at different places";
}

// A file-size limit stands for a full disk: writes fail in the middle.
TEST(SceneFiles, AFullDiskLosesNothing) {
    const Folder folder;
    const fs::path path = folder.path / "full.scene.json";
    World world;
    fill(world, 1);
    ASSERT_TRUE(io::save_scene(path, world.registry, world.meshes, world.textures));
    World next;
    fill(next, 2);
    for (const rlim_t limit : {0, 100, 1000, 3000, 6000, 9000}) {
        const pid_t child = fork();
        if (child == 0) {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit size{limit, limit};
            setrlimit(RLIMIT_FSIZE, &size);
            const Status status = io::save_scene(path, next.registry, next.meshes, next.textures);
            _exit(status ? 0 : 3);
        }
        int status = 0;
        waitpid(child, &status, 0);
        ASSERT_TRUE(WIFEXITED(status));
        const int number = loaded_number(path);
        EXPECT_EQ(number, WEXITSTATUS(status) == 0 ? 2 : 1) << limit;
        if (WEXITSTATUS(status) == 0)
            break;
        for (const auto& entry : fs::directory_iterator(folder.path))
            EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
    }
}

TEST(SceneFiles, TheSchemaInTheDocumentationIsCurrent) {
    EXPECT_EQ(read_file(fs::path(SUNFLECK_SOURCE_DIR) / "docs/scene.schema.json").value(), io::scene_file_schema())
        << "write it again: sunfleck info --schema > docs/scene.schema.json";
}

} // namespace
} // namespace sunfleck::tests
