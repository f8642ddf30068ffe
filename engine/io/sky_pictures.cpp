#include "engine/io/sky_pictures.h"

#include "engine/core/file.h"
#include "engine/io/image.h"
#include "engine/io/scene_file.h"
#include "engine/io/uri.h"
#include "engine/scene/summer_sky.h"
#include "engine/scene/texture_store.h"

#include <nlohmann/json.hpp>

namespace sunfleck::io {
namespace {

namespace fs = std::filesystem;

std::string entity_name(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* name = registry.try_get<scene::Name>(entity);
    return name != nullptr ? name->name : std::string();
}

// Whether it lies in a folder by its spelling.
bool stays_inside(const fs::path& path) {
    if (path.empty() || !path.has_filename() || path.is_absolute())
        return false;
    for (const fs::path& part : path)
        if (part == "..")
            return false;
    return true;
}

// What a save writes itself.
bool is_taken(const fs::path& scene_file, const fs::path& name) {
    const std::string file = scene_file.filename().string(), stem = file.substr(0, file.find('.'));
    return name == file || name == stem + ".glb" || name == stem + ".2.glb";
}

fs::path numbered(const fs::path& name, int number) {
    if (number == 1)
        return name;
    fs::path result = name.parent_path() / name.stem();
    result += " " + std::to_string(number);
    result += name.extension();
    return result;
}

// The picture's name in the scene file at `path`; it is there then.
Result<std::string> place_picture(const fs::path& path, const std::string& wanted, const scene::PictureFile& picture) {
    const fs::path folder = real_folder(path);
    const FileAccess access{folder};
    std::error_code code;
    fs::path name = wanted;
    if (!stays_inside(name))
        name = fs::path(wanted).filename();
    if (name.empty() || name == "..")
        name = "sky";
    if (fs::create_directories((folder / name).parent_path(), code); code)
        name = name.filename(); // there is a file of the folder's name
    constexpr int most = 1000;
    for (int number = 1; number <= most; ++number) {
        const fs::path candidate = numbered(name, number), target = folder / candidate;
        if (is_taken(path, candidate) || !access.check(target))
            continue;
        if (!fs::exists(fs::symlink_status(target, code))) {
            SUNFLECK_TRY(write_file(target, picture.bytes));
            return candidate.generic_string();
        }
        if (fs::equivalent(target, picture.path, code)) // it may have been painted over since
            return candidate.generic_string();
        const auto there = access.read(target);
        if (there && *there == picture.bytes)
            return candidate.generic_string();
    }
    return Error{"there is no free name for the picture '" + wanted + "' in '" + folder.string() + "'"};
}

} // namespace

Status load_sky_pictures(const fs::path& folder, const FileAccess& access, ecs::Registry& registry, bool for_saving,
                         std::vector<std::string>& notes) {
    std::vector<ecs::Entity> entities;
    registry.view<scene::EnvironmentMap>().each(
        [&](ecs::Entity entity, const scene::EnvironmentMap&) { entities.push_back(entity); });
    for (const ecs::Entity entity : entities) {
        const std::string file = registry.get<scene::EnvironmentMap>(entity).file;
        if (file.empty())
            continue;
        std::shared_ptr<const scene::EnvironmentImage> image;
        if (file == scene::summer_sky_name) {
            image = scene::summer_sky();
        } else if (auto read = load_environment_image(folder / file, access, for_saving)) {
            image = std::move(*read);
        } else if (read.error().code == ErrorCode::memory) {
            return read.error();
        } else {
            notes.push_back("'" + entity_name(registry, entity) +
                            "' is without its picture of the sky: " + one_line(read.error().message));
        }
        registry.patch<scene::EnvironmentMap>(entity,
                                              [&](scene::EnvironmentMap& map) { map.image = std::move(image); });
    }
    return {};
}

Status save_sky_pictures(const fs::path& path, ecs::Registry& registry, nlohmann::json& entities) {
    for (const ecs::Entity entity : registry.entities()) {
        const auto* map = registry.try_get<scene::EnvironmentMap>(entity);
        const std::string name = entity_name(registry, entity);
        if (map == nullptr || map->image == nullptr || map->image->file() == nullptr || !entities.contains(name))
            continue;
        SUNFLECK_ASSIGN(const std::string file, place_picture(path, map->file, *map->image->file()));
        entities[name][std::string(scene::EnvironmentMap::description().name)]["file"] = file;
    }
    return {};
}

Result<std::shared_ptr<const scene::EnvironmentImage>>
load_environment_image(const fs::path& path, const FileAccess& access, bool for_saving) {
    SUNFLECK_ASSIGN(std::string bytes, access.read(path));
    const auto kind = sniff_picture(bytes);
    auto picture = decode_picture(bytes);
    if (!picture)
        return Error{"environment map '" + path.string() + "': " + picture.error().message, picture.error().code};
    std::vector<vec3> texels;
    texels.reserve(picture->pixels.size());
    const bool display = kind == PictureKind::png || kind == PictureKind::jpeg;
    for (const vec4& pixel : picture->pixels)
        texels.push_back(display ? vec3(scene::linear_from_srgb(pixel.x), scene::linear_from_srgb(pixel.y),
                                        scene::linear_from_srgb(pixel.z))
                                 : vec3(pixel));
    std::shared_ptr<const scene::PictureFile> file;
    if (for_saving) {
        std::error_code code;
        const fs::path full = fs::absolute(path, code);
        file = std::make_shared<const scene::PictureFile>(scene::PictureFile{code ? path : full, std::move(bytes)});
    }
    return std::make_shared<const scene::EnvironmentImage>(picture->width, picture->height, std::move(texels),
                                                           std::move(file));
}

} // namespace sunfleck::io
