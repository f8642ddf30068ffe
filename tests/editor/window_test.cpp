// What the editor's sources promise.
#include "engine/core/file.h"
#include "engine/scene/components.h"
#include "gi_module/technique.h"
#include "test_places.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

// Files of panels and of what they share: what they show comes from descriptions and registries.
TEST(EditorSources, PanelsNameNoComponentTechniqueOrSetting) {
    std::set<std::string> names;
    ecs::Registry registry;
    scene::register_components(registry);
    for (const ecs::PoolBase* pool : registry.described_pools())
        names.insert("scene::" + std::string(pool->description()->name));
    for (const gi::TechniqueEntry& technique : gi::techniques())
        names.insert("\"" + std::string(technique.name) + "\"");
    for (const std::string_view name : gi::Settings::names())
        names.insert("\"" + std::string(name) + "\"");
    for (const gi::DebugView* view : gi::debug_views())
        names.insert("\"" + std::string(view->name) + "\"");
    for (const gi::Counter* counter : gi::all_counters())
        names.insert("\"" + std::string(counter->name) + "\"");
    int files = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(SUNFLECK_SOURCE_DIR) / "editor/panels")) {
        const std::string text = read_file(entry.path()).value();
        ++files;
        for (const std::string& name : names) {
            const std::size_t found = text.find(name);
            const bool whole = found != std::string::npos && std::isalnum(text[found + name.size()]) == 0;
            EXPECT_FALSE(whole) << entry.path().filename() << " names " << name;
        }
    }
    EXPECT_GT(files, 10);
}

} // namespace
} // namespace sunfleck
