// The editor in a window of a display of its own, driven by X events as a user would: clicks by the names of widgets
// (--widgets), keys, letters.
#pragma once

#include <csignal>
#include <nlohmann/json.hpp>

#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/run_tool.h"

#include <chrono>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sunfleck::tests {

struct Widget {
    std::string name, value;
    double x = 0, y = 0, width = 0, height = 0;
};

class DrivenEditor {
public:
    // What has to be installed.
    static bool possible() { return shell("command -v Xvfb && command -v xdotool && command -v openbox").status == 0; }

    explicit DrivenEditor(std::filesystem::path folder, const std::string& size = "1280x800")
        : folder_(std::move(folder)), size_(size) {
        std::filesystem::create_directories(folder_);
        start_display();
    }
    ~DrivenEditor() {
        for (const pid_t process : {editor_, manager_, display_})
            if (process > 0) {
                ::kill(process, SIGTERM);
                ::waitpid(process, nullptr, 0);
            }
    }
    DrivenEditor(const DrivenEditor&) = delete;
    DrivenEditor& operator=(const DrivenEditor&) = delete;

    void start(const std::vector<std::string>& arguments) {
        std::filesystem::remove(folder_ / "widgets.json");
        std::vector<std::string> all{SUNFLECK_EDITOR,
                                     "--size",
                                     size_,
                                     "--widgets",
                                     file("widgets.json"),
                                     "--report",
                                     file("report.json"),
                                     "--settings",
                                     file("settings.json")};
        all.insert(all.end(), arguments.begin(), arguments.end());
        editor_ = launch(all, folder_ / "log");
        wait_until([&] { return find("viewport/picture").has_value(); });
        window_ = run("xdotool search --sync --onlyvisible --name Sunfleck").output;
        window_ = window_.substr(window_.find_last_of('\n', window_.size() - 2) + 1);
        window_.erase(window_.find_last_not_of('\n') + 1);
        run("xdotool windowfocus --sync " + window_);
    }

    // After which widgets are as they are once the window is at rest.
    std::vector<Widget> widgets() const {
        const auto text = read_file(folder_ / "widgets.json");
        const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
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
    // False: it did not come true in time.
    static bool wait_until(const std::function<bool()>& condition, double seconds = 25.0) {
        const auto start = std::chrono::steady_clock::now();
        while (!condition()) {
            if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds)
                return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(30));
        }
        return true;
    }
    bool wait_for(const std::string& name, const std::string& wanted, double seconds = 25.0) const {
        return wait_until([&] { return value(name) == wanted; }, seconds);
    }
    bool appears(const std::string& name) const {
        return wait_until([&] { return find(name).has_value(); });
    }
    // The scene is drawn as it will stay.
    bool settles() const { return wait_for("status/settled", "yes", 240.0); }

    bool click(const std::string& name, const std::string& button = "1", int times = 1) {
        if (!appears(name))
            return false;
        point_at(*find(name));
        run("xdotool click --repeat " + std::to_string(times) + " --delay 60 " + button);
        return true;
    }
    // Presses at the widget's middle, moves and lets go.
    bool drag(const std::string& name, int x, int y) {
        if (!appears(name))
            return false;
        point_at(*find(name));
        run("xdotool mousedown 1");
        for (int step = 0; step < 6; ++step)
            run("xdotool mousemove_relative -- " + std::to_string(x / 6) + " " + std::to_string(y / 6) + " sleep 0.03");
        run("xdotool mouseup 1");
        return true;
    }
    void point_at(const Widget& widget) {
        run("xdotool mousemove --window " + window_ + " " + std::to_string(int(widget.x + 0.5 * widget.width)) + " " +
            std::to_string(int(widget.y + 0.5 * widget.height)) + " sleep 0.05");
    }
    void point_at(int x, int y) {
        run("xdotool mousemove --window " + window_ + " " + std::to_string(x) + " " + std::to_string(y));
    }
    void key(const std::string& keys) { run("xdotool key " + keys); }
    void type(const std::string& text) { run("xdotool type --delay 15 '" + text + "'"); }
    // A number into a box, by clicking and typing.
    bool enter(const std::string& name, const std::string& text) {
        if (!click(name))
            return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        type(text);
        key("Return");
        return true;
    }

    Outcome run(const std::string& command) const {
        return shell("DISPLAY=:" + std::to_string(number_) + " " + command);
    }
    // Ends as by a signal, and what it reported; null if it did not end by itself.
    nlohmann::json end() {
        ::kill(editor_, SIGINT);
        int status = 0;
        ::waitpid(editor_, &status, 0);
        editor_ = -1;
        const auto text = read_file(folder_ / "report.json");
        return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    }
    // As a crash would.
    void crash() {
        ::kill(editor_, SIGKILL);
        ::waitpid(editor_, nullptr, 0);
        editor_ = -1;
    }
    // Waits for the program to end by itself; its exit status.
    int wait_for_end() {
        int status = 0;
        ::waitpid(editor_, &status, 0);
        editor_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    std::string log() const { return read_file(folder_ / "log").value(); }
    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    pid_t process() const { return editor_; }

private:
    pid_t launch(const std::vector<std::string>& arguments, const std::filesystem::path& log, int keep = -1) const {
        std::vector<char*> pointers;
        pointers.reserve(arguments.size() + 1);
        for (const std::string& argument : arguments)
            pointers.push_back(const_cast<char*>(argument.c_str()));
        pointers.push_back(nullptr);
        const pid_t process = ::fork();
        if (process != 0)
            return process;
        const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
        ::dup2(output, 1);
        ::dup2(output, 2);
        if (keep >= 0)
            ::dup2(keep, 9);
        if (number_ >= 0)
            ::setenv("DISPLAY", (":" + std::to_string(number_)).c_str(), 1);
        ::execvp(pointers[0], pointers.data());
        ::_exit(127);
    }
    void start_display() {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0)
            return;
        display_ = launch({"Xvfb", "-displayfd", "9", "-screen", "0", "1920x1200x24", "-noreset", "-nolisten", "tcp"},
                          folder_ / "display.log", ends[1]);
        ::close(ends[1]);
        char text[16] = {};
        std::size_t length = 0;
        while (length < sizeof text - 1 && ::read(ends[0], text + length, 1) == 1 && text[length] != '\n')
            ++length;
        ::close(ends[0]);
        number_ = std::atoi(text);
        manager_ = launch({"openbox", "--config-file", "/dev/null"}, folder_ / "display.log");
    }

    std::filesystem::path folder_;
    std::string size_, window_;
    pid_t display_ = -1, manager_ = -1, editor_ = -1;
    int number_ = -1;
};

} // namespace sunfleck::tests
