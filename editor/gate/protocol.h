// What the gate and the program that it measures say to each other: lines on the program's standard input and output.
// docs/gate.md describes it for programs of one's own.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

namespace sunfleck::gate {

inline constexpr int protocol_version = 1;
inline constexpr std::uint32_t most_frames = 10'000'000;

// The program's first line, once it is ready to draw. What two programs draw must agree in all but the settings that
// only one of them has.
struct Hello {
    std::string device, driver, recording, size;
    std::uint32_t frames = 0; // that can be asked for
    bool pictures = false;    // "picture FILE" is understood
    std::map<std::string, std::string> settings;
};

// One drawn frame. Passes are times of the GPU, stages of the CPU; none contains another.
struct Frame {
    std::uint32_t number = 0;
    double frame_ms = 0.0; // wall clock
    std::map<std::string, double> passes, stages, counters;
};

std::string hello_line(const Hello& hello);
Result<Hello> parse_hello(const std::string& line);
std::string frame_line(const Frame& frame);
Result<Frame> parse_frame(const std::string& line);

// The gate's lines. "frames FIRST COUNT": simulate up to frame FIRST, draw COUNT frames, answer each with a line.
// "picture FILE": write the frame drawn last, answer {"picture": FILE}. "quit", or the end of input: exit.
struct DrawFrames {
    std::uint32_t first = 0, count = 0;
};
struct WritePicture {
    std::string file;
};
struct Quit {};
using Request = std::variant<DrawFrames, WritePicture, Quit>;
std::string request_line(const Request& request);
Result<Request> parse_request(const std::string& line);
std::string picture_line(const std::string& file);
Status check_picture_line(const std::string& line, const std::string& file);

} // namespace sunfleck::gate
