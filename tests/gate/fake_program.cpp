// A program that speaks the gate's protocol and makes its times up: those of a machine on which each process has its
// luck, without spending any. Options make it slower, make it work more, or break it in one way or another.
//   fake_program [OPTION VALUE]...
//     slow PASS, by FACTOR       the pass takes FACTOR times as long
//     add PASS                   one more pass
//     count FRAME, off NUMBER    counter "maps" is off by NUMBER in that frame
//     break FRAME, how HOW       crash, hang, exit, skip, nan, cut, empty, negative: at that frame
//     size, recording, device, frames, lights   of the hello line
//     hello LINE                 says that in place of the hello line
//     child FILE                 starts a process that sleeps, and writes its id to the file
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <unistd.h>

namespace {

std::map<std::string, std::string> given;

std::string option(const std::string& name, const std::string& otherwise = "") {
    const auto found = given.find(name);
    return found == given.end() ? otherwise : found->second;
}

struct Pass {
    const char* name;
    double ms;
    bool on_cpu;
};
constexpr Pass passes[] = {{"shadow maps", 3.0, false},
                           {"light", 8.0, false},
                           {"repair", 0.5, false},
                           {"tone curve", 1.0, false},
                           {"recording", 2.0, true}};

// A process's luck with each pass, and the noise of each frame.
class Machine {
public:
    Machine() : random_(unsigned(getpid())) {
        for (double& factor : luck_)
            factor = std::exp(0.003 * normal_(random_));
    }
    double time(std::size_t pass, int frame) {
        const Pass& of = passes[pass];
        double ms = of.ms * (1.0 + 0.3 * std::sin(0.05 * frame)) * luck_[pass] * std::exp(0.02 * normal_(random_));
        if (option("slow") == of.name)
            ms *= std::stod(option("by", "1.06"));
        return ms;
    }

private:
    std::mt19937 random_;
    std::normal_distribution<double> normal_;
    double luck_[std::size(passes)]{};
};

void break_down(const std::string& how, std::string& line) {
    if (how == "crash")
        std::abort();
    if (how == "exit") {
        std::fprintf(stderr, "the disk is full\n");
        std::exit(7);
    }
    if (how == "hang")
        std::this_thread::sleep_for(std::chrono::hours(1));
    if (how == "empty")
        line.clear();
    if (how == "cut")
        line.resize(line.size() / 2);
}

std::string frame_line(Machine& machine, int frame, const std::string& broken) {
    std::string texts[2];
    double sum = 1.5; // what no pass accounts for
    for (std::size_t i = 0; i < std::size(passes); ++i) {
        const double ms = machine.time(i, frame);
        sum += ms;
        std::string& text = texts[passes[i].on_cpu];
        text += std::string(text.empty() ? "" : ",") + "\"" + passes[i].name + "\":" + std::to_string(ms);
    }
    if (const std::string added = option("add"); !added.empty()) {
        texts[0] += ",\"" + added + "\":0.7";
        sum += 0.7;
    }
    if (broken == "negative")
        texts[1] += ",\"backwards\":-1";
    const int maps = 24 + frame % 7 + (frame == std::stoi(option("count", "-1")) ? std::stoi(option("off", "1")) : 0);
    const int number = broken == "skip" ? frame + 1 : frame;
    return "{\"frame\":" + std::to_string(number) + ",\"frame_ms\":" + (broken == "nan" ? "NaN" : std::to_string(sum)) +
           ",\"passes\":{" + texts[0] + "},\"stages\":{" + texts[1] +
           "},\"counters\":{\"maps\":" + std::to_string(maps) + ",\"lights\":200}}";
}

void say_hello() {
    if (const std::string line = option("hello"); !line.empty()) {
        std::printf("%s\n", line.c_str());
        return;
    }
    std::printf("{\"sunfleck_gate\":1,\"device\":\"%s\",\"driver\":\"none\",\"recording\":\"%s\",\"size\":\"%s\","
                "\"frames\":%s,\"settings\":{\"lights\":%s}}\n",
                option("device", "made up").c_str(), option("recording", "walk").c_str(),
                option("size", "320x180").c_str(), option("frames", "600").c_str(), option("lights", "200").c_str());
}

void start_child() {
    const std::string file = option("child");
    if (file.empty())
        return;
    const pid_t child = fork();
    if (child == 0) {
        std::this_thread::sleep_for(std::chrono::hours(1));
        std::_Exit(0);
    }
    std::ofstream(file, std::ios::app) << getpid() << "\n" << child << "\n";
}

} // namespace

int main(int argc, char** argv) {
    for (int i = 1; i + 1 < argc; i += 2)
        given[argv[i]] = argv[i + 1];
    start_child();
    say_hello();
    std::fflush(stdout);
    Machine machine;
    for (std::string line, word; std::getline(std::cin, line) && line != "quit";) {
        int first = 0, count = 0;
        std::istringstream(line) >> word >> first >> count;
        for (int frame = first; frame < first + count; ++frame) {
            const std::string broken = frame >= std::stoi(option("break", "1000000")) ? option("how") : "";
            std::string text = frame_line(machine, frame, broken);
            break_down(broken, text);
            std::printf("%s\n", text.c_str());
        }
        std::fflush(stdout);
    }
    return 0;
}
