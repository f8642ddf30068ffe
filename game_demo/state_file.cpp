#include "game_demo/state_file.h"

#include "engine/core/file.h"

#include <nlohmann/json.hpp>

namespace sunfleck::demo {

Status StateFile::write(const GameState& state) {
    if (path_.empty())
        return {};
    const vec3 place = state.progress.place;
    const nlohmann::ordered_json json = {{"screen", state.screen},
                                         {"selected", state.selected},
                                         {"place", {place.x, place.y, place.z}},
                                         {"yaw", state.progress.yaw},
                                         {"area", state.progress.area},
                                         {"steps", state.progress.steps},
                                         {"hint", state.progress.hint},
                                         {"finished", state.progress.finished},
                                         {"carries_lantern", state.progress.carries_lantern},
                                         {"can_resume", state.progress.can_resume},
                                         {"sound_device", state.device},
                                         {"subtitles", state.subtitles},
                                         {"message", state.message},
                                         {"saved", state.saved}};
    // Names of files in messages need not be UTF-8.
    const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (text == written_)
        return {};
    SUNFLECK_TRY(write_file(path_, text));
    written_ = text;
    return {};
}

} // namespace sunfleck::demo
