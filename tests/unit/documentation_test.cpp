// Documentation that can be checked: the generated reference is up to date, and what pages name exists.
#include "engine/core/file.h"
#include "gi_module/settings_reference.h"
#include "gi_module/technique.h"
#include "test_places.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

namespace sunfleck::gi {
namespace {

namespace fs = std::filesystem;
const fs::path root = SUNFLECK_SOURCE_DIR;

std::string text_of(const fs::path& path) {
    const Result<std::string> text = read_file(path);
    EXPECT_TRUE(text) << path;
    return text ? *text : std::string();
}

// A build without one of the techniques has a shorter reference, and not its files.
bool has_all_techniques() {
    const std::string page = text_of(root / "docs/settings.md");
    const std::size_t section = page.find("\n## Techniques\n");
    const std::string list = page.substr(section, page.find("\n## ", section + 1) - section);
    std::size_t rows = 0;
    for (std::size_t at = list.find("\n| `"); at != std::string::npos; at = list.find("\n| `", at + 1))
        ++rows;
    return rows <= techniques().size();
}

TEST(Documentation, SettingsReferenceIsUpToDate) {
    if (!has_all_techniques())
        GTEST_SKIP() << "this build leaves out a technique that docs/settings.md lists";
    EXPECT_EQ(text_of(root / "docs/settings.md"), settings_reference())
        << "run: sunfleck info --reference > docs/settings.md";
}

std::vector<fs::path> pages() {
    std::vector<fs::path> result;
    for (fs::recursive_directory_iterator it(root), end; it != end; ++it) {
        const std::string name = it->path().filename();
        if (it->is_directory() && (name == "build" || name[0] == '.'))
            it.disable_recursion_pending();
        else if (it->path().extension() == ".md" && name != "CHANGELOG.md")
            result.push_back(it->path());
    }
    return result;
}

// The last part of `System::update` is what a source spells out in every place.
bool mentions(const std::string& source, const std::string& function) {
    const std::size_t scope = function.rfind("::");
    return source.find(scope == std::string::npos ? function : function.substr(scope + 2)) != std::string::npos;
}

fs::path find_file(const std::string& name, const fs::path& page) {
    for (const fs::path& folder : {root, page.parent_path(), root / "gi_module/include"})
        if (fs::exists(folder / name))
            return folder / name;
    return {};
}

// `folder/file.ext` must exist, seen from the root, from the page's folder or as a host includes it; in
// `file.cpp:System::update`, so must the function.
TEST(Documentation, WhatPagesNameExists) {
    const std::regex reference("`([a-z_]+/[a-z_0-9/]+\\.(?:h|cpp|comp|vert|frag|glsl|cmake|md))(?::([A-Za-z_:]+))?`");
    const bool complete = has_all_techniques();
    std::size_t named = 0;
    for (const fs::path& page : pages()) {
        const std::string text = text_of(page);
        for (std::sregex_iterator it(text.begin(), text.end(), reference), end; it != end; ++it) {
            const std::string path = (*it)[1], function = (*it)[2];
            const fs::path file = find_file(path, page);
            ++named;
            if (file.empty()) {
                EXPECT_TRUE(!complete && std::regex_search(path, std::regex("^gi_module/|techniques/")))
                    << page << " names " << path;
                continue;
            }
            EXPECT_TRUE(mentions(text_of(file), function)) << page << " names " << function << " in " << path;
        }
    }
    EXPECT_GT(named, 50u);
}

// `name=value` and `--set name=value` must be what Settings::set takes.
TEST(Documentation, SettingsThatPagesNameExist) {
    const std::regex assignment("(?:`|--set\\s+)([a-z][a-z0-9_]*)=([^\\s`]+)");
    const bool complete = has_all_techniques();
    std::size_t named = 0;
    for (const fs::path& page : pages()) {
        const std::string text = text_of(page);
        for (std::sregex_iterator it(text.begin(), text.end(), assignment), end; it != end; ++it) {
            const std::string name = (*it)[1], value = (*it)[2];
            ++named;
            if (value == "..." || value == "value" || !complete)
                continue;
            const Status status = Settings().set(name, value);
            EXPECT_TRUE(status) << page << ": " << (status ? "" : status.error().message);
        }
    }
    EXPECT_GT(named, 5u);
}

std::set<std::string, std::less<>> declared_names() {
    std::set<std::string, std::less<>> names;
    const Settings defaults;
    for (const Settings::ConstPart& part : defaults.parts()) {
        names.emplace(part.type->name);
        for (const Field& field : part.type->fields) {
            names.emplace(field.name);
            names.insert(field.choices.begin(), field.choices.end());
        }
    }
    for (const Counter* counter : all_counters())
        names.emplace(counter->name);
    for (const DebugView* view : debug_views())
        names.emplace(view->name);
    return names;
}

// A technique's page ends with its settings, counters and views.
TEST(Documentation, PagesOfTechniquesNameWhatIsDeclared) {
    if (!has_all_techniques())
        GTEST_SKIP() << "this build leaves out a technique, whose names other pages may mention";
    const auto names = declared_names();
    const std::regex word("`([A-Za-z][A-Za-z0-9_]*)`");
    for (const TechniqueEntry& technique : techniques()) {
        const fs::path page = root / "docs/techniques" / (std::string(technique.name) + ".md");
        ASSERT_TRUE(fs::exists(page)) << "every technique has a page: " << page;
        const std::string text = text_of(page);
        const std::size_t section = text.find("\n## Settings, counters, views\n");
        ASSERT_NE(section, std::string::npos) << page;
        const std::string list = text.substr(section);
        for (std::sregex_iterator it(list.begin(), list.end(), word), end; it != end; ++it)
            EXPECT_EQ(names.count((*it)[1].str()), 1u) << page << " names " << (*it)[1];
    }
}

} // namespace
} // namespace sunfleck::gi
