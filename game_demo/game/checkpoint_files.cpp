#include "game_demo/game/checkpoint_files.h"

#include "engine/core/file.h"

namespace sunfleck::demo {
namespace {

constexpr std::size_t size_limit = std::size_t(64) << 20;

// A scene may be given as a path.
std::string file_name_of(const std::string& level) {
    const std::string name = std::filesystem::path(level).filename().string();
    return name.substr(0, name.find('.'));
}

} // namespace

CheckpointFiles::CheckpointFiles(std::filesystem::path folder, std::string level)
    : folder_(std::move(folder)), level_(std::move(level)), newest_(folder_ / (file_name_of(level_) + ".checkpoint")),
      older_(folder_ / (file_name_of(level_) + ".checkpoint.old")) {}

Status CheckpointFiles::write(const std::string& text) const {
    std::error_code code;
    std::filesystem::create_directories(folder_, code);
    if (code)
        return Error{"cannot create folder '" + folder_.string() + "': " + code.message()};
    // The last one is kept as a copy: at every moment, one file under either name is whole.
    if (auto last = read_file(newest_, size_limit))
        SUNFLECK_TRY(write_file(older_, *last));
    return write_file(newest_, text);
}

bool CheckpointFiles::any() const {
    std::error_code code;
    return std::filesystem::exists(newest_, code) || std::filesystem::exists(older_, code);
}

bool CheckpointFiles::load(GameWorld& world, std::string& message) const {
    std::error_code code;
    for (const std::filesystem::path& path : {newest_, older_}) {
        if (!std::filesystem::exists(path, code))
            continue;
        const auto text = read_file(path, size_limit);
        const Status loaded = text ? load_game(world, level_, *text) : Status(text.error());
        if (loaded)
            return true;
        std::filesystem::path aside = path;
        aside += ".damaged";
        std::filesystem::rename(path, aside, code);
        if (message.empty())
            message = "The checkpoint '" + path.string() + "' was set aside: " + loaded.error().message;
    }
    return false;
}

} // namespace sunfleck::demo
