// What moves in a glTF file still moves, and in the same way, when the scene has been saved and is read again.
#include "engine/scene/animation.h"
#include "engine/scene/deformation.h"
#include "engine/simulation/path_movers.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"

#include <algorithm>
#include <cmath>

namespace sunfleck {
namespace {

using tests::GltfBuilder;
using tests::World;

constexpr int float_type = 5126, short_type = 5123;
const io::ImportOptions with_all = [] {
    io::ImportOptions options;
    options.for_saving = true;
    return options;
}();

std::string name_of(const World& world, ecs::Entity entity) {
    const auto* name = world.registry.try_get<scene::Name>(entity);
    return name != nullptr ? name->name : std::string();
}

void expect_same_animation(const scene::Animation& a, const scene::Animation& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.duration, b.duration);
    ASSERT_EQ(a.curves.size(), b.curves.size());
    for (std::size_t i = 0; i < a.curves.size(); ++i) {
        EXPECT_EQ(a.curves[i].target, b.curves[i].target);
        EXPECT_EQ(a.curves[i].interpolation, b.curves[i].interpolation);
        EXPECT_EQ(a.curves[i].times, b.curves[i].times);
        EXPECT_EQ(a.curves[i].values, b.curves[i].values);
    }
    EXPECT_EQ(a.weights.interpolation, b.weights.interpolation);
    EXPECT_EQ(a.weights.times, b.weights.times);
    EXPECT_EQ(a.weights.values, b.weights.values);
    EXPECT_EQ(a.weights.width, b.weights.width);
}

void expect_same_deformation(const World& from, const scene::Deformation& a, const World& to,
                             const scene::Deformation& b) {
    const scene::DeformableMesh &rest = *a.source, &again = *b.source;
    EXPECT_EQ(rest.rest.positions, again.rest.positions);
    EXPECT_EQ(rest.rest.normals, again.rest.normals);
    EXPECT_EQ(rest.rest.tangents, again.rest.tangents);
    EXPECT_EQ(rest.rest.indices, again.rest.indices);
    EXPECT_EQ(rest.influences, again.influences);
    ASSERT_EQ(rest.joints.size(), again.joints.size());
    for (std::size_t i = 0; i < rest.joints.size(); ++i)
        EXPECT_TRUE(rest.joints[i] == again.joints[i] || rest.weights[i] == 0.0f) << "joint " << i;
    EXPECT_EQ(rest.weights, again.weights);
    ASSERT_EQ(rest.targets.size(), again.targets.size());
    for (std::size_t t = 0; t < rest.targets.size(); ++t) {
        EXPECT_EQ(rest.targets[t].positions, again.targets[t].positions);
        EXPECT_EQ(rest.targets[t].normals, again.targets[t].normals);
    }
    EXPECT_EQ(a.inverse_bind_matrices, b.inverse_bind_matrices);
    EXPECT_EQ(name_of(from, rest.targets.empty() ? ecs::null_entity : a.weights_of),
              name_of(to, rest.targets.empty() ? ecs::null_entity : b.weights_of));
    ASSERT_EQ(a.joints.size(), b.joints.size());
    for (std::size_t j = 0; j < a.joints.size(); ++j)
        EXPECT_EQ(name_of(from, a.joints[j]), name_of(to, b.joints[j]));
}

template <typename T>
void expect_both(const World& from, ecs::Entity a, const World& to, ecs::Entity b) {
    EXPECT_EQ(from.registry.has<T>(a), to.registry.has<T>(b));
}

void expect_same_entity_motion(const World& from, ecs::Entity a, const World& to, ecs::Entity b) {
    const auto &place = from.registry.get<scene::Transform>(a), &again = to.registry.get<scene::Transform>(b);
    EXPECT_EQ(place.position, again.position);
    EXPECT_EQ(place.rotation, again.rotation);
    EXPECT_EQ(place.scale, again.scale);
    const auto parent_of = [](const World& world, ecs::Entity entity) {
        const auto* parent = world.registry.try_get<scene::Parent>(entity);
        return parent != nullptr ? name_of(world, parent->parent) : std::string();
    };
    EXPECT_EQ(parent_of(from, a), parent_of(to, b));
    expect_both<scene::MeshInstance>(from, a, to, b);
    expect_both<scene::Mover>(from, a, to, b);
    expect_both<scene::Animation>(from, a, to, b);
    expect_both<scene::OtherAnimations>(from, a, to, b);
    expect_both<scene::Deformation>(from, a, to, b);
    const auto weights_of = [](const World& world, ecs::Entity entity) {
        const auto* weights = world.registry.try_get<scene::MorphWeights>(entity);
        return weights != nullptr ? weights->weights : std::vector<float>{-1.0f};
    };
    EXPECT_EQ(weights_of(from, a), weights_of(to, b));
    if (const auto* animation = from.registry.try_get<scene::Animation>(a);
        animation != nullptr && to.registry.has<scene::Animation>(b))
        expect_same_animation(*animation, to.registry.get<scene::Animation>(b));
    if (const auto* kept = from.registry.try_get<scene::OtherAnimations>(a);
        kept != nullptr && to.registry.has<scene::OtherAnimations>(b)) {
        const auto& read = to.registry.get<scene::OtherAnimations>(b);
        ASSERT_EQ(kept->clips.size(), read.clips.size());
        for (std::size_t i = 0; i < kept->clips.size(); ++i)
            expect_same_animation(kept->clips[i], read.clips[i]);
    }
    if (const auto* deformation = from.registry.try_get<scene::Deformation>(a);
        deformation != nullptr && to.registry.has<scene::Deformation>(b))
        expect_same_deformation(from, *deformation, to, to.registry.get<scene::Deformation>(b));
}

void move_to(World& world, std::uint64_t step) {
    simulation::set_movers_to_step(world.registry, step);
    scene::update_world_transforms(world.registry);
    scene::deform_meshes(world.registry, world.meshes);
}

// To the bit, in several steps of the simulation.
void expect_same_poses(World& from, World& to) {
    for (const std::uint64_t step : {0, 7, 31, 64, 150, 1003}) {
        move_to(from, step);
        move_to(to, step);
        for (const ecs::Entity entity : from.registry.entities()) {
            const ecs::Entity found = scene::find_by_name(to.registry, name_of(from, entity));
            ASSERT_FALSE(found.is_null());
            EXPECT_EQ(scene::world_matrix(from.registry, entity), scene::world_matrix(to.registry, found))
                << name_of(from, entity) << " in step " << step;
            if (const auto* mesh = from.registry.try_get<scene::MeshInstance>(entity)) {
                const scene::Mesh& here = from.meshes[mesh->mesh];
                const scene::Mesh& there = to.meshes[to.registry.get<scene::MeshInstance>(found).mesh];
                EXPECT_EQ(here.positions, there.positions) << name_of(from, entity) << " in step " << step;
                EXPECT_EQ(here.normals, there.normals) << name_of(from, entity) << " in step " << step;
            }
        }
    }
}

void expect_same_motion(World& from, World& to) {
    const std::vector<ecs::Entity> before = from.registry.entities(), after = to.registry.entities();
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
        ASSERT_EQ(name_of(from, before[i]), name_of(to, after[i])) << "and they are in the same order";
        SCOPED_TRACE(name_of(from, before[i]));
        expect_same_entity_motion(from, before[i], to, after[i]);
    }
    expect_same_poses(from, to);
}

std::filesystem::path export_place(const tests::Folder& folder) {
    const char* keep = std::getenv("SUNFLECK_EXPORTS");
    return keep != nullptr ? std::filesystem::path(keep) : folder.path;
}

// Two triangles that two joints bend, of which one turns; a cubic path of the node above them; of two morph targets one
// has normals; and a second animation, which is not played.
struct Flag : GltfBuilder {
    Flag() {
        add_square();
        primitive()["attributes"]["JOINTS_0"] =
            accessor(std::vector<std::uint16_t>{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, short_type, "VEC4", 4);
        primitive()["attributes"]["WEIGHTS_0"] =
            floats({1, 0, 0, 0, 0.3f, 0.69f, 0, 0, 1, 0, 0, 0, 0.1f, 0.7f, 0, 0}, "VEC4", 4);
        primitive()["attributes"]["NORMAL"] = floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
        const int up = floats({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f}, "VEC3", 3),
                  aside = floats({0, 0, 0, 0.1f, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3", 3);
        primitive()["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}, {"NORMAL", aside}}};
        file["meshes"][0]["weights"] = {0.25, 0.5};
        std::vector<float> bind;
        for (int joint = 0; joint < 2; ++joint)
            for (int i = 0; i < 16; ++i)
                bind.push_back(i == 12 ? -0.5f * float(joint) : i % 5 == 0 ? 1.0f : 0.0f);
        file["skins"] = {{{"joints", {2, 3}}, {"inverseBindMatrices", floats(bind, "MAT4", 16)}}};
        file["nodes"] = {{{"name", "flag"}, {"mesh", 0}, {"skin", 0}},
                         {{"name", "pole"}, {"children", {2}}, {"translation", {0.5, 1, 0}}},
                         {{"name", "hinge"}, {"children", {3}}},
                         {{"name", "tip"}, {"translation", {0.5, 0, 0}}}};
        file["scenes"] = {{{"nodes", {0, 1}}}};
        const float turn = std::sqrt(0.5f);
        const int times = floats({0, 0.4f, 1.7f}, "SCALAR", 1), late = floats({0.5f, 2.5f}, "SCALAR", 1);
        animate(0, 2, "rotation", times, floats({0, 0, 0, 1, 0, turn, 0, turn, 0, 0, 0.6f, 0.8f}, "VEC4", 4), "LINEAR");
        animate(0, 1, "translation", late, floats({0, 0, 0, 1, 2, 3, 0, 1, 0, 1, 0, 0, 4, 5, 6, 0, 0, 0}, "VEC3", 3),
                "CUBICSPLINE");
        animate(0, 3, "scale", times, floats({1, 1, 1, 2, 1, 1, 1, 3, 1}, "VEC3", 3), "STEP");
        animate(0, 0, "weights", times, floats({0, 1, 0.5f, 0.25f, 1, 0}, "SCALAR", 1), "LINEAR");
        animate(1, 1, "translation", late, floats({0, 0, 0, 0, -1, 0}, "VEC3", 3), "LINEAR");
    }
    void animate(std::size_t clip, int node, const char* path, int input, int output, const char* interpolation) {
        nlohmann::json& animation = file["animations"][clip];
        animation["name"] = clip == 0 ? "waves" : "falls";
        animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
        animation["channels"].push_back(
            {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
    }
};

TEST(GltfExport, WhatMovesIsReadAsItWas) {
    const tests::Folder folder("gltf_motion");
    World from, to, again;
    const auto report = from.import(Flag().glb(), with_all);
    ASSERT_TRUE(report) << report.error().message;
    ASSERT_EQ(from.registry.count<scene::Deformation>(), 1u);
    ASSERT_EQ(from.registry.count<scene::Animation>(), 4u);
    ASSERT_EQ(from.registry.count<scene::OtherAnimations>(), 1u);
    const std::filesystem::path file = export_place(folder) / "flag.glb", once_more = folder.path / "again.glb";
    ASSERT_TRUE(io::export_gltf(file, from.registry, from.meshes, from.textures));
    const auto read = io::import_gltf(file, to.registry, to.meshes, to.textures, with_all);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->animations, (std::vector<std::string>{"waves", "falls"}));
    ASSERT_TRUE(io::export_gltf(once_more, to.registry, to.meshes, to.textures));
    EXPECT_EQ(read_file(once_more).value(), read_file(file).value()) << "and so on from save to save";
    expect_same_motion(from, to);
    const float moved = glm::length(scene::world_matrix(to.registry, scene::find_by_name(to.registry, "pole"))[3] -
                                    vec4(0.5f, 1.0f, 0.0f, 1.0f));
    EXPECT_GT(moved, 0.1f) << "it would be the same, too, if nothing moved";
}

TEST(GltfExport, AnimatedModelsAreReadAsTheyWere) {
    const tests::Folder folder("gltf_models");
    std::size_t number = 0;
    for (const char* model : {"Fox.glb", "MorphStressTest.gltf"}) {
        const std::filesystem::path path = std::filesystem::path(SUNFLECK_SOURCE_DIR "/../shared/assets") / model;
        std::error_code code;
        if (!std::filesystem::exists(path, code))
            continue;
        SCOPED_TRACE(model);
        World from, to;
        ASSERT_TRUE(io::import_gltf(path, from.registry, from.meshes, from.textures, with_all));
        ASSERT_GT(from.registry.count<scene::Deformation>(), 0u);
        const std::filesystem::path file =
            export_place(folder) / ("model_" + std::to_string(number++) + "_" + path.stem().string() + ".glb");
        ASSERT_TRUE(io::export_gltf(file, from.registry, from.meshes, from.textures));
        ASSERT_TRUE(io::import_gltf(file, to.registry, to.meshes, to.textures, with_all));
        expect_same_motion(from, to);
    }
    if (number == 0)
        GTEST_SKIP() << "the sample models are not there";
}

// A joint that a skin names twice, with two matrices.
TEST(GltfExport, JointsThatAreThereTwiceAreKept) {
    const tests::Folder folder("gltf_twice");
    World from, to;
    Flag flag;
    flag.file["skins"][0]["joints"] = {3, 3};
    ASSERT_TRUE(from.import(flag.glb(), with_all));
    const std::filesystem::path file = export_place(folder) / "twice.glb";
    ASSERT_TRUE(io::export_gltf(file, from.registry, from.meshes, from.textures));
    ASSERT_TRUE(io::import_gltf(file, to.registry, to.meshes, to.textures, with_all));
    expect_same_motion(from, to);
}

// A model with two materials: its further parts have the weights of the first one's entity.
TEST(GltfExport, PartsOfAMorphingMeshMoveTogether) {
    const tests::Folder folder("gltf_parts");
    GltfBuilder builder;
    builder.add_square();
    const int up = builder.floats({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f}, "VEC3", 3);
    builder.primitive()["targets"] = {{{"POSITION", up}}};
    builder.file["meshes"][0]["primitives"].push_back(builder.primitive());
    builder.file["animations"] = {
        {{"samplers",
          {{{"input", builder.floats({0, 2}, "SCALAR", 1)}, {"output", builder.floats({0, 1}, "SCALAR", 1)}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    World from, to;
    ASSERT_TRUE(from.import(builder.glb(), with_all));
    ASSERT_EQ(from.registry.count<scene::Deformation>(), 2u);
    const std::filesystem::path file = export_place(folder) / "parts.glb";
    ASSERT_TRUE(io::export_gltf(file, from.registry, from.meshes, from.textures));
    ASSERT_TRUE(io::import_gltf(file, to.registry, to.meshes, to.textures, with_all));
    expect_same_motion(from, to);
}

// In an editor joints, animated entities and what took longest can be deleted, and what is skinned can be moved.
TEST(GltfExport, WhatWasDeletedOrMovedStaysSo) {
    const tests::Folder folder("gltf_deleted");
    World from, to;
    ASSERT_TRUE(from.import(Flag().glb(), with_all));
    from.registry.destroy(scene::find_by_name(from.registry, "tip"));
    from.registry.destroy(scene::find_by_name(from.registry, "pole"));
    from.registry.remove<scene::Parent>(scene::find_by_name(from.registry, "hinge"));
    from.registry.remove<scene::Mover>(scene::find_by_name(from.registry, "hinge"));
    const ecs::Entity part = scene::find_by_name(from.registry, "flag part 1");
    ASSERT_FALSE(part.is_null());
    from.registry.patch<scene::Transform>(part, [](scene::Transform& place) { place.position.y = 3.0f; });
    scene::update_world_transforms(from.registry);
    const std::filesystem::path file = folder.path / "flag.scene.json";
    io::SaveOptions options;
    options.exact = true;
    ASSERT_TRUE(io::save_scene(file, from.registry, from.meshes, from.textures, options));
    const auto report = io::load_scene(file, to.registry, to.meshes, to.textures, with_all);
    ASSERT_TRUE(report) << report.error().message;
    for (const std::string& note : report->notes)
        EXPECT_EQ(note.find("joint"), std::string::npos) << note;
    EXPECT_EQ(to.registry.get<scene::Animation>(scene::find_by_name(to.registry, "hinge")).duration, 2.5f)
        << "as long as the pole had moved";
    expect_same_motion(from, to);
}

// What is kept besides is not played instead.
TEST(GltfExport, AnAnimationThatIsNotPlayedStaysSo) {
    const tests::Folder folder("gltf_not_played");
    World from, to;
    io::ImportOptions options = with_all;
    options.animation = -1;
    ASSERT_TRUE(from.import(Flag().glb(), options));
    ASSERT_EQ(from.registry.count<scene::Animation>(), 0u);
    const std::filesystem::path file = folder.path / "flag.glb";
    ASSERT_TRUE(io::export_gltf(file, from.registry, from.meshes, from.textures));
    const auto report = io::import_gltf(file, to.registry, to.meshes, to.textures, with_all);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->animations.size(), 2u);
    EXPECT_EQ(to.registry.count<scene::Animation>(), 0u);
    EXPECT_EQ(to.registry.count<scene::OtherAnimations>(), from.registry.count<scene::OtherAnimations>());
}

// What files say in `extras` is not trusted, either.
TEST(GltfExport, MarksOfStrangersDoNoHarm) {
    using Json = nlohmann::json;
    for (const Json& mark : {Json(true), Json("yes"), Json(-1e300), Json(-1), Json(0), Json(3), Json(4), Json(1 << 30),
                             Json::array(), Json()})
        for (const char* key : {"sunfleck_own_mesh", "sunfleck_no_entity", "sunfleck_not_played", "sunfleck_duration",
                                "sunfleck_weights_of"}) {
            Flag flag;
            for (Json& node : flag.file["nodes"]) {
                node["extras"]["sunfleck_own_mesh"] = true;
                node["extras"][key] = mark;
            }
            for (Json& animation : flag.file["animations"]) {
                animation["extras"] = {{key, mark}};
                for (Json& channel : animation["channels"])
                    channel["extras"] = {{key, mark}};
            }
            World world;
            const auto report = world.import(flag.glb(), with_all);
            ASSERT_TRUE(report) << report.error().message;
            for (const std::uint64_t step : {0, 40, 400})
                move_to(world, step);
            world.registry.view<scene::Animation>().each([](ecs::Entity, const scene::Animation& animation) {
                EXPECT_TRUE(animation.duration >= 1.7f && animation.duration < 10.0f) << "no shorter than its curves";
            });
        }
}

} // namespace
} // namespace sunfleck
