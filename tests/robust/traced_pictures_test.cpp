// Small pictures of the path tracer, stored with the method that made them: a state of hours that another method began
// must not be gone on with, so that whoever changes what is traced has to raise reference_method.
//
// SUNFLECK_STORE_TRACED=1 stores them anew, which is refused while the method's number is that of other pictures.
#include "editor/command_line/commands.h"
#include "editor/command_line/program.h"
#include "engine/io/image.h"
#include "test_places.h"
#include "tests/support/gltf_files.h"

#include <cmath>
#include <cstdlib>

namespace sunfleck::tests {
namespace {

namespace fs = std::filesystem;

const fs::path stored_file = fs::path(SUNFLECK_SOURCE_DIR) / "tests/images/traced.json";
constexpr std::size_t most_others = 6; // values of 288 of whose paths rounding on another machine may decide
constexpr float tolerance = 2e-3f;     // relative

// A scene of the test's own, so that built-in scenes can change: planks, bricks, metal, glass, a sky that is made by
// code, a lamp and a spot.
void write_scene(const tests::Folder& folder) {
    tests::GltfBuilder gltf;
    gltf.add_square();
    json& file = gltf.file;
    file["extensionsUsed"] = {"KHR_materials_transmission"};
    file["materials"] = {
        {{"name", "wood"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.6, 0.4, 0.2, 1}}, {"metallicFactor", 0}}}},
        {{"name", "metal"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.9, 0.7, 0.4, 1}}, {"metallicFactor", 1}, {"roughnessFactor", 0.3}}}},
        {{"name", "glass"},
         {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
         {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.9}}}}}}};
    const auto add_mesh = [&](int material) {
        json mesh = file["meshes"][0];
        mesh["primitives"][0]["material"] = material;
        file["meshes"].push_back(mesh);
        return int(file["meshes"].size()) - 1;
    };
    const int wood = add_mesh(0), metal = add_mesh(1), glass = add_mesh(2);
    const double half = std::sqrt(0.5);
    file["nodes"] = {{{"name", "floor"},
                      {"mesh", wood},
                      {"rotation", {-half, 0, 0, half}},
                      {"scale", {4, 4, 4}},
                      {"translation", {-2, 0, 2}}},
                     {{"name", "wall"}, {"mesh", wood}, {"scale", {4, 1.2, 1}}, {"translation", {-2, 0, -2}}},
                     {{"name", "mirror"}, {"mesh", metal}, {"translation", {-1.2, 0, -1}}},
                     {{"name", "pane"}, {"mesh", glass}, {"translation", {0.2, 0, -0.5}}},
                     {{"name", "lamp"}, {"rotation", {-half, 0, 0, half}}, {"translation", {0, 2, -1}}},
                     {{"name", "spot"}, {"rotation", {-half, 0, 0, half}}, {"translation", {1, 2, 0}}}};
    file["scenes"][0]["nodes"] = {0, 1, 2, 3, 4, 5};
    ASSERT_TRUE(write_file(folder / "room.glb", gltf.glb()));
    const json scene = {
        {"sunfleck_scene", 2},
        {"gltf", "room.glb"},
        {"entities",
         {{"floor", {{"SurfacePattern", {{"kind", "planks"}, {"scale", 0.3}, {"colour", {0.2, 0.1, 0.05}}}}}},
          {"wall", {{"SurfacePattern", {{"kind", "bricks"}, {"scale", 0.2}, {"colour", {0.3, 0.3, 0.3}}}}}},
          {"lamp", {{"AreaLight", {{"width", 0.5}, {"height", 0.5}, {"radiance", {9, 8, 7}}}}}},
          {"spot", {{"SpotLight", {{"intensity", {5, 5, 6}}, {"inner_angle", 0.3}, {"outer_angle", 0.6}}}}},
          {"sky", {{"Environment", {{"radiance", {0.5, 0.5, 0.5}}}}, {"EnvironmentMap", {{"file", "summer_sky"}}}}}}}};
    ASSERT_TRUE(write_file(folder / "room.scene.json", scene.dump()));
}

std::vector<float> trace(const tests::Folder& folder, const std::vector<std::string>& options) {
    const std::string output = folder / "p.exr", scene = folder / "room.scene.json";
    std::vector<const char*> words = {
        "sunfleck", "reference", scene.c_str(), "-o",       output.c_str(),           "--size",
        "8x6",      "--spp",     "4",           "--camera", "0.4,1.1,2.6,0,0.6,-1,55"};
    for (const std::string& option : options)
        words.push_back(option.c_str());
    EXPECT_EQ(command_line::run_program(int(words.size()), words.data()), 0);
    std::vector<float> values;
    const auto picture = io::read_picture(output);
    EXPECT_TRUE(picture);
    for (const vec4& pixel : picture ? picture->pixels : std::vector<vec4>())
        values.insert(values.end(), {pixel.x, pixel.y, pixel.z});
    return values;
}

bool is_alike(const std::vector<float>& now, const std::vector<float>& before) {
    if (now.size() != before.size())
        return false;
    std::size_t others = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
        others += std::abs(now[i] - before[i]) > tolerance * std::max(std::abs(before[i]), 0.01f) ? 1 : 0;
    std::printf("%zu of %zu values differ\n", others, now.size());
    return others <= most_others;
}

void store(const std::vector<float>& now) {
    json values = json::array();
    for (const float value : now) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.6g", double(value));
        values.push_back(std::atof(digits));
    }
    ASSERT_TRUE(
        write_file(stored_file, json{{"method", command_line::reference_method}, {"values", values}}.dump() + "\n"));
}

TEST(RobustReferenceMethod, IsRaisedWithWhateverChangesPictures) {
    const tests::Folder folder("sunfleck_traced");
    write_scene(folder);
    std::vector<float> now = trace(folder, {"--antialiasing"});
    const std::vector<float> sharp = trace(folder, {"--unlimited", "--caustics", "off"});
    now.insert(now.end(), sharp.begin(), sharp.end());
    const auto text = read_file(stored_file);
    const json stored = text ? json::parse(*text) : json{{"method", 0}, {"values", json::array()}};
    const bool alike = is_alike(now, stored["values"].get<std::vector<float>>());
    const bool raised = command_line::reference_method > stored["method"].get<int>();
    if (std::getenv("SUNFLECK_STORE_TRACED") != nullptr && (alike || raised))
        return store(now);
    EXPECT_TRUE(alike) << "the path tracer's pictures have changed: raise reference_method in "
                          "editor/command_line/commands.h, then store them (SUNFLECK_STORE_TRACED=1)";
    EXPECT_FALSE(raised) << "the pictures of this method are not stored yet (SUNFLECK_STORE_TRACED=1)";
}

} // namespace
} // namespace sunfleck::tests
