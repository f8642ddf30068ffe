// The editor in a window of a display of its own, driven by X events as a user would: clicks by the names of widgets
// (--widgets), keys, letters.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/driven_display.h"
#include "tests/support/test_size.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

namespace sunfleck::tests {

struct Widget {
    std::string name, value;
    double x = 0, y = 0, width = 0, height = 0;
};

class DrivenEditor {
    using Place = std::pair<int, int>;

public:
    static bool possible() { return DrivenDisplay::possible(); }

    explicit DrivenEditor(std::filesystem::path folder, const std::string& size = "1280x800")
        : folder_(std::move(folder)), size_(size), display_(folder_) {
        window_size_ = {std::stoi(size), std::stoi(size.substr(size.find('x') + 1))};
        pointer_ = {window_size_.first / 2, window_size_.second / 2};
    }
    ~DrivenEditor() { DrivenDisplay::end(editor_, SIGTERM); }
    DrivenEditor(const DrivenEditor&) = delete;
    DrivenEditor& operator=(const DrivenEditor&) = delete;

    void start(const std::vector<std::string>& arguments, const std::string& program = SUNFLECK_EDITOR) {
        std::filesystem::remove(folder_ / "widgets.json");
        std::vector<std::string> all = environment();
        all.insert(all.end(), {program, "--size", size_, "--widgets", file("widgets.json"), "--report",
                               file("report.json"), "--settings", file("settings.json")});
        all.insert(all.end(), arguments.begin(), arguments.end());
        editor_ = display_.launch(all, folder_ / "log");
        answers_ = true;
        wait_until([&] { return find("viewport/picture").has_value(); });
        window_ = display_.window("Sunfleck");
        display_.focus(window_);
    }

    // As they are once all events have been shown.
    std::vector<Widget> widgets() const {
        const nlohmann::json json = shown();
        std::vector<Widget> result;
        if (!json.is_object())
            return result;
        for (const auto& one : json["widgets"])
            result.push_back({one["name"], one["value"], one["x"], one["y"], one["width"], one["height"]});
        return result;
    }
    std::optional<Widget> find(const std::string& name) const {
        for (const Widget& widget : widgets())
            if (widget.name == name)
                return widget;
        return std::nullopt;
    }
    std::string value(const std::string& name) const {
        const std::optional<Widget> widget = find(name);
        return widget ? widget->value : "(not there)";
    }
    static bool wait_until(const std::function<bool()>& condition, double seconds = 25.0) {
        return DrivenDisplay::wait_until(condition, seconds);
    }
    bool wait_for(const std::string& name, const std::string& wanted, double seconds = 25.0) const {
        return wait_until([&] { return value(name) == wanted; }, seconds);
    }
    bool appears(const std::string& name) const {
        return wait_until([&] { return find(name).has_value(); });
    }
    // Until the program has taken all events that were sent before, and widgets() tells what came of them, however slow
    // the machine is. The pointer moves by a pixel or two: events come in order, so that all is taken once the program
    // says that it is there. Where it is lost it moves once more, each time to another place: when a camera has flown,
    // GLFW takes the pointer for unmoved at two places, where it has put it back and where it was before. False: it has
    // ended, or takes no events for two minutes, after which it is not waited for again.
    [[nodiscard]] bool catch_up() {
        constexpr Place steps[] = {{1, 1}, {-1, -1}, {2, -1}, {-2, 1}, {0, 2}, {1, -2}, {-1, 2}};
        constexpr int count = int(std::size(steps));
        const int x = std::clamp(pointer_.first, 2, std::max(window_size_.first - 3, 2));
        const int y = std::clamp(pointer_.second, 2, std::max(window_size_.second - 3, 2));
        first_step_ = 1 - first_step_; // to and fro
        for (int tries = 0; tries < count && answers_ && runs(); ++tries) {
            const Place step = steps[(tries + first_step_) % count], place(x + step.first, y + step.second);
            if (place == shown_pointer())
                continue;
            point_at(place.first, place.second);
            if (wait_until([&] { return shown_pointer() == place || !runs(); }, std::exp2(tries)))
                return runs();
        }
        return answers_ = false;
    }
    // The scene is drawn as it will stay.
    bool settles() { return catch_up() && wait_for("status/settled", "yes", 240.0); }

    // Points at a widget, and again where it has moved meanwhile: lists that are searched grow shorter with each
    // letter.
    bool reach(const std::string& name) {
        for (int tries = 0; tries < 10 && appears(name); ++tries) {
            const std::optional<Widget> before = find(name);
            if (before)
                point_at(*before);
            if (!catch_up())
                return false;
            const std::optional<Widget> now = find(name);
            if (before && now && std::abs(now->x - before->x) < 2.0 && std::abs(now->y - before->y) < 2.0)
                return true;
        }
        return false;
    }
    bool click(const std::string& name, const std::string& button = "1", int times = 1) {
        if (!reach(name))
            return false;
        run("xdotool click --repeat " + std::to_string(times) + " --delay 60 " + button);
        return true;
    }
    // Presses at the widget's middle, moves and lets go.
    bool drag(const std::string& name, int x, int y) {
        if (!reach(name))
            return false;
        run("xdotool mousedown 1");
        for (int step = 0; step < 6; ++step)
            run("xdotool mousemove_relative -- " + std::to_string(x / 6) + " " + std::to_string(y / 6) + " sleep 0.03");
        run("xdotool mouseup 1");
        pointer_ = {pointer_.first + x / 6 * 6, pointer_.second + y / 6 * 6};
        return true;
    }
    // As a hand does, past the place beside it: a jump to where the pointer was when the camera began to fly is taken
    // by GLFW for its own, which put the pointer back there.
    void point_at(const Widget& widget) {
        const int x = int(widget.x + 0.5 * widget.width), y = int(widget.y + 0.5 * widget.height);
        const std::string move = " mousemove --window " + window_ + " ";
        run("xdotool" + move + std::to_string(x - 1) + " " + std::to_string(y) + move + std::to_string(x) + " " +
            std::to_string(y) + " sleep 0.05");
        pointer_ = {x, y};
    }
    void point_at(int x, int y) {
        pointer_ = {x, y};
        run("xdotool mousemove --window " + window_ + " " + std::to_string(x) + " " + std::to_string(y));
    }
    void resize(int width, int height) {
        window_size_ = {width, height};
        run("xdotool windowsize " + window_ + " " + std::to_string(width) + " " + std::to_string(height));
    }
    void key(const std::string& keys) { run("xdotool key " + keys); }
    void type(const std::string& text) {
        run("xdotool type --delay " + std::string(text.size() > 200 ? "1" : "15") + " -- '" + text + "'");
    }
    // Clicks on a box of text until it takes letters, a frame or two after the click, and selects what it holds.
    bool select_text(const std::string& name) {
        if (!click(name) || !catch_up())
            return false;
        key("ctrl+a");
        return true;
    }
    // In place of what a box of text holds.
    bool write(const std::string& name, const std::string& text) {
        if (!select_text(name))
            return false;
        type(text);
        return true;
    }
    // A number into a box, by clicking and typing.
    bool enter(const std::string& name, const std::string& text) {
        if (!write(name, text))
            return false;
        key("Return");
        return true;
    }

    Outcome run(const std::string& command) const { return display_.run(command); }
    // Ends as by a signal, and what it reported; null if it did not end by itself.
    nlohmann::json end() {
        DrivenDisplay::end(std::exchange(editor_, -1), SIGINT);
        return report();
    }
    // Ends as users do, without saving; the report. `status`: the program's, which tells of what a sanitizer has found,
    // of leaks, too: after a signal it has no time to look for them.
    nlohmann::json quit(int& status) {
        key("ctrl+q");
        if (wait_until([&] { return !runs() || find("dialog/Discard").has_value(); }, 10.0) && runs() &&
            !click("dialog/Discard"))
            return {};
        status = wait_for_end();
        return report();
    }
    // As a crash would.
    void crash() { DrivenDisplay::end(std::exchange(editor_, -1), SIGKILL); }
    // Waits for the program to end by itself; its exit status.
    int wait_for_end() { return DrivenDisplay::end(std::exchange(editor_, -1), 0); }
    std::string log() const { return read_file(folder_ / "log").value(); }
    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    pid_t process() const { return editor_; }
    // What it has used of the processors since it began, s.
    double processor_seconds() const {
        std::ifstream file("/proc/" + std::to_string(editor_) + "/stat");
        std::string word, line;
        std::getline(file, line);
        std::istringstream rest(line.substr(std::min(line.rfind(')') + 2, line.size())));
        std::vector<std::string> words;
        while (rest >> word)
            words.push_back(word);
        return words.size() < 13 ? 0.0
                                 : double(std::stol(words[11]) + std::stol(words[12])) / double(sysconf(_SC_CLK_TCK));
    }
    // As xdotool names it.
    const std::string& window() const { return window_; }
    bool focus() const { return display_.focus(window_); }
    bool minimise() const { return display_.minimise(window_); }
    // It has not ended by itself.
    bool runs() const {
        siginfo_t info{};
        return editor_ > 0 && ::waitid(P_PID, id_t(editor_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
               info.si_pid == 0;
    }

private:
    // In builds with sanitizers driver and validation layer stay loaded to the end (tests/support/pinned_driver.cpp).
    static std::vector<std::string> environment() {
        if (!sanitized())
            return {};
        const char* const options = std::getenv("ASAN_OPTIONS");
        return {"env", "LD_PRELOAD=" SUNFLECK_PINNED_DRIVER,
                "ASAN_OPTIONS=verify_asan_link_order=0:" + std::string(options == nullptr ? "" : options)};
    }
    nlohmann::json report() const {
        const auto text = read_file(folder_ / "report.json");
        return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    }
    nlohmann::json shown() const {
        const auto text = read_file(folder_ / "widgets.json");
        return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    }
    Place shown_pointer() const {
        const nlohmann::json json = shown();
        return json.is_object() ? Place(json["pointer"][0], json["pointer"][1]) : Place(-1, -1);
    }

    std::filesystem::path folder_;
    std::string size_, window_;
    Place window_size_{0, 0}, pointer_{0, 0}; // where it was moved last, in the window
    int first_step_ = 1;
    DrivenDisplay display_;
    pid_t editor_ = -1;
    bool answers_ = true;
};

} // namespace sunfleck::tests
