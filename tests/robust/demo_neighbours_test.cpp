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

const std::string longest = "255 bytes";

// The longest: as long as names can be.
std::string with_ending(const std::string& name, const std::string& ending) {
    return (name == longest ? std::string(255 - ending.size(), 'n') : name) + ending;
}

const std::vector<std::string>& names_of_outputs() {
    static const std::vector<std::string> names = {"a b\nc", "\xff\xfe\x80", "$(x) '\"`;*", longest};
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
        const std::string record = folder / with_ending(name, ".rec"), output = folder / with_ending(name, ".out");
        const std::vector<std::string> headless = {"--headless", "--size", "16x16", "--pictures", "1", "--frames", "3"};
        std::vector<std::string> recorded = headless, played = headless;
        recorded.insert(recorded.end(), {"-o", output, "--record", record});
        played.insert(played.end(), {"-o", output, "--input", record});
        EXPECT_EQ(run(recorded), 0) << name;
        EXPECT_EQ(run(played), 0) << name;
        EXPECT_TRUE(fs::exists(fs::path(output) / "frame_00002.png")) << name;
        EXPECT_TRUE(nlohmann::json::accept(content(with_ending(name, ".out") + "/stats.json"))) << name;
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
    pid_t start_in(const std::vector<std::string>& environment, const std::string& state,
                   const std::vector<std::string>& options) {
        std::vector<std::string> all = {"env"};
        all.insert(all.end(), environment.begin(), environment.end());
        all.insert(all.end(), {"ALSOFT_DRIVERS=null", SUNFLECK_DEMO, "--scene", "cornell", "--size", "96x54", "--state",
                               (folder / state).string()});
        all.insert(all.end(), options.begin(), options.end());
        const pid_t process = display->launch(all, folder / "log");
        EXPECT_TRUE(DrivenDisplay::wait_until([&] { return screen(state) == "title"; }, 90.0)) << content("log");
        return process;
    }
    pid_t start(const std::string& settings, const std::string& state, std::vector<std::string> options = {}) {
        options.insert(options.end(), {"--settings", (folder / settings).string()});
        return start_in({"XDG_DATA_HOME=" + folder.path.string()}, state, options);
    }
    // Presses the key until the condition holds, or for long.
    void press(const char* key, const std::function<bool()>& until) {
        const std::string window = display->window("Lantern House$");
        for (int tries = 0; tries < 10 && !until(); ++tries) {
            display->focus(window);
            display->run("xdotool key " + std::string(key));
            DrivenDisplay::wait_until(until, 3.0);
        }
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
    for (const std::string& name : {names_of_outputs()[0], names_of_outputs()[1], longest}) {
        const std::string pictures = folder / with_ending(name, ""), state = with_ending(name, ".state");
        fs::create_directories(pictures);
        const pid_t process = start(with_ending(name, ".json"), state,
                                    {"--screenshots", pictures, "--record", folder / with_ending(name, ".rec")});
        const auto has_picture = [&] { return !fs::is_empty(pictures); };
        press("Return", [&] { return screen(state) == "playing"; });
        press("p", has_picture);
        EXPECT_TRUE(has_picture()) << name << ": " << content("log");
        EXPECT_EQ(DrivenDisplay::end(process, SIGTERM), 128 + SIGTERM) << content("log");
        for (const char* ending : {".json", ".state", ".rec"})
            EXPECT_TRUE(fs::exists(folder / with_ending(name, ending))) << name << ending;
        EXPECT_TRUE(nlohmann::json::accept(content(with_ending(name, ".json"))));
    }
}

// It plays all the same, and keeps nothing in places that are anybody's.
TEST_F(RobustDemoWindow, NoHome) {
    ASSERT_TRUE(write_file(folder / "file", "x"));
    const auto files = [&] { return std::distance(fs::recursive_directory_iterator(folder / "display"), {}); };
    const auto before = files();
    int number = 0;
    for (const std::vector<std::string>& home : std::vector<std::vector<std::string>>{
             {"-u", "HOME"}, {"HOME="}, {"HOME=relative"}, {"HOME=" + (folder / "file").string()}}) {
        std::vector<std::string> environment = {"-u", "XDG_CONFIG_HOME", "-u", "XDG_DATA_HOME", "-u", "XDG_CACHE_HOME"};
        environment.insert(environment.end(), home.begin(), home.end());
        const std::string state = "state" + std::to_string(++number);
        const pid_t process = start_in(environment, state, {});
        press("Return", [&] { return screen(state) == "playing"; });
        EXPECT_EQ(screen(state), "playing") << home.back();
        EXPECT_EQ(DrivenDisplay::end(process, SIGTERM), 128 + SIGTERM) << home.back() << content("log");
        EXPECT_EQ(files(), before) << home.back();
    }
    EXPECT_EQ(content("file"), "x");
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
