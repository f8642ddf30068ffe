// What is exported reads as it was.
#include "test_places.h"
#include "tests/support/gltf_files.h"

#include <algorithm>
#include <random>

namespace sunfleck {
namespace {

using tests::World;

void expect_same_texture(const scene::TextureUse& a, const World& from, const scene::TextureUse& b, const World& to) {
    ASSERT_EQ(bool(a), bool(b));
    if (!a)
        return;
    EXPECT_EQ(a.set, b.set);
    const vec4 place(0.2f, 0.7f, 0.4f, 0.9f);
    EXPECT_LT(glm::length(a.coordinates(place) - b.coordinates(place)), 1e-5f);
    const scene::Texture &before = from.textures[std::uint32_t(a.texture)],
                         &after = to.textures[std::uint32_t(b.texture)];
    EXPECT_EQ(before.pixels, after.pixels);
    EXPECT_EQ(before.srgb, after.srgb);
    EXPECT_EQ(before.nearest, after.nearest);
    EXPECT_EQ(before.wrap_u, after.wrap_u);
    EXPECT_EQ(before.wrap_v, after.wrap_v);
}

void expect_same_entity(World& from, ecs::Entity before, World& to, ecs::Entity after) {
    using Use = scene::TextureUse scene::MaterialTextures::*;
    const auto& a = from.registry.get<scene::Material>(before);
    const auto& b = to.registry.get<scene::Material>(after);
    for (const Field& field : scene::Material::description().fields)
        EXPECT_EQ(field_to_text(field, &a), field_to_text(field, &b)) << field.name;
    const scene::MaterialTextures none;
    const auto* textures = from.registry.try_get<scene::MaterialTextures>(before);
    const auto* again = to.registry.try_get<scene::MaterialTextures>(after);
    for (const Use use : {&scene::MaterialTextures::base_colour, &scene::MaterialTextures::metallic_roughness,
                          &scene::MaterialTextures::normal, &scene::MaterialTextures::emission})
        expect_same_texture((textures ? *textures : none).*use, from, (again ? *again : none).*use, to);
    const scene::Mesh& mesh = from.meshes[from.registry.get<scene::MeshInstance>(before).mesh];
    const scene::Mesh& read = to.meshes[to.registry.get<scene::MeshInstance>(after).mesh];
    EXPECT_EQ(mesh.positions, read.positions);
    EXPECT_EQ(mesh.indices, read.indices);
    EXPECT_EQ(mesh.texture_coordinates, read.texture_coordinates);
}

// Every sample model that is valid, and the corpus. With SUNFLECK_EXPORTS what is
// exported stays in that folder (for the Khronos validator).
TEST(GltfExport, WhatIsWrittenReadsAsItWas) {
    namespace fs = std::filesystem;
    const tests::Folder folder;
    const char* keep = std::getenv("SUNFLECK_EXPORTS");
    const fs::path place = keep != nullptr ? fs::path(keep) : folder.path;
    std::vector<fs::path> files;
    for (const char* models : {"/usr/share/assimp/models/glTF2", SUNFLECK_SOURCE_DIR "/tests/corpus/gltf"}) {
        std::error_code code;
        for (const auto& entry : fs::recursive_directory_iterator(models, code))
            if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
                files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    int written = 0, compared = 0;
    for (const fs::path& file : files) {
        World before, after;
        if (!io::import_gltf(file, before.registry, before.meshes, before.textures))
            continue;
        scene::update_world_transforms(before.registry);
        const fs::path copy = place / (std::to_string(written++) + "_" + file.stem().string() + ".glb");
        ASSERT_TRUE(io::export_gltf(copy, before.registry, before.meshes, before.textures)) << file;
        const auto report = io::import_gltf(copy, after.registry, after.meshes, after.textures);
        ASSERT_TRUE(report) << file << ": " << report.error().message;
        SCOPED_TRACE(file);
        before.registry.view<scene::Name, scene::MeshInstance, scene::Material>().each(
            [&](ecs::Entity entity, const scene::Name& name, const scene::MeshInstance&, const scene::Material&) {
                const ecs::Entity found = scene::find_by_name(after.registry, name.name);
                ASSERT_FALSE(found.is_null()) << name.name;
                expect_same_entity(before, entity, after, found);
                ++compared;
            });
    }
    EXPECT_GT(written, 0);
    EXPECT_GT(compared, 0);
}

// Of whatever strength, to the bit, though glTF has other units.
TEST(GltfExport, PowersOfLightAndCamerasAreExact) {
    const tests::Folder folder("gltf_export");
    std::mt19937 random(5);
    std::uniform_real_distribution<float> mantissa(0.0f, 10.0f), decade(-6.0f, 6.0f);
    for (int i = 0; i < 50; ++i) {
        const float size = std::pow(10.0f, decade(random));
        const auto power = [&] { return size * vec3(mantissa(random), mantissa(random), mantissa(random)); };
        World from;
        scene::register_components(from.registry);
        const vec3 point = power(), spot = power(), sun = i == 0 ? vec3(0.0f) : power();
        const auto add = [&](const char* name, const auto& component) {
            const ecs::Entity entity = from.registry.create();
            from.registry.emplace<scene::Name>(entity, {name});
            from.registry.emplace<scene::Transform>(entity);
            from.registry.emplace<std::decay_t<decltype(component)>>(entity, component);
        };
        add("point", scene::PointLight{point});
        add("spot", scene::SpotLight{spot, 0.2f, 0.4f});
        add("sun", scene::DirectionalLight{sun});
        add("camera", scene::Camera{i % 2 == 0 ? 3.1f : 0.01f});
        scene::update_world_transforms(from.registry);
        const std::filesystem::path file = folder.path / "lamps.glb";
        World to;
        ASSERT_TRUE(io::export_gltf(file, from.registry, from.meshes, from.textures));
        ASSERT_TRUE(io::import_gltf(file, to.registry, to.meshes, to.textures));
        const auto get = [&](const char* name) { return scene::find_by_name(to.registry, name); };
        EXPECT_EQ(to.registry.get<scene::PointLight>(get("point")).intensity, point);
        EXPECT_EQ(to.registry.get<scene::SpotLight>(get("spot")).intensity, spot);
        EXPECT_EQ(to.registry.get<scene::DirectionalLight>(get("sun")).irradiance, sun);
        EXPECT_EQ(to.registry.get<scene::Camera>(get("camera")).vertical_field_of_view, i % 2 == 0 ? 3.1f : 0.01f);
    }
}

// Groups are younger than what was put into them. Light of equal lamps is sampled in the order of entities.
TEST(GltfExport, EntitiesComeBackInTheirOrder) {
    const tests::Folder folder("gltf_order");
    World from, to;
    std::vector<ecs::Entity> entities;
    for (const char* name : {"lamp in a group", "lamp", "group in a group", "group"}) {
        entities.push_back(from.registry.create());
        from.registry.emplace<scene::Name>(entities.back(), {name});
        from.registry.emplace<scene::Transform>(entities.back());
    }
    from.registry.emplace<scene::Parent>(entities[0], {entities[2]});
    from.registry.emplace<scene::Parent>(entities[2], {entities[3]});
    const std::filesystem::path file = folder.path / "group.glb", again = folder.path / "again.glb";
    ASSERT_TRUE(io::export_gltf(file, from.registry, from.meshes, from.textures));
    ASSERT_TRUE(io::import_gltf(file, to.registry, to.meshes, to.textures));
    const auto order = [](World& world) {
        std::vector<std::pair<std::string, std::string>> names; // and those of parents
        for (const ecs::Entity entity : world.registry.entities()) {
            const auto* parent = world.registry.try_get<scene::Parent>(entity);
            names.emplace_back(world.registry.get<scene::Name>(entity).name,
                               parent != nullptr ? world.registry.get<scene::Name>(parent->parent).name : "");
        }
        return names;
    };
    EXPECT_EQ(order(to), order(from));
    ASSERT_TRUE(io::export_gltf(again, to.registry, to.meshes, to.textures));
    EXPECT_EQ(read_file(again).value(), read_file(file).value());
}

} // namespace
} // namespace sunfleck
