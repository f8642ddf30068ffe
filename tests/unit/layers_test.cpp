// Reads every include of the project and checks that arrows point one way (the layers of the README).
#include "test_places.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

namespace {

namespace fs = std::filesystem;
using Layers = std::map<std::string, std::set<std::string>>;

// What each folder may include besides itself.
const Layers& allowed() {
    static const std::set<std::string> foundation = {"engine/core", "engine/ecs", "engine/gpu", "engine/scene",
                                                     "engine/raytrace"};
    static const auto with = [](std::set<std::string> base, std::set<std::string> more) {
        base.insert(more.begin(), more.end());
        return base;
    };
    static const Layers layers = {
        {"engine/core", {}},
        {"engine/ecs", {"engine/core"}},
        {"engine/statistics", {"engine/core"}},
        {"engine/gpu", {"engine/core"}},
        {"engine/shader_compiler", {"engine/core"}},
        {"engine/scene", {"engine/core", "engine/ecs", "engine/gpu"}},
        {"engine/raytrace", {"engine/core", "engine/ecs", "engine/scene"}},
        {"engine/io", {"engine/core", "engine/ecs", "engine/scene"}},
        {"engine/simulation", {"engine/core", "engine/ecs", "engine/scene", "engine/raytrace"}},
        {"engine/render", {"engine/core", "engine/ecs", "engine/gpu", "engine/scene"}},
        {"engine/app", {"engine/core", "engine/gpu"}},
        {"gi_module/transport", foundation},
        {"gi_module/g_buffer", with(foundation, {"gi_module/transport"})},
        {"gi_module/light_sampling", with(foundation, {"gi_module/transport"})},
        {"gi_module/visibility", with(foundation, {"gi_module/transport"})},
        {"gi_module/shadows",
         with(foundation, {"gi_module/transport", "gi_module/light_sampling", "gi_module/visibility"})},
        {"gi_module/low_resolution", with(foundation, {"gi_module/transport"})},
        {"gi_module/charts", with(foundation, {"gi_module/transport", "gi_module/visibility"})},
        {"gi_module/harmonics", foundation},
        {"gi_module/light_sum", with(foundation, {"gi_module/transport"})},
        {"gi_module/light_sensors", with(foundation, {"gi_module/transport", "gi_module/light_sampling"})},
        {"gi_module/inspection",
         with(foundation, {"gi_module/transport", "gi_module/light_sampling", "gi_module/visibility"})},
        {"gi_module/reference", with(foundation, {"gi_module/transport", "gi_module/light_sampling"})},
        {"gi_module/include/sunfleck", {"engine/core"}}, // what a foreign host sees
        {"gi_module", with(foundation, {"sunfleck", "gi_module/transport", "gi_module/light_sampling",
                                        "gi_module/shadows", "gi_module/visibility", "gi_module/low_resolution",
                                        "gi_module/light_sum", "gi_module/g_buffer", "gi_module/charts",
                                        "gi_module/harmonics", "gi_module/light_sensors", "gi_module/inspection"})},
    };
    return layers;
}

// A technique is a folder with a technique.cmake: it uses what techniques share and no other technique.
bool is_technique(const std::string& folder) {
    return fs::exists(fs::path(SUNFLECK_SOURCE_DIR) / folder / "technique.cmake");
}

std::set<std::string> allowed_for(const std::string& folder) {
    if (!is_technique(folder))
        return allowed().at(folder);
    std::set<std::string> rooms = allowed().at("gi_module");
    rooms.insert("gi_module");
    return rooms;
}

std::string folder_of(const std::string& path) {
    const std::size_t end = path.rfind('/');
    return end == std::string::npos ? "" : path.substr(0, end);
}

TEST(Layers, IncludesPointDownOnly) {
    const fs::path root = SUNFLECK_SOURCE_DIR;
    const std::regex include("^\\s*#include \"([^\"]+)\"");
    int read = 0;
    for (const char* top : {"engine", "gi_module"})
        for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
            static const std::set<std::string> extensions = {".h", ".cpp", ".comp", ".vert", ".frag", ".glsl"};
            if (!entry.is_regular_file() || !extensions.count(entry.path().extension()))
                continue;
            const std::string file = fs::relative(entry.path(), root);
            const std::string folder = folder_of(file);
            ASSERT_TRUE(allowed().count(folder) || is_technique(folder)) << file << " lies in a folder without a layer";
            std::ifstream stream(entry.path());
            for (std::string line; std::getline(stream, line);) {
                std::smatch match;
                if (!std::regex_search(line, match, include))
                    continue;
                ++read;
                const std::string target = folder_of(match[1]);
                EXPECT_TRUE(target == folder || allowed_for(folder).count(target))
                    << file << " must not include " << match[1];
                // Of gi_module itself techniques may use what they are, never the system.
                if (folder != "gi_module" && target == "gi_module") {
                    EXPECT_TRUE(match[1] == "gi_module/technique.h" || match[1] == "gi_module/settings.h") << file;
                }
            }
        }
    EXPECT_GT(read, 100);
}

TEST(Layers, TheModuleUsesNoWindowImageOrGuiLibrary) {
    const fs::path root = SUNFLECK_SOURCE_DIR;
    const std::regex foreign("#include <(GLFW|OpenImageIO|imgui|tiny_gltf|nlohmann|CLI|spdlog|glslang)");
    for (const char* top : {"engine/core", "engine/ecs", "engine/statistics", "engine/gpu", "engine/scene",
                            "engine/raytrace", "gi_module"})
        for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
            if (!entry.is_regular_file())
                continue;
            std::ifstream stream(entry.path());
            for (std::string line; std::getline(stream, line);)
                EXPECT_FALSE(std::regex_search(line, foreign)) << entry.path() << ": " << line;
        }
}

} // namespace
