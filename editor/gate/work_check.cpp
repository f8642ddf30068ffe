#include "editor/gate/work_check.h"

#include <algorithm>

namespace sunfleck::gate {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t at_once = 20;       // frames in one request
constexpr std::uint32_t pictures_taken = 6; // where none are named

// Spread over the recording.
std::vector<NamedFrame> some_frames(std::uint32_t end) {
    std::vector<NamedFrame> frames;
    for (std::uint32_t i = 1; i <= std::min(pictures_taken, end); ++i) {
        const std::uint32_t frame = std::uint32_t(std::uint64_t(end) * i / pictures_taken) - 1;
        frames.push_back({"frame_" + std::to_string(frame), frame});
    }
    return frames;
}

// Up to the next frame that is wanted as a picture, which a request must end with.
DrawFrames next_request(const std::vector<NamedFrame>& pictures, std::uint32_t first, std::uint32_t end) {
    std::uint32_t last = std::min(first + at_once, end);
    for (const NamedFrame& picture : pictures)
        if (picture.frame >= first && picture.frame < last)
            last = picture.frame + 1;
    return {first, last - first};
}

Status write_pictures(Program& program, const std::vector<NamedFrame>& pictures, std::uint32_t frame,
                      const fs::path& folder) {
    for (const NamedFrame& picture : pictures)
        if (picture.frame == frame)
            SUNFLECK_TRY(program.write_picture((folder / (picture.name + ".png")).string()));
    return {};
}

Status make_folder(const fs::path& folder) {
    std::error_code code;
    fs::create_directories(folder, code);
    return code ? Status(Error{"cannot make '" + folder.string() + "': " + code.message()}) : Status();
}

Status check_named(const std::vector<NamedFrame>& pictures, const Hello& hello) {
    if (!pictures.empty() && !hello.pictures)
        return Error{"the program does not write pictures: its first line lacks \"pictures\": true"};
    for (const NamedFrame& picture : pictures)
        if (picture.frame >= hello.frames)
            return Error{"picture '" + picture.name + "' is of frame " + std::to_string(picture.frame) +
                         "; the recording has " + std::to_string(hello.frames)};
    return {};
}

} // namespace

Result<WorkCheck> check_work(const Programs& programs, const WorkCheckOptions& options) {
    SUNFLECK_ASSIGN(ProgramPair pair, ProgramPair::start(programs, true, options.patience));
    WorkCheck check{pair.base->hello(), pair.head->hello(), {}, options.pictures};
    SUNFLECK_TRY(check_named(check.pictures, check.base));
    const std::uint32_t end = std::min(check.base.frames, options.most_frames);
    if (check.pictures.empty() && check.base.pictures && check.head.pictures)
        check.pictures = some_frames(end);
    for (const char* side : {"base", "head"})
        SUNFLECK_TRY(make_folder(options.folder / side));
    for (std::uint32_t first = 0; first < end;) {
        const DrawFrames request = next_request(check.pictures, first, end);
        SUNFLECK_TRY(pair.base->request(request));
        SUNFLECK_TRY(pair.head->request(request));
        SUNFLECK_ASSIGN(std::vector<Frame> base, pair.base->receive(request));
        SUNFLECK_ASSIGN(std::vector<Frame> head, pair.head->receive(request));
        for (std::uint32_t i = 0; i < request.count; ++i)
            check.frames.push_back({std::move(base[i]), std::move(head[i])});
        first += request.count;
        SUNFLECK_TRY(write_pictures(*pair.base, check.pictures, first - 1, options.folder / "base"));
        SUNFLECK_TRY(write_pictures(*pair.head, check.pictures, first - 1, options.folder / "head"));
        options.progress(double(first) / end);
    }
    SUNFLECK_TRY(pair.finish());
    return check;
}

Result<std::vector<PictureResult>> compare_pictures(const WorkCheck& check, const fs::path& folder) {
    std::vector<PictureResult> results;
    for (const NamedFrame& frame : check.pictures) {
        PictureResult result{
            frame, folder / "base" / (frame.name + ".png"), folder / "head" / (frame.name + ".png"), {}, {}};
        SUNFLECK_TRY(compare_picture(result, true));
        results.push_back(std::move(result));
    }
    return results;
}

Result<Hello> draw_pictures(const std::vector<std::string>& command, const WorkCheckOptions& options) {
    SUNFLECK_ASSIGN(const auto links, TemporaryFolder::make());
    SUNFLECK_ASSIGN(const auto program, Program::start(links->path(), command, "head", options.patience));
    SUNFLECK_TRY(program->read_hello());
    SUNFLECK_TRY(check_named(options.pictures, program->hello()));
    SUNFLECK_TRY(make_folder(options.folder));
    const std::uint32_t end = options.pictures.back().frame + 1;
    for (std::uint32_t first = 0; first < end;) {
        const DrawFrames request = next_request(options.pictures, first, end);
        SUNFLECK_ASSIGN(const std::vector<Frame> drawn, program->draw(request));
        first += request.count;
        SUNFLECK_TRY(write_pictures(*program, options.pictures, first - 1, options.folder));
        options.progress(double(first) / end);
    }
    SUNFLECK_TRY(program->finish());
    return program->hello();
}

} // namespace sunfleck::gate
