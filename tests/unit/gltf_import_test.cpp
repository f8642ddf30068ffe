// What glTF 2.0 says about geometry and its compression, piece by piece against values worked out by hand.
#include "tests/support/gltf_files.h"

#include <meshoptimizer.h>

namespace sunfleck {
namespace {

using nlohmann::json;
using tests::GltfBuilder;
using tests::World;

TEST(GltfImport, MissingNormalsMakeFlatFaces) {
    GltfBuilder file;
    file.add_square();
    World world;
    ASSERT_TRUE(world.import(file.glb()));
    const scene::Mesh& mesh = world.mesh_of("square");
    ASSERT_EQ(mesh.positions.size(), 6u); // each triangle has vertices of its own
    for (const vec3 normal : mesh.normals)
        EXPECT_EQ(normal, vec3(0.0f, 0.0f, 1.0f));
}

TEST(GltfImport, SparseAccessorsReplaceElements) {
    GltfBuilder file;
    file.add_square();
    const std::vector<std::uint8_t> places = {1, 3, 0, 0};
    const std::vector<float> values = {5, 0, 0, 0, 7, 0};
    const int index_view = file.view(places.data(), 2), value_view = file.view(values.data(), 24);
    file.file["accessors"][0]["sparse"] = {{"count", 2},
                                           {"indices", {{"bufferView", index_view}, {"componentType", 5121}}},
                                           {"values", {{"bufferView", value_view}}}};
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(world.meshes[0].bounds().maximum, vec3(5.0f, 7.0f, 0.0f));
    // Indices that fall back or point past the end are errors.
    file.file["accessors"][0]["sparse"]["count"] = 3;
    EXPECT_FALSE(World().import(file.glb()));
}

TEST(GltfImport, AccessorsWithoutDataAreZero) {
    GltfBuilder file;
    file.add_square();
    file.file["accessors"][0].erase("bufferView");
    const std::vector<std::uint16_t> places = {2};
    const std::vector<float> values = {1, 2, 3};
    const int index_view = file.view(places.data(), 2), value_view = file.view(values.data(), 12);
    file.file["accessors"][0]["sparse"] = {{"count", 1},
                                           {"indices", {{"bufferView", index_view}, {"componentType", 5123}}},
                                           {"values", {{"bufferView", value_view}}}};
    World world;
    ASSERT_TRUE(world.import(file.glb()));
    EXPECT_EQ(world.meshes[0].bounds().maximum, vec3(1.0f, 2.0f, 3.0f));
    EXPECT_EQ(world.meshes[0].bounds().minimum, vec3(0.0f));
}

// Valid, and undefined by glTF 2.0 (sec. 3.6.1.2).
TEST(GltfImport, BuffersWithoutBytesAreZero) {
    GltfBuilder file;
    file.add_square();
    file.file["buffers"][1] = {{"byteLength", 48}};
    file.file["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 48}});
    file.file["accessors"][0]["bufferView"] = file.file["bufferViews"].size() - 1;
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_TRUE(std::any_of(report->notes.begin(), report->notes.end(), [](const std::string& note) {
        return note.find("buffer 1 has no URI") != std::string::npos;
    }));
}

TEST(GltfImport, InterleavedAttributesAndEveryIndexType) {
    for (const int type : {5121, 5123, 5125}) {
        GltfBuilder file;
        const std::vector<float> vertices = {0, 0, 0, 0, 1, 0, 2, 0, 0, 0, 1, 0, 0, 0, 2, 0, 1, 0}; // position, normal
        const int data = file.view(vertices.data(), 72);
        file.file["bufferViews"][0]["byteStride"] = 24;
        for (const int offset : {0, 12})
            file.file["accessors"].push_back({{"bufferView", data},
                                              {"byteOffset", offset},
                                              {"componentType", 5126},
                                              {"count", 3},
                                              {"type", "VEC3"}});
        int indices = 0;
        if (type == 5121)
            indices = file.accessor(std::vector<std::uint8_t>{0, 1, 2}, type, "SCALAR", 3);
        else if (type == 5123)
            indices = file.accessor(std::vector<std::uint16_t>{0, 1, 2}, type, "SCALAR", 3);
        else
            indices = file.accessor(std::vector<std::uint32_t>{0, 1, 2}, type, "SCALAR", 3);
        file.file["meshes"] = {
            {{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", indices}}}}}};
        file.file["nodes"] = {{{"mesh", 0}}};
        World world;
        const auto report = world.import(file.glb());
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_EQ(world.meshes[0].positions, (std::vector<vec3>{{0, 0, 0}, {2, 0, 0}, {0, 0, 2}}));
        EXPECT_EQ(world.meshes[0].normals[1], vec3(0.0f, 1.0f, 0.0f));
    }
}

TEST(GltfImport, StripsAndFansWindAsTheSpecificationSays) {
    // Sec. 3.7.2.1: strip p_i = {v_i, v_(i+1+i%2), v_(i+2-i%2)}, fan p_i = {v_(i+1), v_(i+2), v_0}.
    for (const auto& [mode, expected] : std::vector<std::pair<int, std::vector<std::uint32_t>>>{
             {4, {0, 1, 2}}, {5, {0, 1, 2, 1, 3, 2, 2, 3, 4}}, {6, {1, 2, 0, 2, 3, 0, 3, 4, 0}}}) {
        GltfBuilder file;
        const int positions = file.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0, 2, 1, 0}, "VEC3", 3);
        const int normals = file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
        file.file["meshes"] = {
            {{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"mode", mode}}}}}};
        file.file["nodes"] = {{{"mesh", 0}}};
        World world;
        ASSERT_TRUE(world.import(file.glb()));
        EXPECT_EQ(world.meshes[0].indices, expected) << mode;
    }
}

// Volume within a closed surface of outward triangles (divergence theorem).
double volume_of(const scene::Mesh& mesh) {
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        sum += double(glm::dot(mesh.positions[mesh.indices[i]],
                               glm::cross(mesh.positions[mesh.indices[i + 1]], mesh.positions[mesh.indices[i + 2]])));
    return sum / 6.0;
}

TEST(GltfImport, PointsAndLinesAreThinBodies) {
    const double radius = 1e-3 * std::sqrt(2.0); // a thousandth of the square's diagonal
    const double octahedron = 4.0 / 3.0 * radius * radius * radius;
    const double prism = 0.75 * std::sqrt(3.0) * radius * radius; // its section: a triangle of that circumradius
    const std::pair<int, double> modes[] = {
        {0, 4.0 * octahedron}, {1, 2.0 * prism}, {2, 4.0 * prism}, {3, 3.0 * prism}};
    for (const auto& [mode, volume] : modes) {
        GltfBuilder file;
        file.add_square();
        file.primitive()["mode"] = mode;
        file.primitive()["indices"] = file.accessor(std::vector<std::uint16_t>{0, 1, 2, 3}, 5123, "SCALAR", 4);
        World world;
        const auto report = world.import(file.glb());
        ASSERT_TRUE(report) << report.error().message;
        const scene::Mesh& mesh = world.mesh_of("square");
        EXPECT_NEAR(volume_of(mesh), volume, 1e-3 * volume) << "mode " << mode;
        ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            const vec3 corner = glm::round(mesh.positions[i]);
            EXPECT_LT(glm::length(mesh.positions[i] - corner - float(radius) * mesh.normals[i]), 1e-6f);
        }
    }
}

TEST(GltfImport, QuantizedAttributesAndVertexColours) {
    GltfBuilder file;
    file.file["extensionsUsed"] = file.file["extensionsRequired"] = {"KHR_mesh_quantization"};
    const int positions =
        file.accessor(std::vector<std::int16_t>{0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0}, 5122, "VEC3", 3);
    file.file["bufferViews"].back()["byteStride"] = 8;
    const int normals =
        file.accessor(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, -128, 0}, 5120, "VEC3", 3);
    file.file["bufferViews"].back()["byteStride"] = 4;
    file.file["accessors"].back()["normalized"] = true;
    const int colours =
        file.accessor(std::vector<std::uint8_t>{255, 0, 51, 255, 0, 0, 0, 128, 0, 255, 0, 0}, 5121, "VEC4", 3);
    file.file["accessors"].back()["normalized"] = true;
    file.file["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"COLOR_0", colours}}}}}}}};
    file.file["nodes"] = {{{"mesh", 0}, {"scale", {0.01, 0.01, 0.01}}}};
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    const scene::Mesh& mesh = world.meshes[0];
    EXPECT_EQ(mesh.positions[1], vec3(100.0f, 0.0f, 0.0f));
    EXPECT_EQ(mesh.normals[2], vec3(0.0f, 0.0f, -1.0f)); // -128 and -127 both stand for -1
    EXPECT_EQ(mesh.colours[0], vec4(1.0f, 0.0f, 0.2f, 1.0f));
    EXPECT_NEAR(mesh.colours[1].w, 128.0f / 255.0f, 1e-6f);
}

TEST(GltfImport, DracoMeshes) {
    // A rectangle of 4 by 2 m, encoded by draco::Encoder 1.5.5 with its defaults; its positions have the id 0.
    const std::vector<std::uint8_t> data_bytes = {
        68, 82, 65, 67, 79, 2, 2, 1, 1, 0,  0, 0, 4, 2, 0, 2, 0,   0,  1, 31, 255, 1,  17, 1, 255, 0,  0, 1,
        0,  9,  3,  0,  0,  0, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0,   0,  0, 0,  128, 64, 0,  0, 0,   64, 0, 0,
        0,  0,  0,  0,  0,  0, 0, 0, 0, 64, 0, 0, 0, 0, 0, 0, 128, 64, 0, 0,  0,   0,  0,  0, 0,   0};
    GltfBuilder file;
    file.file["accessors"] = {{{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                              {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}};
    const int data = file.view(data_bytes.data(), data_bytes.size());
    file.file["extensionsUsed"] = file.file["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    file.file["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", 0}}},
            {"indices", 1},
            {"extensions",
             {{"KHR_draco_mesh_compression", {{"bufferView", data}, {"attributes", {{"POSITION", 0}}}}}}}}}}}};
    file.file["nodes"] = {{{"name", "square"}, {"mesh", 0}}};
    World world;
    const auto report = world.import(file.glb());
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(world.meshes[0].triangle_count(), 2u);
    EXPECT_NEAR(glm::length(world.meshes[0].bounds().maximum - vec3(4, 2, 0)), 0.0f, 1e-2f);
    file.binary.resize(file.binary.size() / 2);
    file.file["bufferViews"][0]["byteLength"] = file.binary.size();
    EXPECT_FALSE(World().import(file.glb()));
}

TEST(GltfImport, MeshoptBuffers) {
    const std::vector<float> positions = {0, 0, 0, 3, 0, 0, 3, 3, 0, 0, 3, 0};
    const std::vector<std::uint32_t> indices = {0, 1, 2, 0, 2, 3};
    std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(4, 12)),
        triangles(meshopt_encodeIndexBufferBound(6, 4));
    vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), positions.data(), 4, 12));
    triangles.resize(meshopt_encodeIndexBuffer(triangles.data(), triangles.size(), indices.data(), 6));
    GltfBuilder file;
    const int vertex_view = file.view(vertices.data(), vertices.size()),
              index_view = file.view(triangles.data(), triangles.size());
    const auto compress = [&](int view, int stride, int count, const char* mode, std::size_t plain) {
        json& target = file.file["bufferViews"][view];
        const json source = {{"buffer", 0},
                             {"byteOffset", target["byteOffset"]},
                             {"byteLength", target["byteLength"]},
                             {"byteStride", stride},
                             {"count", count},
                             {"mode", mode}};
        target = {{"buffer", 1}, {"byteLength", plain}, {"extensions", {{"EXT_meshopt_compression", source}}}};
    };
    compress(vertex_view, 12, 4, "ATTRIBUTES", 48);
    compress(index_view, 4, 6, "TRIANGLES", 24);
    file.file["extensionsUsed"] = file.file["extensionsRequired"] = {"EXT_meshopt_compression"};
    file.file["accessors"] = {{{"bufferView", vertex_view}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                              {{"bufferView", index_view}, {"componentType", 5125}, {"count", 6}, {"type", "SCALAR"}}};
    file.file["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
    file.file["nodes"] = {{{"mesh", 0}}};
    std::string bytes = file.glb();
    file.file["buffers"].push_back(
        {{"byteLength", 72}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    GltfBuilder with_fallback = file;
    const std::string text = with_fallback.file.dump();
    // glb() writes one buffer; with the stand-in the JSON is put together here.
    std::string padded = text;
    padded.resize((padded.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t value) {
        const std::uint32_t bits = std::uint32_t(value);
        return std::string(reinterpret_cast<const char*>(&bits), 4);
    };
    std::string body = file.binary;
    body.resize((body.size() + 3) / 4 * 4, '\0');
    bytes = "glTF" + word(2) + word(28 + padded.size() + body.size()) + word(padded.size()) + "JSON" + padded +
            word(body.size()) + std::string("BIN\0", 4) + body;
    World world;
    const auto report = world.import(bytes);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(world.meshes[0].bounds().maximum, vec3(3.0f, 3.0f, 0.0f));
    EXPECT_EQ(world.meshes[0].triangle_count(), 2u);
}

// What few exporters write, and the format allows.
TEST(GltfImport, RareButValidFormsAreRead) {
    const auto imported = [](const auto& change) {
        GltfBuilder file;
        file.add_square();
        static_cast<void>(file.glb()); // adds the buffer
        change(file.file);
        World world;
        const auto report = world.import(file.glb());
        EXPECT_TRUE(report) << report.error().message;
        return std::pair(report ? report.value().notes.size() : 99, world.meshes.size());
    };
    using Outcome = std::pair<std::size_t, std::uint32_t>; // notes, meshes
    // Whole numbers with a fraction of zero.
    EXPECT_EQ(imported([](json& f) {
                  f["nodes"][0]["mesh"] = 0.0;
                  f["accessors"][0]["count"] = 4.0;
                  f["bufferViews"][0]["byteLength"] = 48.0;
                  f["scene"] = 0.0;
              }),
              (Outcome{0, 1}));
    EXPECT_EQ(imported([](json& f) {
                  f["buffers"].push_back({{"byteLength", 100}});
              }).second,
              1u)
        << "an unused buffer without a URI";
    EXPECT_EQ(imported([](json& f) { f["accessors"][1].erase("bufferView"); }), (Outcome{0, 1})) << "indices of zero";
    EXPECT_EQ(imported([](json& f) { f["accessors"][0].erase("bufferView"); }), (Outcome{0, 1})) << "positions of zero";
    EXPECT_EQ(imported([](json& f) {
                  f["meshes"][0]["primitives"].push_back({{"attributes", {{"_CUSTOM", 0}}}});
              }),
              (Outcome{1, 1}))
        << "a primitive without positions is left out, with a note";
    EXPECT_EQ(imported([](json& f) {
                  f["buffers"].push_back({{"byteLength", 3}, {"uri", "data:application/octet-stream,a%20b"}});
                  f["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 3}});
              }),
              (Outcome{0, 1}))
        << "a data URI that is not base64";
}

// Indices may begin within the view of the positions and end behind it.
TEST(GltfImport, ViewsMayOverlap) {
    World plain;
    GltfBuilder file;
    file.add_square();
    ASSERT_TRUE(plain.import(file.glb()));
    for (const int back : {12, 48}) { // partly; from the same begin on
        World overlapping;
        json& view = file.file["bufferViews"][1];
        view["byteOffset"] = 48 - back;
        view["byteLength"] = 12 + back;
        file.file["accessors"][1]["byteOffset"] = back;
        const auto report = overlapping.import(file.glb());
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_TRUE(report->notes.empty());
        ASSERT_EQ(overlapping.meshes.size(), 1u);
        EXPECT_EQ(overlapping.meshes[0].indices, plain.meshes[0].indices);
        EXPECT_EQ(overlapping.meshes[0].positions, plain.meshes[0].positions);
    }
}

// Broken parts that nothing uses do no harm; those that something uses are named.
TEST(GltfImport, BrokenPartsMatterWhereTheyAreUsed) {
    struct Case {
        const char *section, *element; // added as the last of its section
        const char *user, *use;        // "use" merged into the first element of section "user" uses it
        const char* named;
    };
    const Case cases[] = {
        {"textures", R"({"source":9})", "materials", R"({"normalTexture":{"index":0}})", "textures[0].source is 9"},
        {"images", R"({"uri":"missing.png"})", "textures", R"({"source":0})", "image 0"},
        {"accessors", R"({"bufferView":55,"componentType":5126,"count":4,"type":"VEC3"})", "meshes",
         R"({"primitives":[{"attributes":{"POSITION":2}}]})", "bufferView is 55"},
        {"accessors", R"({"bufferView":0,"componentType":5126,"count":400,"type":"VEC3"})", "meshes",
         R"({"primitives":[{"attributes":{"POSITION":2}}]})", "primitive 0"},
        {"accessors", R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC9"})", "meshes",
         R"({"primitives":[{"attributes":{"POSITION":2}}]})", "type"},
        {"skins", R"({"joints":[99]})", "nodes", R"({"skin":0})", "joints[0] is 99"},
        {"nodes", R"({"mesh":77})", "scenes", R"({"nodes":[0,1]})", "nodes[1].mesh is 77"},
        {"buffers", R"({"byteLength":4,"uri":"missing.bin"})", "bufferViews", R"({"buffer":1})", "buffer 1"},
    };
    for (const Case& broken : cases) {
        GltfBuilder file;
        file.add_square();
        file.file["materials"] = {json::object()};
        file.file["meshes"][0]["primitives"][0]["material"] = 0;
        file.glb(); // adds the buffer
        const bool used_by_texture = std::string_view(broken.user) == "textures";
        file.file[broken.section].push_back(json::parse(broken.element));
        World unused;
        const auto report = unused.import(file.glb());
        ASSERT_TRUE(report) << broken.element << ": " << report.error().message;
        EXPECT_EQ(unused.mesh_of("square").triangle_count(), 2u);
        const auto tells = [&](const std::string& note) {
            return note.find(broken.named) != std::string::npos && note.find("nothing uses it") != std::string::npos;
        };
        // An accessor that is too long is only found out by who reads it.
        const bool readable = std::string_view(broken.named) == "primitive 0";
        EXPECT_EQ(std::any_of(report->notes.begin(), report->notes.end(), tells), !readable) << broken.element;
        if (used_by_texture) {
            file.file["textures"] = {json::object()};
            file.file["materials"][0]["normalTexture"] = {{"index", 0}};
        }
        file.file[broken.user][0].merge_patch(json::parse(broken.use));
        const auto refused = World().import(file.glb());
        ASSERT_FALSE(refused) << broken.element;
        EXPECT_NE(refused.error().message.find(broken.named), std::string::npos) << refused.error().message;
    }
}

} // namespace
} // namespace sunfleck
