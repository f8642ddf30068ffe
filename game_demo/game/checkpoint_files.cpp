#include "game_demo/game/checkpoint_files.h"

#include "engine/core/file.h"
#include "engine/core/hash.h"

namespace sunfleck::demo {
namespace {

constexpr std::size_t size_limit = std::size_t(64) << 20;

constexpr std::size_t longest_stem = 223; // bytes: a hash of 16 digits and ".checkpoint.old" go behind it

// Levels of one name in two folders have files of their own.
std::string file_name_of(const std::string& identity) {
    const std::string name = std::filesystem::path(identity).filename().string();
    const std::string stem = name.substr(0, name.find('.'));
    if (identity == name)
        return stem;
    return stem.substr(0, longest_stem) + "_" + hash_text(hash_bytes(hash_start, identity.data(), identity.size()));
}

} // namespace

std::string identity_of_level(const std::string& scene) {
    const std::filesystem::path path = scene;
    std::error_code code;
    if (!path.has_extension() && !path.has_parent_path() && !std::filesystem::is_regular_file(path, code))
        return scene; // built in
    const std::filesystem::path whole = std::filesystem::weakly_canonical(std::filesystem::absolute(path, code), code);
    return code ? scene : whole.string();
}

CheckpointFiles::CheckpointFiles(std::filesystem::path folder, const std::string& scene)
    : folder_(std::move(folder)), level_(identity_of_level(scene)),
      newest_(folder_ / (file_name_of(level_) + ".checkpoint")),
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

Status CheckpointFiles::clear() const {
    for (const std::filesystem::path& path : {older_, newest_}) {
        std::error_code code;
        std::filesystem::remove(path, code);
        if (code)
            return Error{"cannot remove '" + path.string() + "': " + code.message()};
    }
    return {};
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
        set_aside(path);
        if (message.empty())
            message = "The checkpoint '" + path.string() + "' was set aside: " + loaded.error().message;
    }
    return false;
}

} // namespace sunfleck::demo
