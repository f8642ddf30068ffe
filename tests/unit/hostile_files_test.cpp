// Damaged and hostile glTF files: one message that names the cause, soon, with little memory, and nothing half-loaded.
#include "engine/core/memory_limit.h"
#include "engine/core/random.h"
#include "engine/io/image.h"
#include "test_places.h"
#include "tests/support/mutated_files.h"
#include "tests/support/test_size.h"

#include <chrono>
#include <sys/resource.h>
#include <sys/stat.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using tests::GltfBuilder;
using tests::World;

// The import fails, says why in one line, takes no long time and leaves nothing behind.
std::string refused(const std::string& bytes) {
    World world;
    const auto start = std::chrono::steady_clock::now();
    const auto report = world.import(bytes);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_LT(seconds.count(), 5.0);
    EXPECT_FALSE(report);
    EXPECT_EQ(world.registry.entity_count(), 0u);
    EXPECT_EQ(world.meshes.size(), 0u);
    EXPECT_EQ(world.textures.size(), 0u);
    if (report)
        return "accepted";
    EXPECT_EQ(report.error().message.find('\n'), std::string::npos) << report.error().message;
    EXPECT_LT(report.error().message.size(), 400u);
    return report.error().message;
}

GltfBuilder good() {
    GltfBuilder file;
    file.add_square();
    return file;
}

void expect_refused(const GltfBuilder& file, const std::string& cause) {
    GltfBuilder copy = file;
    EXPECT_NE(refused(copy.glb()).find(cause), std::string::npos) << refused(copy.glb()) << " should name: " << cause;
}

TEST(HostileFiles, GoodFileIsGood) {
    EXPECT_TRUE(World().import(good().glb()));
}

TEST(HostileFiles, EveryPrefixOfAFile) {
    const std::string bytes = good().glb();
    for (std::size_t length = 0; length + 1 < bytes.size(); length += 7)
        refused(bytes.substr(0, length));
}

TEST(HostileFiles, DeepJson) {
    for (const std::string& open : {std::string("["), std::string("{\"a\":")}) {
        std::string text;
        for (int i = 0; i < 200000; ++i)
            text += open;
        EXPECT_NE(refused(text).find("nested"), std::string::npos);
    }
}

TEST(HostileFiles, ReferencesOutOfRange) {
    const auto with = [](const std::function<void(json&)>& change) {
        GltfBuilder file = good();
        change(file.file);
        return file;
    };
    expect_refused(with([](json& f) { f["accessors"][0]["bufferView"] = 9; }), "accessors[0].bufferView");
    expect_refused(with([](json& f) { f["bufferViews"][0]["buffer"] = 1; }), "bufferViews[0].buffer");
    expect_refused(with([](json& f) { f["meshes"][0]["primitives"][0]["indices"] = -2; }), "indices");
    expect_refused(with([](json& f) { f["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 77; }), "POSITION");
    expect_refused(with([](json& f) { f["nodes"][0]["mesh"] = 1; }), "nodes[0].mesh");
    expect_refused(with([](json& f) { f["nodes"][0]["children"] = {0}; }), "node 0");
    expect_refused(with([](json& f) { f["scenes"][0]["nodes"] = {3}; }), "scenes[0].nodes[0]");
    expect_refused(with([](json& f) { f["scene"] = 5; }), "default scene");
    expect_refused(with([](json& f) { f["bufferViews"][0]["byteLength"] = 1000000; }), "outside its buffer");
    expect_refused(with([](json& f) { f["bufferViews"][0]["byteLength"] = 40; }), "outside its buffer view");
    expect_refused(with([](json& f) { f["bufferViews"][1]["byteLength"] = 0; }), "buffer view 1");
    expect_refused(with([](json& f) { f["accessors"][1]["byteOffset"] = 1; }), "not aligned");
}

TEST(HostileFiles, CountsTypesAndVersions) {
    const auto with = [](const std::function<void(json&)>& change) {
        GltfBuilder file = good();
        change(file.file);
        return file;
    };
    expect_refused(with([](json& f) { f["accessors"][0]["count"] = std::int64_t(1) << 62; }), "elements");
    expect_refused(with([](json& f) { f["accessors"][0]["count"] = 0; }), "elements");
    expect_refused(with([](json& f) { f["accessors"][0]["count"] = "many"; }), "number");
    expect_refused(with([](json& f) { f["accessors"][0]["type"] = "VEC9"; }), "");
    expect_refused(with([](json& f) { f["accessors"][0]["type"] = "VEC2"; }), "type");
    expect_refused(with([](json& f) { f["accessors"][0]["componentType"] = 5124; }), "");
    expect_refused(with([](json& f) { f["accessors"][1]["componentType"] = 5126; }), "type");
    expect_refused(with([](json& f) { f["nodes"] = 7; }), "nodes");
    expect_refused(with([](json& f) { f["nodes"] = {1, 2}; }), "nodes");
    expect_refused(with([](json& f) { f["nodes"][0]["rotation"] = {0, 0, 0, 0}; }), "rotation");
    expect_refused(with([](json& f) { f["nodes"][0]["scale"] = {1e39, 1, 1}; }), "not finite");
    expect_refused(with([](json& f) { f["nodes"][0]["translation"] = {"a", 1, 1}; }), "list of numbers");
    expect_refused(with([](json& f) { f["asset"]["version"] = "1.0"; }), "glTF 1.0");
    expect_refused(with([](json& f) { f.erase("asset"); }), "version");
    expect_refused(with([](json& f) { f["extensionsRequired"] = {"VENDOR_secret"}; }), "VENDOR_secret");
    expect_refused(with([](json& f) { f["meshes"][0]["primitives"][0]["mode"] = 9; }), "mode");
}

TEST(HostileFiles, NumbersThatAreNotFinite) {
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        GltfBuilder file = good();
        std::memcpy(file.binary.data() + 8, &value, sizeof value);
        expect_refused(file, "not finite");
    }
    GltfBuilder file = good();
    const std::uint16_t index = 9;
    std::memcpy(file.binary.data() + 48, &index, sizeof index);
    expect_refused(file, "index 9");
}

TEST(HostileFiles, ZeroScalesAreNothingToSee) {
    GltfBuilder file = good();
    file.file["nodes"][0]["scale"] = {0, 0, 0};
    World world;
    EXPECT_TRUE(world.import(file.glb())); // valid, by the specification
}

TEST(HostileFiles, CyclesOfNodes) {
    GltfBuilder file = good();
    file.file["nodes"] = json::array({{{"children", {1}}}, {{"children", {2}}}, {{"children", {1}}}});
    expect_refused(file, "two parents");
    file.file["nodes"] = json::array({{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}});
    expect_refused(file, "cycle");
    json chain = json::array();
    for (int i = 0; i < 1000; ++i)
        chain.push_back({{"children", {i + 1}}});
    chain.push_back({{"mesh", 0}});
    file.file["nodes"] = chain;
    expect_refused(file, "nested");
}

TEST(HostileFiles, Images) {
    const auto with_image = [](const std::string& bytes) {
        GltfBuilder file = good();
        if (bytes.empty())
            file.file["images"] = {{{"uri", "data:image/png;base64,"}}};
        else
            file.file["images"] = {{{"bufferView", file.view(bytes.data(), bytes.size())}}};
        file.file["textures"] = {{{"source", 0}}};
        file.file["materials"] = {{{"normalTexture", {{"index", 0}}}}};
        file.primitive()["material"] = 0;
        return file;
    };
    const std::string png = io::encode_png(2, 1, {1, 2, 3, 4, 5, 6, 7, 8}).value();
    EXPECT_TRUE(World().import(with_image(png).glb()));
    expect_refused(with_image(""), "image 0");
    expect_refused(with_image("BM not one of ours"), "image 0");
    expect_refused(with_image(png.substr(0, 30)), "image 0");
    expect_refused(with_image(png.substr(0, png.size() - 20)), "image 0");
    std::string huge = png; // claims 100,000 x 100,000
    const unsigned char side[4] = {0, 1, 0x86, 0xa0};
    std::memcpy(huge.data() + 16, side, 4);
    std::memcpy(huge.data() + 20, side, 4);
    expect_refused(with_image(huge), "image 0");
    expect_refused(with_image("\xff\xd8\xff\xe0 not a JPEG"), "image 0");
    expect_refused(with_image("#?RADIANCE\n\n-Y 100000 +X 100000\n"), "image 0");
    expect_refused(with_image(std::string("\x76\x2f\x31\x01\x02\0\0\0junk", 12)), "image 0");
}

TEST(HostileFiles, UrisThatAreNotFilesBesideTheFile) {
    const tests::Folder folder;
    fs::create_directories(folder.path / "inner" / "directory.bin");
    ASSERT_TRUE(write_file(folder.path / "secret.bin", std::string(64, 'x')));
    ASSERT_TRUE(write_file(folder.path / "inner" / "odd n\xc3\xa4me.bin", std::string(64, '\0')));
    ASSERT_EQ(mkfifo((folder.path / "inner" / "pipe.bin").c_str(), 0600), 0);
    fs::create_symlink("../secret.bin", folder.path / "inner" / "link.bin");
    const auto import = [&](const std::string& uri) {
        GltfBuilder file = good();
        file.file["buffers"] = {{{"byteLength", 60}, {"uri", uri}}};
        EXPECT_TRUE(write_file(folder.path / "inner" / "file.gltf", file.file.dump()));
        World world;
        const auto start = std::chrono::steady_clock::now();
        const auto report =
            io::import_gltf(folder.path / "inner" / "file.gltf", world.registry, world.meshes, world.textures);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        EXPECT_LT(seconds.count(), 5.0) << uri;
        return report ? std::string() : report.error().message;
    };
    EXPECT_EQ(import("odd%20n%C3%A4me.bin"), "");
    EXPECT_EQ(import("./odd n\xc3\xa4me.bin"), "");
    for (const std::string& uri :
         std::vector<std::string>{"../secret.bin", "%2e%2e/secret.bin", "link.bin", "/etc/passwd",
                                  "http://example.com/a.bin", "https://example.com/a.bin", "file:///etc/passwd",
                                  "directory.bin", "pipe.bin", "missing.bin", "", "%zz.bin", "a\x01\x02.bin",
                                  "data:application/octet-stream;base64,!!!!", "data:text/plain,hello", "/dev/zero"}) {
        const std::string message = import(uri);
        EXPECT_NE(message.find("file.gltf"), std::string::npos) << uri << ": " << message;
        EXPECT_NE(message.find("buffer 0"), std::string::npos) << uri << ": " << message;
    }
    World world;
    EXPECT_FALSE(io::import_gltf(folder.path, world.registry, world.meshes, world.textures)) << "a directory";
    EXPECT_FALSE(io::import_gltf(folder.path / "none.glb", world.registry, world.meshes, world.textures));
}

// --- The mutation fuzzer -------------------------------------------------------------------------------------------

// What a few bytes may claim is counted before it is taken.
TEST(HostileFiles, FewBytesTakeNoGigabytes) {
    GltfBuilder sparse = good();
    const std::uint16_t place = 0;
    const float value[3] = {1, 2, 3};
    const int places = sparse.view(&place, sizeof place), values = sparse.view(value, sizeof value);
    sparse.file["accessors"].push_back({{"componentType", 5126},
                                        {"count", 50'000'000},
                                        {"type", "VEC3"},
                                        {"sparse",
                                         {{"count", 1},
                                          {"indices", {{"bufferView", places}, {"componentType", 5123}}},
                                          {"values", {{"bufferView", values}}}}}});
    sparse.primitive()["attributes"]["POSITION"] = sparse.file["accessors"].size() - 1;

    GltfBuilder targets = good();
    targets.file["accessors"].push_back({{"componentType", 5126}, {"count", 1'000'000}, {"type", "VEC3"}});
    targets.primitive()["attributes"]["POSITION"] = targets.file["accessors"].size() - 1;
    for (int i = 0; i < 300; ++i)
        targets.primitive()["targets"].push_back(json::object());

    const std::uint64_t room = std::uint64_t(256) << 20;
    for (GltfBuilder* file : {&sparse, &targets}) {
        World world;
        const std::uint64_t before = memory_in_use();
        set_memory_limit(before + room);
        const auto report = world.import(file->glb());
        if (!tests::sanitized()) { // whose own memory would count
            EXPECT_LT(memory_in_use(), before + room);
        }
        set_memory_limit(0);
        ASSERT_FALSE(report);
        EXPECT_EQ(report.error().code, ErrorCode::memory) << report.error().message;
        EXPECT_NE(report.error().message.find("the level's detail"), std::string::npos) << report.error().message;
    }
}

// Each of `count` primitives has a material with a picture of its own.
void use_images(GltfBuilder& file, std::size_t count) {
    const json primitive = file.primitive();
    for (std::size_t i = 0; i < count; ++i) {
        file.file["textures"].push_back({{"source", i}});
        file.file["materials"].push_back({{"emissiveTexture", {{"index", i}}}});
        file.file["meshes"][0]["primitives"].push_back(primitive);
        file.file["meshes"][0]["primitives"].back()["material"] = i;
    }
}

// Views that overlap, and files that are named again and again, are counted each time.
TEST(HostileFiles, SharedBytesTakeNoGigabytes) {
    constexpr std::size_t size = 2u << 20, step = 1000, count = 400;
    const std::string noise(size + step * count, 'x');
    GltfBuilder views = good(), images = good(), buffers = good();
    const json base = views.file["bufferViews"][std::size_t(views.view(noise.data(), noise.size()))];
    const std::size_t begin = base["byteOffset"].get<std::size_t>();
    for (std::size_t i = 0; i < count; ++i) {
        views.file["images"].push_back({{"bufferView", views.file["bufferViews"].size()}});
        views.file["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin + i * step}, {"byteLength", size}});
        images.file["images"].push_back({{"uri", "shared.bin"}});
        buffers.file["buffers"].push_back({{"byteLength", size}, {"uri", "shared.bin"}});
        buffers.file["bufferViews"].push_back({{"buffer", i}, {"byteLength", 48}});
        buffers.file["accessors"].push_back({{"bufferView", buffers.file["bufferViews"].size() - 1},
                                             {"componentType", 5126},
                                             {"count", 4},
                                             {"type", "VEC3"}});
        buffers.file["meshes"][0]["primitives"].push_back(
            {{"attributes", {{"POSITION", buffers.file["accessors"].size() - 1}}}});
    }
    use_images(views, count);
    use_images(images, count);
    const tests::Folder folder;
    ASSERT_TRUE(write_file(folder.path / "shared.bin", noise));
    for (GltfBuilder* file : {&views, &images, &buffers}) {
        const std::string bytes = file == &buffers ? file->file.dump() : file->glb();
        ASSERT_TRUE(write_file(folder.path / "file.gltf", bytes));
        World world;
        set_memory_limit(memory_in_use() + (std::uint64_t(256) << 20));
        const auto report = io::import_gltf(folder.path / "file.gltf", world.registry, world.meshes, world.textures);
        set_memory_limit(0);
        ASSERT_FALSE(report);
        EXPECT_EQ(report.error().code, ErrorCode::memory) << report.error().message;
    }
}

// 200 kB of zeros, which no compressed data of so many elements is.
TEST(HostileFiles, CompressedViewsClaimNoMoreThanTheirBytesHold) {
    GltfBuilder file = good();
    const std::string zeros(200'000, '\0');
    const int source = file.view(zeros.data(), zeros.size());
    const json view = file.file["bufferViews"][std::size_t(source)];
    file.file["bufferViews"].push_back({{"buffer", 0},
                                        {"byteLength", 4},
                                        {"extensions",
                                         {{"EXT_meshopt_compression",
                                           {{"buffer", 0},
                                            {"byteOffset", view["byteOffset"]},
                                            {"byteLength", zeros.size()},
                                            {"byteStride", 256},
                                            {"count", 51'000'000},
                                            {"mode", "ATTRIBUTES"}}}}}});
    file.file["accessors"].push_back(
        {{"bufferView", file.file["bufferViews"].size() - 1}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
    file.primitive()["attributes"]["POSITION"] = file.file["accessors"].size() - 1;
    file.file["extensionsUsed"] = {"EXT_meshopt_compression"};
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    expect_refused(file, "EXT_meshopt_compression");
    ::getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 512 * 1024) << "KiB";
}

TEST(HostileFiles, TwoThousandMutations) {
    std::vector<std::string> files = tests::sample_files();
    files.push_back(good().file.dump());
    int accepted = 0, rejected = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const std::string bytes = tests::mutated(files[i % files.size()], i);
        World world;
        const auto start = std::chrono::steady_clock::now();
        const auto report = world.import(bytes);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        EXPECT_LT(seconds.count(), 5.0) << "case " << i;
        if (report) {
            ++accepted;
            tests::expect_sound(world, "case " + std::to_string(i));
        } else {
            ++rejected;
            EXPECT_EQ(world.registry.entity_count(), 0u) << "case " << i;
            EXPECT_FALSE(report.error().message.empty());
        }
    }
    EXPECT_GT(accepted, 20) << "mutations that all fail early test little";
    EXPECT_GT(rejected, 500);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%d accepted, %d rejected, %ld MB at most\n", accepted, rejected, usage.ru_maxrss / 1024);
}

} // namespace
} // namespace sunfleck
