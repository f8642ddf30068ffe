// The editor and what else there is on a machine: no home, damaged settings, other editors at the same files, names of
// files that nobody would choose, a folder that is gone, scenes that reach outside of theirs.
#include "editor/window/editor.h"
#include "editor/window/opening.h"
#include "editor/window/program.h"
#include "editor/window/session.h"
#include "editor/window/state_file.h"
#include "tests/editor/window_fixture.h"
#include "tests/support/folder.h"
#include "tests/support/option_values.h"

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <sys/resource.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenDisplay;

tests::Verdict read_editor(const std::vector<std::string>& words, editor::Options& options) {
    std::vector<const char*> arguments = {"sunfleck_editor"};
    for (const std::string& word : words)
        arguments.push_back(word.c_str());
    std::ostringstream text;
    const auto status = editor::read_command_line(int(arguments.size()), arguments.data(), options, text, text);
    return {status.value_or(exit_done), text.str()};
}
tests::Verdict parse_editor(const std::vector<std::string>& words) {
    editor::Options options;
    return read_editor(words, options);
}

TEST(EditorOptions, EachHasAnEffect) {
    tests::expect_effects<editor::Options>(parse_editor, {}, [](const std::vector<std::string>& words) {
        editor::Options options;
        read_editor(words, options);
        return options;
    });
}

TEST(EditorOptions, TheParserTakesWhatHelpShowsAndNothingElse) {
    tests::OptionCounts counts;
    tests::try_options(parse_editor, {}, counts, [](const std::vector<std::string>& words) {
        editor::Options options;
        read_editor(words, options);
        return !(options == editor::Options());
    });
    tests::try_borders(parse_editor, {});
    EXPECT_GE(counts.options, 8u);
    EXPECT_GE(counts.ranges, 2u);
    counts.print();
}

TEST(EditorState, DamagedSettingsAreSetAside) {
    const tests::Folder folder("sunfleck_editor_state");
    const fs::path file = folder / "editor.json";
    std::string problem;
    bool may_save = false;
    for (const char* damaged : {"{\"width\": 8", "[]", "", "\xff\xfe"}) {
        ASSERT_TRUE(write_file(file, damaged));
        problem.clear();
        EXPECT_EQ(editor::load_state(file, problem, may_save).width, 0u);
        EXPECT_NE(problem.find("damaged"), std::string::npos) << problem;
        EXPECT_TRUE(may_save);
        EXPECT_FALSE(fs::exists(file)) << "else the next save would replace it";
        EXPECT_EQ(read_file(folder / "editor.json.damaged").value(), damaged);
    }
    ASSERT_TRUE(write_file(file, std::string(2u << 20, ' '))); // more than settings can be
    problem.clear();
    static_cast<void>(editor::load_state(file, problem, may_save));
    EXPECT_FALSE(may_save);
    EXPECT_FALSE(problem.empty());
    EXPECT_TRUE(fs::exists(file));
}

TEST(EditorState, NumbersOfAnySize) {
    const tests::Folder folder("sunfleck_editor_state");
    for (const std::string& value : tests::hostile_values()) {
        const nlohmann::json text = {{"width", 800}, {"layout", {{"left", 300}}}};
        std::string bytes = text.dump();
        for (const char* number : {"800", "300"})
            bytes.replace(bytes.find(number), 3, value);
        ASSERT_TRUE(write_file(folder / "editor.json", bytes));
        std::string problem;
        bool may_save = false;
        const editor::EditorState state = editor::load_state(folder / "editor.json", problem, may_save);
        EXPECT_LT(state.width, 1'000'000'000u) << value.substr(0, 40);
        EXPECT_TRUE(std::isfinite(state.layout.left)) << value.substr(0, 40);
    }
}

TEST(EditorState, WithoutAHomeNothingIsKept) {
    const tests::Folder folder("sunfleck_editor_state");
    ::setenv("XDG_CONFIG_HOME", "relative", 1);
    for (const char* home : {"relative", ""}) {
        ::setenv("HOME", home, 1);
        EXPECT_TRUE(editor::usual_state_file().empty());
    }
    ::unsetenv("HOME");
    EXPECT_TRUE(editor::usual_state_file().empty()) << "/tmp is anybody's";
    std::string problem;
    bool may_save = true;
    static_cast<void>(editor::load_state({}, problem, may_save));
    EXPECT_FALSE(may_save);
    EXPECT_NE(problem.find("HOME"), std::string::npos);
    const fs::path before = fs::current_path();
    fs::current_path(folder.path);
    const editor::Recovery recovery({});
    EXPECT_FALSE(recovery.problem().empty());
    EXPECT_TRUE(fs::is_empty(folder.path));
    fs::current_path(before);
}

TEST(EditorState, AFolderThatIsGoneHasNoFullNames) {
    const fs::path before = fs::current_path();
    {
        const tests::Folder folder("sunfleck_editor_gone");
        fs::current_path(folder.path);
        EXPECT_EQ(editor::full_name("a.glb"), (fs::current_path() / "a.glb").string());
        fs::remove_all(folder.path);
        EXPECT_EQ(editor::full_name("a.glb"), "a.glb");
    }
    fs::current_path(before);
}

TEST(EditorState, ALoadThatThrowsIsAnError) {
    const editor::Opening::Load load =
        [](const std::function<bool(float)>&) -> Result<std::unique_ptr<editor::Document>> { throw std::bad_alloc(); };
    editor::Opening opening("a.glb", load, [] {});
    ASSERT_TRUE(DrivenDisplay::wait_until([&] { return opening.finished(); }));
    const auto document = opening.take();
    ASSERT_FALSE(document);
    EXPECT_NE(document.error().message.find("out of memory"), std::string::npos);
}

TEST(EditorState, AJournalFollowsNoLinkAndSurvivesAFullDisk) {
    const tests::Folder folder("sunfleck_editor_journal");
    ASSERT_TRUE(write_file(folder / "mine", "work"));
    fs::create_symlink(folder / "mine", folder / "link");
    editor::JournalWriter linked;
    EXPECT_FALSE(linked.create(folder / "link"));
    EXPECT_EQ(read_file(folder / "mine").value(), "work");

    editor::JournalWriter writer;
    ASSERT_TRUE(writer.create(folder / "journal"));
    writer.start_over({}, 0);
    ASSERT_TRUE(writer.append(1, 1, "first"));
    const auto bytes = [&] { return read_file(folder / "journal").value(); };
    const std::string first = bytes();
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit none{RLIM_INFINITY, RLIM_INFINITY}, full{rlim_t(first.size() + 20), RLIM_INFINITY};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
    EXPECT_FALSE(writer.append(1, 2, "a part of which fits"));
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);
    EXPECT_EQ(bytes(), first) << "no half line is left, which the next would go on from";
    ASSERT_TRUE(writer.append(1, 3, "third"));
    const editor::Replayed read = editor::edits_of_journal(bytes(), editor::JournalBase{{}, 1, 0});
    EXPECT_EQ(read.names, std::vector<std::string>{"first"});
    EXPECT_FALSE(read.complete) << "an edit is missing, so that later ones are not made";
}

TEST(EditorState, ScenesReachOutsideOnlyWhereTheyMay) {
    const tests::Folder folder("sunfleck_editor_outside");
    fs::create_directories(folder / "in");
    fs::copy_file(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/cornell.glb", folder / "room.glb");
    ASSERT_TRUE(write_file(folder / "in/room.scene.json", R"({"sunfleck_scene":2,"gltf":"../room.glb"})"));
    EXPECT_FALSE(editor::Document::open(folder / "in/room.scene.json"));
    EXPECT_TRUE(editor::Document::open(folder / "in/room.scene.json", {}, true));
    for (const bool allowed : {false, true}) {
        editor::Opening opening(folder / "in/room.scene.json", allowed, [] {});
        ASSERT_TRUE(DrivenDisplay::wait_until([&] { return opening.finished(); }));
        EXPECT_EQ(bool(opening.take()), allowed);
    }
    editor::Options options;
    const char* words[] = {"sunfleck_editor", "--allow-outside", "--memory", "4000"};
    EXPECT_FALSE(editor::read_command_line(4, words, options, std::cout, std::cerr).has_value());
    EXPECT_TRUE(options.allow_outside);
    EXPECT_EQ(options.memory_mib, 4000u);
}

TEST(EditorDocuments, NamesOf255Bytes) {
    const tests::Folder folder("sunfleck_editor_long_names");
    const fs::path path = folder / std::string(244, 'n').append(".scene.json");
    editor::Document document;
    for (int times = 0; times < 2; ++times) {
        editor::add_from(document, scene::entity_templates().front(), vec3(1.0f), 0.5f);
        const Status saved = document.save(path);
        ASSERT_TRUE(saved) << saved.error().message;
        const auto opened = editor::Document::open(path);
        ASSERT_TRUE(opened) << opened.error().message;
        EXPECT_EQ((*opened)->entity_count(), document.entity_count());
    }
}

// In its window.
class EditorWindowNeighbours : public testing::Test {
protected:
    void SetUp() override {
        if (!DrivenDisplay::possible())
            GTEST_SKIP() << "Xvfb, xdotool and openbox are not installed";
        display.emplace(folder.path);
    }
    // Until its window is at rest.
    pid_t start(const std::string& environment, const std::vector<std::string>& arguments, const std::string& widgets) {
        std::vector<std::string> all = {"env"};
        std::istringstream words(environment);
        for (std::string word; words >> word;)
            all.push_back(word);
        all.insert(all.end(), {SUNFLECK_EDITOR, "--size", "800x600", "--widgets", widgets});
        all.insert(all.end(), arguments.begin(), arguments.end());
        const pid_t process = display->launch(all, folder / "log");
        EXPECT_TRUE(DrivenDisplay::wait_until([&] { return fs::exists(folder / widgets); }, 60.0))
            << read_file(folder / "log").value();
        return process;
    }
    std::string value(const std::string& widgets, const std::string& name) const {
        const auto text = read_file(folder / widgets);
        const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
        if (json.is_object())
            for (const auto& one : json["widgets"])
                if (one["name"] == name)
                    return one["value"];
        return "(not there)";
    }
    tests::Folder folder{"sunfleck_editor_neighbours"};
    std::optional<DrivenDisplay> display;
};

TEST_F(EditorWindowNeighbours, RunsWithoutAHomeAndKeepsNothing) {
    int number = 0;
    for (const char* environment : {"-u HOME -u XDG_CONFIG_HOME", "-u XDG_CONFIG_HOME HOME=relative",
                                    "-u XDG_CONFIG_HOME HOME=", "-u HOME XDG_CONFIG_HOME=relative"}) {
        const std::string widgets = "widgets" + std::to_string(++number) + ".json";
        const pid_t process = start(environment, {"cornell"}, widgets);
        EXPECT_TRUE(DrivenDisplay::wait_until([&] { return value(widgets, "menu/title") == "cornell.scene.json"; }))
            << environment;
        EXPECT_EQ(DrivenDisplay::end(process, SIGTERM), 128 + SIGTERM) << read_file(folder / "log").value();
        for (const char* name : {"relative", ".config"})
            EXPECT_FALSE(fs::exists(folder / name)) << environment;
    }
}

TEST_F(EditorWindowNeighbours, TwoEditorsShareTheirSettings) {
    const pid_t first = start("HOME=/nowhere", {"--settings", "both.json", "cornell"}, "widgets1.json");
    const pid_t second = start("HOME=/nowhere", {"--settings", "both.json", "furnace"}, "widgets2.json");
    const auto opened = [&](const char* widgets, const char* title) {
        return DrivenDisplay::wait_until([&] { return value(widgets, "menu/title") == title; });
    };
    EXPECT_TRUE(opened("widgets1.json", "cornell.scene.json"));
    EXPECT_TRUE(opened("widgets2.json", "furnace.scene.json"));
    ::kill(first, SIGTERM);
    EXPECT_EQ(DrivenDisplay::end(second, SIGTERM), 128 + SIGTERM);
    EXPECT_EQ(DrivenDisplay::end(first, 0), 128 + SIGTERM);
    std::string problem;
    bool may_save = false;
    const editor::EditorState state = editor::load_state(folder / "both.json", problem, may_save);
    EXPECT_EQ(problem, "");
    EXPECT_EQ(state.width, 800u);
    EXPECT_EQ(state.recent_files.size(), 2u) << "of both";
}

TEST_F(EditorWindowNeighbours, OddNamesOfFiles) {
    int number = 0;
    for (const std::string& name :
         {std::string("a b\nc"), std::string("\xff\xfe\x80"), std::string("$(x) '\"`;*"), std::string("255 bytes")}) {
        const auto called = [&](const std::string& ending) { // as long as names can be
            return (name == "255 bytes" ? std::string(255 - ending.size(), 'n') : name) + ending;
        };
        const fs::path scenes = fs::path(SUNFLECK_TOOL).parent_path() / "../scenes";
        fs::copy_file(scenes / "cornell.glb", folder / called(".glb"));
        const std::string widgets = "widgets" + std::to_string(++number) + ".json";
        const pid_t process = start(
            "HOME=/nowhere",
            {"--settings", called(".settings"), "--report", called(".report"), (folder / called(".glb")).string()},
            widgets);
        EXPECT_TRUE(DrivenDisplay::wait_until([&] {
            return value(widgets, "menu/title").find(".glb") != std::string::npos;
        })) << name;
        EXPECT_EQ(DrivenDisplay::end(process, SIGTERM), 128 + SIGTERM) << read_file(folder / "log").value();
        for (const char* ending : {".settings", ".report"})
            EXPECT_TRUE(nlohmann::json::accept(read_file(folder / called(ending)).value())) << name << ending;
        const std::string again = "widgets" + std::to_string(++number) + ".json";
        EXPECT_EQ(DrivenDisplay::end(start("HOME=/nowhere", {"--settings", called(".settings")}, again), SIGTERM),
                  128 + SIGTERM)
            << "the file that it opened is in the list of recent ones";
    }
}

} // namespace
} // namespace sunfleck
