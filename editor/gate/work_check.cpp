#include "editor/gate/work_check.h"

#include <algorithm>

namespace sunfleck::gate {
namespace {

constexpr std::uint32_t at_once = 20; // frames in one request

// Up to the next frame that is wanted as a picture, which a request must end with.
std::uint32_t request_length(const WorkCheckOptions& options, std::uint32_t first, std::uint32_t end) {
    std::uint32_t last = std::min(first + at_once, end);
    for (const std::uint32_t frame : options.pictures)
        if (frame >= first && frame < last)
            last = frame + 1;
    return last - first;
}

Status write_pictures(ProgramPair& pair, const WorkCheckOptions& options, std::uint32_t frame) {
    if (!std::count(options.pictures.begin(), options.pictures.end(), frame))
        return {};
    SUNFLECK_TRY(pair.base->write_picture(picture_file(options.folder, "base", frame)));
    return pair.head->write_picture(picture_file(options.folder, "head", frame));
}

} // namespace

std::filesystem::path picture_file(const std::filesystem::path& folder, const char* side, std::uint32_t frame) {
    char name[64];
    std::snprintf(name, sizeof name, "%s_%05u.png", side, frame);
    return folder / name;
}

Result<WorkCheck> check_work(const Programs& programs, const WorkCheckOptions& options) {
    SUNFLECK_ASSIGN(ProgramPair pair, ProgramPair::start(programs, true, options.patience));
    WorkCheck check{pair.base->hello(), pair.head->hello(), {}};
    const std::uint32_t end = std::min(check.base.frames, options.most_frames);
    for (std::uint32_t first = 0; first < end;) {
        const DrawFrames request{first, request_length(options, first, end)};
        SUNFLECK_TRY(pair.base->request(request));
        SUNFLECK_TRY(pair.head->request(request));
        SUNFLECK_ASSIGN(std::vector<Frame> base, pair.base->receive(request));
        SUNFLECK_ASSIGN(std::vector<Frame> head, pair.head->receive(request));
        for (std::uint32_t i = 0; i < request.count; ++i)
            check.frames.push_back({std::move(base[i]), std::move(head[i])});
        first += request.count;
        SUNFLECK_TRY(write_pictures(pair, options, first - 1));
        options.progress(double(first) / end);
    }
    SUNFLECK_TRY(pair.finish());
    return check;
}

} // namespace sunfleck::gate
