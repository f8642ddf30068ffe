// A display of the test's own, on which a program is driven by X events as a user would.
#pragma once

#include <csignal>

#include "tests/support/run_tool.h"

#include <algorithm>
#include <chrono>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace sunfleck::tests {

class DrivenDisplay {
public:
    // What has to be installed.
    static bool possible() { return shell("command -v Xvfb && command -v xdotool && command -v openbox").status == 0; }

    // The folder is for logs.
    explicit DrivenDisplay(std::filesystem::path folder) : folder_(std::move(folder)) {
        std::filesystem::create_directories(folder_);
        start_display();
    }
    ~DrivenDisplay() {
        for (const pid_t process : {manager_, display_})
            end(process, SIGTERM);
    }
    DrivenDisplay(const DrivenDisplay&) = delete;
    DrivenDisplay& operator=(const DrivenDisplay&) = delete;

    // Starts a program whose output goes to the log.
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
        if (::chdir(folder_.c_str()) != 0) // what is saved without a folder lands here
            ::_exit(127);
        if (number_ >= 0)
            ::setenv("DISPLAY", (":" + std::to_string(number_)).c_str(), 1);
        ::execvp(pointers[0], pointers.data());
        ::_exit(127);
    }
    // Sends the signal, unless it is 0, and waits for the program to end, at most a minute. Its exit status, or 128 +
    // the signal that ended it.
    static int end(pid_t process, int signal) {
        if (process <= 0)
            return -1;
        if (signal != 0)
            ::kill(process, signal);
        int status = 0;
        const auto ended = [&] { return ::waitpid(process, &status, WNOHANG) == process; };
        if (!wait_until(ended, 60.0)) {
            ::kill(process, SIGKILL);
            ::waitpid(process, &status, 0);
        }
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    Outcome run(const std::string& command) const {
        return shell("DISPLAY=:" + std::to_string(number_) + " " + command);
    }
    // The visible window of this title, as xdotool names it.
    std::string window(const std::string& title) const {
        std::string found = run("timeout 60 xdotool search --sync --onlyvisible --name '" + title + "'").output;
        found.erase(found.find_last_not_of('\n') + 1);
        return found.substr(found.find_last_of('\n') + 1);
    }
    // Keys go to the window from here on; it is shown if it was not. xdotool's --sync may wait for ever: where the
    // window manager gives the focus to somebody else meanwhile, it does not ask again.
    bool focus(const std::string& window) const {
        const std::string ask = "xdotool windowmap " + window + " windowfocus " + window;
        for (int round = 0; round < 12; ++round) {
            run(ask);
            if (wait_until([&] { return run("xdotool getwindowfocus").output == window + "\n"; }, 3.0))
                return true;
        }
        return false;
    }
    // Until keys go elsewhere: a window manager that is slow to obey must not see what the test does next before this.
    bool minimise(const std::string& window) const {
        run("xdotool windowminimize " + window);
        return wait_until([&] { return run("xdotool getwindowfocus").output != window + "\n"; });
    }
    // False: it did not come true in time. While the test itself is stopped, as a job of a shell may be, no time passes
    // for the program either.
    static bool wait_until(const std::function<bool()>& condition, double seconds = 25.0) {
        constexpr double longest_turn = 5.0; // what took longer was no wait
        auto last = std::chrono::steady_clock::now();
        for (double waited = 0.0; !condition();) {
            const auto now = std::chrono::steady_clock::now();
            waited += std::min(std::chrono::duration<double>(now - std::exchange(last, now)).count(), longest_turn);
            if (waited > seconds)
                return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return true;
    }

private:
    // Its usual bindings would roll a window up when the wheel is turned over its title, and leave it there; with an
    // empty file it keeps them, and opens a window of its own to complain.
    void start_manager() {
        const std::filesystem::path settings = folder_ / "window_manager.xml";
        std::ofstream(settings) << R"(<?xml version="1.0"?>
<openbox_config xmlns="http://openbox.org/3.4/rc"><keyboard/><mouse><context name="Client">
<mousebind button="Left" action="Press"><action name="Focus"/><action name="Raise"/></mousebind>
</context></mouse></openbox_config>
)";
        manager_ = launch({"openbox", "--config-file", settings.string()}, folder_ / "display.log");
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
        start_manager();
        // It answers: a window that is opened while it starts may never be shown.
        wait_until([&] { return run("xdotool set_num_desktops 1 get_num_desktops").output == "1\n"; }, 60.0);
    }

    std::filesystem::path folder_;
    pid_t display_ = -1, manager_ = -1;
    int number_ = -1;
};

} // namespace sunfleck::tests
