// Pictures of the sky, which are read again where their names change.
#include "editor/document/document.h"

#include "engine/io/uri.h"
#include "engine/scene/summer_sky.h"

namespace sunfleck::editor {
namespace {

constexpr std::size_t most_remarks = 100;

// Null: there is none.
Result<std::shared_ptr<const scene::EnvironmentImage>> picture_of(const std::string& name,
                                                                  const std::filesystem::path& folder, bool typed) {
    if (name.empty())
        return std::shared_ptr<const scene::EnvironmentImage>();
    if (name == scene::summer_sky_name)
        return scene::summer_sky();
    // What the user names himself may lie anywhere: a save brings it along.
    const io::FileAccess access{io::real_folder(folder / "scene"), typed};
    return io::load_environment_image(folder / name, access, true);
}

} // namespace

void Document::settle_skies() {
    std::vector<std::pair<Entity, std::shared_ptr<scene::EnvironmentMap>>> skies;
    for (const ComponentChange& change : gesture_->components) {
        if (change.pool != sky_pool_ || change.after == nullptr)
            continue;
        const auto& now = *static_cast<const scene::EnvironmentMap*>(change.after.get());
        const auto* before = static_cast<const scene::EnvironmentMap*>(change.before.get());
        const bool same_name = before != nullptr && before->file == now.file;
        // Pasted or read from a file, with its picture; else the picture is that of the name before.
        const bool brought = now.image != nullptr && (before == nullptr || same_name || now.image != before->image);
        if (brought || (same_name && before->image == nullptr))
            continue;
        auto value = std::make_shared<scene::EnvironmentMap>(now);
        if (same_name) {
            value->image = before->image;
        } else if (auto picture = picture_of(now.file, folder_, before != nullptr)) {
            value->image = std::move(*picture);
        } else {
            value->image = nullptr;
            remarks_.push_back("'" + name(change.entity) +
                               "' is without its picture of the sky: " + io::one_line(picture.error().message));
            if (remarks_.size() > most_remarks) // nobody takes them
                remarks_.erase(remarks_.begin());
        }
        skies.emplace_back(change.entity, std::move(value));
    }
    for (auto& [entity, value] : skies)
        set(entity, *sky_pool_, std::move(value));
}

std::size_t Document::read_skies_again() {
    std::size_t others = 0;
    begin("Reload pictures of the sky");
    for (const Entity entity : std::vector(sky_pool_->entities())) {
        const auto& sky = registry_.get<scene::EnvironmentMap>(entity);
        const auto picture = picture_of(sky.file, folder_, false);
        if (!picture || *picture == nullptr || *picture == sky.image ||
            (sky.image != nullptr && (*picture)->texels() == sky.image->texels()))
            continue; // one that cannot be read, or not any more, stays as it is seen
        auto value = std::make_shared<scene::EnvironmentMap>(sky);
        value->image = *picture;
        set(entity, *sky_pool_, std::move(value));
        ++others;
    }
    commit();
    return others;
}

} // namespace sunfleck::editor
