// What glTF 2.0 says about nodes, scenes, materials, skins, cameras and lights, against values worked out by hand.
#include "engine/io/image.h"
#include "engine/scene/deformation.h"
#include "tests/support/gltf_files.h"

#include <cstring>

namespace sunfleck {
namespace {

using nlohmann::json;
using tests::GltfBuilder;
using tests::World;

TEST(GltfImport, NodesInstancesVisibilityAndNames) {
    GltfBuilder file;
    file.add_square();
    const int translations = file.floats({1, 0, 0, 2, 0, 0, 3, 0, 0}, "VEC3", 3);
    file.file["nodes"] = json::array(
        {{{"name", "twin"}, {"children", {1, 2, 3}}, {"translation", {0, 5, 0}}},
         {{"name", "twin"}, {"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 0, -2, 0, 0, 2, 0, 0, 1, 2, 3, 1}}},
         {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}},
         {{"name", "row"},
          {"mesh", 0},
          {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translations}}}}}}}}});
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(world.registry.count<scene::MeshInstance>(), 4u);
    const mat4 second =
        world.registry.get<scene::WorldTransform>(scene::find_by_name(world.registry, "twin #2")).matrix;
    EXPECT_NEAR(glm::length(vec3(second * vec4(0, 1, 0, 1)) - vec3(1, 7, 1)), 0.0f, 1e-5f);
    const mat4 third =
        world.registry.get<scene::WorldTransform>(scene::find_by_name(world.registry, "row instance 2")).matrix;
    EXPECT_EQ(vec3(third[3]), vec3(3.0f, 5.0f, 0.0f));
    EXPECT_FALSE(world.registry.has<scene::MeshInstance>(scene::find_by_name(world.registry, "node 2")));
    EXPECT_EQ(world.meshes.size(), 1u) << "instances share one mesh";
}

// Nothing of a broken file disappears silently.
TEST(GltfImport, WhatNodesCannotHaveIsLeftOutAndSaid) {
    const auto notes_of = [](const char* node, const char* channel) {
        GltfBuilder file;
        file.add_square();
        const int times = file.floats({0, 1}, "SCALAR", 1), values = file.floats({0, 0, 0, 1, 0, 0}, "VEC3", 3),
                  weights = file.floats({0, 1}, "SCALAR", 1);
        file.file["nodes"][0].merge_patch(json::parse(node));
        file.file["nodes"].push_back({{"name", "joint"}});
        file.file["scenes"] = {{{"nodes", {0}}}};
        file.file["skins"] = {{{"joints", {1}}}};
        file.file["extensionsUsed"] = {"KHR_lights_punctual"};
        json animation = {
            {"samplers", {{{"input", times}, {"output", values}}, {{"input", times}, {"output", weights}}}},
            {"channels", json::parse(channel)}};
        if (!animation["channels"].empty())
            file.file["animations"] = json::array({animation});
        World world;
        const auto report = world.import(file.glb());
        EXPECT_TRUE(report) << report.error().message;
        std::string all;
        for (const std::string& note : report ? report->notes : std::vector<std::string>())
            all += note + "\n";
        return all;
    };
    const std::string moved = R"({"sampler":0,"target":{"node":0,"path":"translation"}})";
    EXPECT_EQ(notes_of("{}", "[]"), "");
    EXPECT_EQ(notes_of("{}", ("[" + moved + "]").c_str()), "");
    struct Case {
        std::string node, channels, said;
    };
    const Case cases[] = {
        {R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"scale":[2,2,2]})", "[]", "scale are left out"},
        {R"({"extensions":{"KHR_lights_punctual":{"light":0}}})", "[]", "none of the file's 0"},
        {R"({"extensions":{"KHR_lights_punctual":{}}})", "[]", "none of the file's 0"},
        {R"({"skin":0})", "[]", "the skin is left out"},
        {R"({"weights":[1]})", "[]", "weights, those beyond its mesh's 0"},
        {"{}", R"([{"sampler":1,"target":{"node":0,"path":"weights"}}])", "weights are animated"},
        {"{}", "[" + moved + "," + moved + "]", "all but the last"},
    };
    for (const Case& broken : cases)
        EXPECT_NE(notes_of(broken.node.c_str(), broken.channels.c_str()).find(broken.said), std::string::npos)
            << broken.node << broken.channels;
}

// What stands behind the first chunk of a kind cannot be referred to.
TEST(GltfImport, SecondChunksAreLeftOutAndSaid) {
    GltfBuilder file;
    file.add_square();
    const std::string whole = file.glb();
    for (const char* type : {"JSON", "BIN\0"}) {
        std::string bytes = whole + std::string("\4\0\0\0", 4) + std::string(type, 4) + "{}  ";
        const auto length = std::uint32_t(bytes.size());
        std::memcpy(bytes.data() + 8, &length, sizeof length);
        World world;
        const auto report = world.import(bytes);
        ASSERT_TRUE(report) << report.error().message;
        ASSERT_EQ(report->notes.size(), 1u);
        EXPECT_NE(report->notes[0].find("a second chunk of"), std::string::npos) << report->notes[0];
    }
}

TEST(GltfImport, ScenesVariantsAndAnimationsAreChosen) {
    GltfBuilder file;
    file.add_square();
    file.file["scenes"] = {{{"nodes", {0}}}, {{"name", "other"}, {"nodes", {1}}}};
    file.file["nodes"].push_back({{"name", "lonely"}});
    file.file["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}},
                              {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 1, 1}}}}}};
    file.file["extensionsUsed"] = {"KHR_materials_variants"};
    file.file["extensions"] = {{"KHR_materials_variants", {{"variants", {{{"name", "red"}}, {{"name", "blue"}}}}}}};
    file.primitive()["material"] = 0;
    file.primitive()["extensions"] = {
        {"KHR_materials_variants", {{"mappings", {{{"material", 1}, {"variants", {1}}}}}}}};
    io::ImportOptions options;
    const auto colour = [&] {
        World world;
        EXPECT_TRUE(world.import(file.glb(), options));
        return world.registry.get<scene::Material>(scene::find_by_name(world.registry, "square")).base_colour;
    };
    EXPECT_EQ(colour(), vec3(1, 0, 0));
    options.variant = "red";
    EXPECT_EQ(colour(), vec3(1, 0, 0));
    options.variant = "blue";
    EXPECT_EQ(colour(), vec3(0, 0, 1));
    options.variant = "green";
    EXPECT_FALSE(World().import(file.glb(), options));
    options = {};
    options.scene = 1;
    World world;
    ASSERT_TRUE(world.import(file.glb(), options));
    EXPECT_FALSE(scene::find_by_name(world.registry, "lonely").is_null());
    EXPECT_TRUE(scene::find_by_name(world.registry, "square").is_null());
    options.scene = 2;
    EXPECT_FALSE(World().import(file.glb(), options));
    options = {};
    options.animation = 3;
    EXPECT_FALSE(World().import(file.glb(), options));
}

TEST(GltfImport, TexturesByContentWithTransformAndColourSpace) {
    const std::vector<std::uint8_t> pixels = {255, 0, 0, 255, 0, 128, 0, 255, 0, 0, 255, 64, 255, 255, 255, 255};
    const std::string png = io::encode_png(2, 2, pixels).value();
    GltfBuilder file;
    file.add_square();
    const int image = file.view(png.data(), png.size());
    file.file["images"] = {{{"bufferView", image}, {"mimeType", "image/jpeg"}}}; // mislabelled: the bytes decide
    file.file["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
    file.file["textures"] = {{{"source", 0}, {"sampler", 0}}};
    const json transform = {
        {"KHR_texture_transform", {{"offset", {0.5, 0.25}}, {"rotation", 1.5707963267948966}, {"scale", {2, 1}}}}};
    file.file["materials"] = {{{"pbrMetallicRoughness",
                                {{"baseColorTexture", {{"index", 0}, {"extensions", transform}}},
                                 {"metallicRoughnessTexture", {{"index", 0}}}}},
                               {"alphaMode", "MASK"},
                               {"alphaCutoff", 0.3},
                               {"doubleSided", true}}};
    const int coordinates = file.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
    file.primitive()["attributes"]["TEXCOORD_0"] = coordinates;
    file.primitive()["material"] = 0;
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    ASSERT_EQ(world.textures.size(), 2u) << "as colour and as numbers";
    const ecs::Entity square = scene::find_by_name(world.registry, "square");
    const auto& textures = world.registry.get<scene::MaterialTextures>(square);
    const scene::Texture& colour = world.textures[std::uint32_t(textures.base_colour.texture)];
    const scene::Texture& numbers = world.textures[std::uint32_t(textures.metallic_roughness.texture)];
    EXPECT_TRUE(colour.srgb && colour.nearest && !numbers.srgb);
    EXPECT_EQ(colour.wrap_u, scene::TextureWrap::clamp_to_edge);
    EXPECT_EQ(colour.wrap_v, scene::TextureWrap::mirrored_repeat);
    EXPECT_NEAR(colour.sample({0.75f, 0.25f}).y, 0.2158605f, 1e-5f); // sRGB 128
    EXPECT_NEAR(numbers.sample({0.75f, 0.25f}).y, 128.0f / 255.0f, 1e-6f);
    EXPECT_NEAR(colour.sample({0.25f, 0.75f}).w, 64.0f / 255.0f, 1e-6f); // alpha is linear, and not multiplied in
    EXPECT_NEAR(colour.sample({0.25f, 0.75f}).z, 1.0f, 1e-6f);
    EXPECT_EQ(colour.sample({5.0f, 0.75f}), colour.sample({0.75f, 0.75f}));
    EXPECT_EQ(colour.sample({0.25f, 1.25f}), colour.sample({0.25f, 0.75f}));
    // Counter-clockwise by a right angle on a picture whose v runs down: (u, v) goes to (v, -u).
    const vec2 place = textures.base_colour.coordinates(vec4(0.25f, 0.5f, 0, 0));
    EXPECT_NEAR(place.x, 0.5f + 0.5f, 1e-6f);
    EXPECT_NEAR(place.y, 0.25f - 0.5f, 1e-6f);
    const auto& material = world.registry.get<scene::Material>(square);
    EXPECT_EQ(material.alpha_mode, scene::AlphaMode::mask);
    EXPECT_FLOAT_EQ(material.alpha_cutoff, 0.3f);
    EXPECT_TRUE(material.double_sided);
}

TEST(GltfImport, MaterialExtensions) {
    GltfBuilder file;
    file.add_square();
    file.file["materials"] = {{{"emissiveFactor", {1, 0.5, 0}},
                               {"extensions",
                                {{"KHR_materials_emissive_strength", {{"emissiveStrength", 6830}}},
                                 {"KHR_materials_ior", {{"ior", 1.33}}},
                                 {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
                                 {"KHR_materials_specular", {{"specularFactor", 0}}},
                                 {"KHR_materials_unlit", json::object()}}}}};
    file.primitive()["material"] = 0;
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    const auto& material = world.registry.get<scene::Material>(scene::find_by_name(world.registry, "square"));
    EXPECT_NEAR(material.emission.x, 10.0f, 1e-4f); // 6830 nit over 683 lm/W
    EXPECT_NEAR(material.emission.y, 5.0f, 1e-4f);
    EXPECT_FLOAT_EQ(material.index_of_refraction, 1.33f);
    EXPECT_FLOAT_EQ(material.transmission, 0.75f);
    EXPECT_FALSE(material.specular);
    EXPECT_TRUE(material.unlit);
}

// Two joints, one of them turned by a right angle: a vertex that both hold half goes to the mean of both places.
TEST(GltfImport, SkinsAndMorphTargetsMoveVertices) {
    GltfBuilder file;
    file.add_square();
    json& primitive = file.primitive();
    primitive["attributes"]["NORMAL"] = file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    primitive["attributes"]["JOINTS_0"] =
        file.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5121, "VEC4", 4);
    primitive["attributes"]["WEIGHTS_0"] = file.floats({1, 0, 0, 0, 1, 1, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
    primitive["targets"] = {{{"POSITION", file.floats({0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0}, "VEC3", 3)}}};
    file.file["meshes"][0]["weights"] = {0.5};
    file.file["skins"] = {{{"joints", {1, 2}}}};
    file.file["nodes"] = json::array({{{"name", "square"}, {"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                                      {{"name", "still"}},
                                      {{"name", "turned"}, {"rotation", {0, 0, 0.70710678, 0.70710678}}}});
    file.file["scenes"] = {{{"nodes", {0, 1, 2}}}};
    const int input = file.floats({0, 1}, "SCALAR", 1), output = file.floats({0.5, 1}, "SCALAR", 1);
    file.file["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                                {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_TRUE(scene::deform_meshes(world.registry, world.meshes));
    EXPECT_FALSE(scene::deform_meshes(world.registry, world.meshes)) << "the same pose";
    const ecs::Entity part = scene::find_by_name(world.registry, "square part 1");
    EXPECT_FALSE(scene::is_static(world.registry, part));
    const scene::Mesh& mesh = world.mesh_of("square part 1");
    const auto near = [&](std::size_t vertex, vec3 expected) {
        EXPECT_NEAR(glm::length(mesh.positions[vertex] - expected), 0.0f, 1e-5f) << vertex;
    };
    near(0, vec3(0, 0, 0));
    near(1, vec3(0.5f, 0.5f, 1)); // mean of (1, 0, 1) and (0, 1, 1): the node's own place does not count
    near(2, vec3(-1, 1, 0));
    near(3, vec3(-1, 0, 0));
    // Weights beyond the skin's joints are an error.
    file.file["skins"][0]["joints"] = {1};
    EXPECT_FALSE(World().import(file.glb()));
}

TEST(GltfImport, CamerasAndLights) {
    GltfBuilder file;
    file.file["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}};
    file.file["extensionsUsed"] = {"KHR_lights_punctual"};
    file.file["extensions"] = {
        {"KHR_lights_punctual",
         {{"lights",
           {{{"type", "spot"}, {"intensity", 683}, {"color", {1, 0.5, 0}}, {"spot", {{"outerConeAngle", 0.5}}}}}}}}};
    file.file["nodes"] = json::array({{{"name", "eye"}, {"camera", 0}},
                                      {{"name", "plan"}, {"camera", 1}},
                                      {{"name", "lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}});
    file.file["scenes"] = {{{"nodes", {0, 1, 2}}}};
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_NEAR(world.registry.get<scene::Camera>(scene::find_by_name(world.registry, "eye")).vertical_field_of_view,
                0.7f, 1e-6f);
    const ecs::Entity far = scene::find_by_name(world.registry, "plan orthographic");
    const float distance = world.registry.get<scene::WorldTransform>(far).matrix[3].z;
    const float angle = world.registry.get<scene::Camera>(far).vertical_field_of_view;
    EXPECT_NEAR(distance * std::tan(0.5f * angle), 1.0f, 1e-4f) << "sees ymag to both sides of the camera's place";
    const auto& lamp = world.registry.get<scene::SpotLight>(scene::find_by_name(world.registry, "lamp"));
    EXPECT_NEAR(lamp.intensity.x, 1.0f, 1e-6f);
    EXPECT_NEAR(lamp.intensity.y, 0.5f, 1e-6f);
}

TEST(GltfImport, ProgressCanStopIt) {
    const std::string png = io::encode_png(1, 1, {1, 2, 3, 4}).value();
    GltfBuilder file;
    file.add_square();
    file.file["images"] = {{{"bufferView", file.view(png.data(), png.size())}}};
    file.file["textures"] = {{{"source", 0}}};
    file.file["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
    file.primitive()["material"] = 0;
    io::ImportOptions options;
    options.progress = [](float) { return false; };
    World world;
    EXPECT_FALSE(world.import(file.glb(), options));
    EXPECT_EQ(world.registry.entity_count(), 0u);
}

} // namespace
} // namespace sunfleck
