#include "editor/gate/program_pair.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace sunfleck::gate {

namespace fs = std::filesystem;

namespace {

Result<fs::path> find_program(const std::string& program) {
    std::error_code code;
    std::vector<fs::path> places;
    if (program.find('/') != std::string::npos)
        places.emplace_back(program);
    else if (const char* path = std::getenv("PATH"); path != nullptr)
        for (std::string rest = path; !rest.empty();) {
            const std::size_t end = std::min(rest.find(':'), rest.size());
            places.push_back(fs::path(rest.substr(0, end)) / program);
            rest.erase(0, end + 1);
        }
    for (const fs::path& place : places)
        if (fs::is_regular_file(place, code))
            return fs::canonical(place);
    return Error{"there is no program '" + program + "'"};
}

// A link to the program, in a folder of the side's name.
Result<std::string> link_program(const fs::path& folder, const std::string& program, const char* side) {
    SUNFLECK_ASSIGN(const fs::path file, find_program(program));
    const fs::path place = folder / side / "program";
    std::error_code code;
    fs::create_directories(place.parent_path(), code);
    fs::create_symlink(file, place, code);
    if (code)
        return Error{"cannot make '" + place.string() + "': " + code.message()};
    return place.string();
}

} // namespace

Result<std::unique_ptr<Program>> Program::start(const fs::path& folder, std::vector<std::string> command,
                                                const char* side, const Patience& patience) {
    const std::string name = std::string(side) + " ('" + command.front() + "')";
    SUNFLECK_ASSIGN(command.front(), link_program(folder, command.front(), side));
    SUNFLECK_ASSIGN(auto child, ChildProcess::start(name, command, patience));
    return std::unique_ptr<Program>(new Program(std::move(child)));
}

Status Program::read_hello() {
    SUNFLECK_ASSIGN(const std::string line, child_->read_line());
    Result<Hello> hello = parse_hello(line);
    if (!hello)
        return Error{child_->name() + " does not speak the gate's protocol: " + hello.error().message};
    hello_ = std::move(*hello);
    return {};
}

Status Program::request(const DrawFrames& frames) {
    return child_->send(request_line(frames));
}

Result<std::vector<Frame>> Program::receive(const DrawFrames& frames) {
    std::vector<Frame> result;
    for (std::uint32_t i = 0; i < frames.count; ++i) {
        const std::string wanted = std::to_string(frames.first + i);
        SUNFLECK_ASSIGN(const std::string line, child_->read_line());
        Result<Frame> frame = parse_frame(line);
        if (!frame)
            return Error{child_->name() + ", frame " + wanted + ": " + frame.error().message};
        if (frame->number != frames.first + i)
            return Error{child_->name() + " drew frame " + std::to_string(frame->number) + " where frame " + wanted +
                         " was asked for"};
        result.push_back(std::move(*frame));
    }
    return result;
}

Result<std::vector<Frame>> Program::draw(const DrawFrames& frames) {
    SUNFLECK_TRY(request(frames));
    return receive(frames);
}

Status Program::write_picture(const std::string& file) {
    SUNFLECK_TRY(child_->send(request_line(WritePicture{file})));
    SUNFLECK_ASSIGN(const std::string line, child_->read_line());
    if (const Status status = check_picture_line(line, file); !status)
        return Error{child_->name() + ", picture: " + status.error().message};
    return {};
}

Status Program::finish() {
    SUNFLECK_TRY(child_->send(request_line(Quit{})));
    return child_->finish();
}

Result<ProgramPair> ProgramPair::start(const Programs& programs, bool base_first, const Patience& patience) {
    ProgramPair pair;
    SUNFLECK_ASSIGN(pair.links, TemporaryFolder::make());
    for (const bool is_base : {base_first, !base_first}) {
        SUNFLECK_ASSIGN((is_base ? pair.base : pair.head),
                        Program::start(pair.links->path(), is_base ? programs.base : programs.head,
                                       is_base ? "base" : "head", patience));
    }
    SUNFLECK_TRY(pair.base->read_hello());
    SUNFLECK_TRY(pair.head->read_hello());
    SUNFLECK_TRY(check_alike(pair.base->hello(), pair.head->hello()));
    return pair;
}

Status ProgramPair::finish() {
    SUNFLECK_TRY(base->finish());
    return head->finish();
}

Status check_alike(const Hello& base, const Hello& head) {
    const auto differ = [](const std::string& what, const std::string& a, const std::string& b) {
        return Error{"base and head do not draw the same: " + what + " is '" + a + "' in base and '" + b + "' in head"};
    };
    for (const auto& [what, member] : {std::pair{"the recording", &Hello::recording},
                                       {"the size", &Hello::size},
                                       {"the device", &Hello::device},
                                       {"the driver", &Hello::driver}})
        if (base.*member != head.*member)
            return differ(what, base.*member, head.*member);
    if (base.frames != head.frames)
        return differ("the number of frames", std::to_string(base.frames), std::to_string(head.frames));
    for (const auto& [name, value] : base.settings)
        if (const auto other = head.settings.find(name); other != head.settings.end() && other->second != value)
            return differ("setting '" + name + "'", value, other->second);
    return {};
}

} // namespace sunfleck::gate
