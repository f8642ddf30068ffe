// The demo and what else there is on a machine: another one at the same settings, names of files that nobody would
// choose, numbers of any size in its settings.
#include "engine/core/file.h"
#include "game_demo/demo_settings.h"
#include "test_places.h"
#include "tests/support/driven_display.h"
#include "tests/support/folder.h"
#include "tests/support/option_values.h"

#include <csignal>
#include <nlohmann/json.hpp>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenDisplay;

const std::vector<std::string>& names_of_outputs() {
    static const std::vector<std::string> names = {"a b\nc", "\xff\xfe\x80", "$(x) '\"`;*", std::string(240, 'n')};
    return names;
}

class RobustDemoNeighbours : public testing::Test {
protected:
    // Without a shell. Its exit status.
    int run(const std::vector<std::string>& options) const {
        std::vector<std::string> all = {SUNFLECK_DEMO, "--scene", "cornell"};
        all.insert(all.end(), options.begin(), options.end());
        const pid_t process = ::fork();
        if (process != 0)
            return DrivenDisplay::end(process, 0);
        std::vector<char*> pointers;
        pointers.reserve(all.size() + 1);
        for (std::string& word : all)
            pointers.push_back(word.data());
        pointers.push_back(nullptr);
        ::execv(pointers[0], pointers.data());
        ::_exit(127);
    }
    std::string content(const std::string& name) const {
        const auto text = read_file(folder / name);
        return text ? *text : "none";
    }
    tests::Folder folder{"sunfleck_demo_neighbours"};
};

TEST_F(RobustDemoNeighbours, OddNamesWithoutAWindow) {
    for (const std::string& name : names_of_outputs()) {
        const std::string record = folder / (name + ".rec"), output = folder / (name + ".out");
        const std::vector<std::string> headless = {"--headless", "--size", "16x16", "--pictures", "1", "--frames", "3"};
        std::vector<std::string> recorded = headless, played = headless;
        recorded.insert(recorded.end(), {"-o", output, "--record", record});
        played.insert(played.end(), {"-o", output, "--input", record});
        EXPECT_EQ(run(recorded), 0) << name;
        EXPECT_EQ(run(played), 0) << name;
        EXPECT_TRUE(fs::exists(fs::path(output) / "frame_00002.png")) << name;
        EXPECT_TRUE(nlohmann::json::accept(content(name + ".out/stats.json"))) << name;
    }
}

// In its window.
class RobustDemoWindow : public RobustDemoNeighbours {
protected:
    void SetUp() override {
        if (!DrivenDisplay::possible())
            GTEST_SKIP() << "Xvfb, xdotool and openbox are not installed";
        display.emplace(folder / "display");
    }
    // Until it shows the title.
    pid_t start(const std::string& settings, const std::string& state, const std::vector<std::string>& options = {}) {
        std::vector<std::string> all = {"env",
                                        "XDG_DATA_HOME=" + folder.path.string(),
                                        "ALSOFT_DRIVERS=null",
                                        SUNFLECK_DEMO,
                                        "--scene",
                                        "cornell",
                                        "--size",
                                        "96x54",
                                        "--settings",
                                        folder / settings,
                                        "--state",
                                        folder / state};
        all.insert(all.end(), options.begin(), options.end());
        const pid_t process = display->launch(all, folder / "log");
        EXPECT_TRUE(DrivenDisplay::wait_until([&] { return screen(state) == "title"; }, 90.0)) << content("log");
        return process;
    }
    std::string screen(const std::string& state) const {
        const auto json = nlohmann::json::parse(content(state), nullptr, false);
        return json.is_object() ? json.value("screen", std::string()) : std::string();
    }
    std::optional<DrivenDisplay> display;
};

TEST_F(RobustDemoWindow, TwoShareTheirSettings) {
    const pid_t first = start("both.json", "state1"), second = start("both.json", "state2");
    ::kill(first, SIGTERM);
    EXPECT_EQ(DrivenDisplay::end(second, SIGTERM), 128 + SIGTERM) << content("log");
    EXPECT_EQ(DrivenDisplay::end(first, 0), 128 + SIGTERM) << content("log");
    const demo::LoadedSettings loaded = demo::load_settings(folder / "both.json");
    EXPECT_TRUE(loaded.found);
    EXPECT_EQ(loaded.problem, "");
    EXPECT_FALSE(fs::exists(folder / "both.json.damaged"));
    EXPECT_EQ(content("log").find("error"), std::string::npos) << content("log");
}

TEST_F(RobustDemoWindow, OddNames) {
    for (const std::string& name : {names_of_outputs()[0], names_of_outputs()[1]}) {
        fs::create_directories(folder / name);
        const pid_t process = start(name + ".json", name + ".state",
                                    {"--screenshots", folder / name, "--record", folder / (name + ".rec")});
        const std::string window = display->window("Lantern House$");
        const auto press = [&](const char* key) {
            display->run("xdotool windowfocus --sync " + window + " key " + std::string(key));
        };
        const auto has_picture = [&] { return !fs::is_empty(folder / name); };
        for (int tries = 0; tries < 10 && screen(name + ".state") != "playing"; ++tries) {
            press("Return");
            DrivenDisplay::wait_until([&] { return screen(name + ".state") == "playing"; }, 3.0);
        }
        for (int tries = 0; tries < 10 && !has_picture(); ++tries) {
            press("p");
            DrivenDisplay::wait_until(has_picture, 3.0);
        }
        EXPECT_TRUE(has_picture()) << name << ": " << content("log");
        EXPECT_EQ(DrivenDisplay::end(process, SIGTERM), 128 + SIGTERM) << content("log");
        for (const char* ending : {".json", ".state", ".rec"})
            EXPECT_TRUE(fs::exists(folder / (name + ending))) << name << ending;
        EXPECT_TRUE(nlohmann::json::accept(content(name + ".json")));
    }
}

TEST(RobustDemoSettings, NumbersOfAnySize) {
    const tests::Folder folder("sunfleck_demo_settings");
    const demo::DemoSettings usual;
    std::size_t tried = 0, refused = 0;
    for (const Field& field : demo::DemoSettings::description().fields)
        for (const std::string& value : tests::hostile_values()) {
            std::string text = "{\"";
            text.append(field.name).append("\": ").append(value).append("}");
            if (!nlohmann::json::accept(text))
                continue;
            ASSERT_TRUE(write_file(folder / "demo.json", text));
            const demo::LoadedSettings loaded = demo::load_settings(folder / "demo.json");
            EXPECT_TRUE(validate(demo::DemoSettings::description(), &loaded.settings)) << text.substr(0, 60);
            const bool kept = field_to_text(field, &loaded.settings) == field_to_text(field, &usual);
            EXPECT_TRUE(loaded.problem.empty() || kept) << text.substr(0, 60);
            ++tried;
            refused += loaded.problem.empty() ? 0 : 1;
        }
    EXPECT_GT(refused, tried / 3);
    std::printf("tried %zu numbers, refused %zu\n", tried, refused);
}

} // namespace
} // namespace sunfleck
