// The editor's window under random use: clicks, drags, keys and texts of all kinds do no harm.
#include "tests/editor/window_fixture.h"
#include "tests/support/test_size.h"

#include <algorithm>
#include <fstream>
#include <random>

namespace sunfleck {
namespace {

using tests::DrivenEditor, tests::Widget;

// What ends the program, or would lead out of the test's folder.
bool is_left_out(const std::string& name) {
    return name.ends_with("/Quit") || name.starts_with("dialog/folder");
}

class RandomUser {
public:
    RandomUser(DrivenEditor& editor, std::uint32_t seed) : editor_(editor), random_(seed) {}

    void act() {
        const std::uint32_t kind = below(24);
        if (kind >= 20)
            menu();
        else if (kind < 9)
            click();
        else if (kind < 12)
            drag();
        else if (kind < 16)
            key();
        else if (kind < 18)
            enter();
        else if (kind < 19)
            editor_.run("xdotool click " + std::to_string(4 + below(2))); // the wheel
        else
            editor_.resize(400 + int(below(900)), 300 + int(below(500)));
    }

private:
    std::uint32_t below(std::size_t limit) { return std::uint32_t(random_() % limit); }
    const Widget* some_widget() {
        widgets_ = editor_.widgets();
        std::erase_if(widgets_, [](const Widget& widget) { return is_left_out(widget.name) || widget.width <= 0; });
        return widgets_.empty() ? nullptr : &widgets_[below(widgets_.size())];
    }
    void click() {
        static const char* const buttons[] = {"1", "1", "1", "1", "3", "2"};
        if (const Widget* widget = some_widget()) {
            editor_.point_at(*widget);
            editor_.run("xdotool click --repeat " + std::to_string(1 + below(2)) + " --delay 60 " +
                        buttons[below(std::size(buttons))]);
        }
    }
    // Lets one fall, and chooses.
    void menu() {
        choose([](const std::string& name) {
            return name.starts_with("menu/") && name != "menu/title" && name.find('/', 5) == std::string::npos;
        });
        std::this_thread::sleep_for(std::chrono::milliseconds(150));
        choose([](const std::string& name) { return name.starts_with("menu/") && name.find('/', 5) != name.npos; });
        if (below(3) == 0)
            editor_.key("Escape");
    }
    void choose(const std::function<bool(const std::string&)>& wanted) {
        widgets_ = editor_.widgets();
        std::erase_if(widgets_, [&](const Widget& widget) {
            return is_left_out(widget.name) || widget.value == "disabled" || !wanted(widget.name);
        });
        if (widgets_.empty())
            return;
        editor_.point_at(widgets_[below(widgets_.size())]);
        editor_.run("xdotool click 1");
    }
    void drag() {
        if (const Widget* widget = some_widget())
            editor_.drag(widget->name, int(below(400)) - 200, int(below(300)) - 150);
    }
    void key() {
        static const char* const keys[] = {"ctrl+z",
                                           "ctrl+z",
                                           "ctrl+shift+z",
                                           "ctrl+d",
                                           "ctrl+g",
                                           "ctrl+a",
                                           "Delete",
                                           "Escape",
                                           "Escape",
                                           "w",
                                           "e",
                                           "r",
                                           "f",
                                           "Home",
                                           "ctrl+c",
                                           "ctrl+v",
                                           "ctrl+x",
                                           "space",
                                           "ctrl+s",
                                           "ctrl+shift+s",
                                           "ctrl+n",
                                           "ctrl+o",
                                           "Tab",
                                           "Return",
                                           "ctrl+p",
                                           "ctrl+l",
                                           "h",
                                           "g",
                                           "Up",
                                           "Down"};
        editor_.key(keys[below(std::size(keys))]);
    }
    void enter() {
        static const char* const texts[] = {"0.5", "nan", "-1", "1e9", "7", "abc", "", "0", "1e-30", "x.scene.json"};
        click();
        editor_.type(texts[below(std::size(texts))]);
        editor_.key(below(3) == 0 ? "Escape" : "Return");
    }

    DrivenEditor& editor_;
    std::mt19937 random_;
    std::vector<Widget> widgets_;
};

double resident_mib(pid_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmRSS:"))
            return std::stod(line.substr(6)) / 1024.0;
    return 0.0;
}

using EditorWindowUse = tests::EditorWindowTest;

// A quarter of a minute; ./run bench editor takes twenty. SUNFLECK_SEED repeats a failure.
TEST_F(EditorWindowUse, RandomUseDoesNoHarm) {
    const char* const seed_text = std::getenv("SUNFLECK_SEED");
    const std::uint32_t seed = seed_text != nullptr ? std::uint32_t(std::atoi(seed_text)) : 1u;
    SCOPED_TRACE("seed " + std::to_string(seed));
    editor->start({"cornell", "--validation"});
    ASSERT_TRUE(editor->settles()) << editor->log();
    RandomUser user(*editor, seed);
    const char* const seconds_text = std::getenv("SUNFLECK_USE_SECONDS");
    const int seconds = seconds_text != nullptr ? std::atoi(seconds_text) : tests::by_size(15, 1200);
    const auto begin = std::chrono::steady_clock::now(), end = begin + std::chrono::seconds(seconds);
    int events = 0;
    double half = 0.0; // memory when half of the time has passed, MiB
    for (; std::chrono::steady_clock::now() < end && editor->runs(); ++events) {
        user.act();
        if (half == 0.0 && std::chrono::steady_clock::now() - begin > (end - begin) / 2)
            half = resident_mib(editor->process());
    }
    ASSERT_TRUE(editor->runs()) << "ended after " << events << " events\n" << editor->log();
    const double memory = resident_mib(editor->process());
    const auto report = editor->end();
    ASSERT_TRUE(report.is_object()) << "ended after " << events << " events\n" << editor->log();
    EXPECT_EQ(report["validation_messages"], 0) << editor->log();
    int used = 0;
    std::string unused;
    for (const auto& [name, uses] : report["commands"].items())
        if (uses.get<int>() > 0)
            ++used;
        else
            unused += " '" + name + "'";
    const int commands = int(report["commands"].size());
    std::printf("seed %u: %d events, %d of %d commands, %.0f MiB at half time, %.0f MiB at the end; never:%s\n", seed,
                events, used, commands, half, memory, unused.c_str());
    if (seconds >= 1200) { // of less, chance decides
        EXPECT_GE(used, 0.9 * commands);
        EXPECT_LE(memory, 1.01 * half);
    }
}

} // namespace
} // namespace sunfleck
