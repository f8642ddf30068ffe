// Pictures of the sky beside scene files.
#include "test_places.h"
#include "tests/support/gltf_files.h"

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::World;

const fs::path hdr_picture = SUNFLECK_SOURCE_DIR "/tests/corpus/image/two.hdr";
const fs::path png_picture = SUNFLECK_SOURCE_DIR "/tests/corpus/image/one.png";

const scene::EnvironmentMap& sky_of(World& world) {
    return world.registry.get<scene::EnvironmentMap>(scene::find_by_name(world.registry, "sky"));
}

void add_sky(World& world, const std::string& file) {
    const ecs::Entity entity = world.registry.create();
    world.registry.emplace<scene::Name>(entity, {"sky"});
    world.registry.emplace<scene::Environment>(entity, {});
    world.registry.emplace<scene::EnvironmentMap>(entity, {file, 0.5f, nullptr});
}

Status save(const fs::path& path, World& world) {
    return io::save_scene(path, world.registry, world.meshes, world.textures);
}

io::ImportReport load(const fs::path& path, World& world) {
    io::ImportOptions options;
    options.for_saving = true;
    auto report = io::load_scene(path, world.registry, world.meshes, world.textures, options);
    EXPECT_TRUE(report) << (report ? "" : report.error().message);
    return report ? *report : io::ImportReport();
}

TEST(SceneFiles, APictureOfTheSkyThatCannotBeReadIsNoted) {
    const tests::Folder folder("sky_noted");
    ASSERT_TRUE(write_file(folder / "damaged.hdr", read_file(hdr_picture).value().substr(0, 30)));
    const std::string longest(10000, 'x');
    for (const char* file :
         {"missing.hdr", "damaged.hdr", "room.scene.json", ".", "two\nlines", "/etc/passwd", longest.c_str()}) {
        World before, after, again;
        add_sky(before, file);
        ASSERT_TRUE(save(folder / "room.scene.json", before));
        const io::ImportReport report = load(folder / "room.scene.json", after);
        ASSERT_EQ(report.notes.size(), 1u) << file;
        EXPECT_NE(report.notes[0].find("'sky' is without its picture"), std::string::npos) << report.notes[0];
        EXPECT_LT(report.notes[0].size(), 1000u) << "and no longer than can be read";
        EXPECT_EQ(sky_of(after).file, file) << "its name is kept";
        EXPECT_EQ(sky_of(after).rotation, 0.5f);
        EXPECT_EQ(sky_of(after).image, nullptr);
        ASSERT_TRUE(save(folder / "room.scene.json", after));
        static_cast<void>(load(folder / "room.scene.json", again));
        EXPECT_EQ(sky_of(again).file, file) << "by a save, too";
    }
    World none;
    add_sky(none, "");
    ASSERT_TRUE(save(folder / "room.scene.json", none));
    World read;
    EXPECT_TRUE(load(folder / "room.scene.json", read).notes.empty()) << "there is none to be read";
}

// Into any folder, and by any name: what is saved is whole where it lies.
TEST(SceneFiles, PicturesOfTheSkyGoWithTheScene) {
    const tests::Folder folder("sky_copied");
    const std::string bytes = read_file(hdr_picture).value();
    const struct {
        const char *file, *saved;
        const char* in_the_way; // what is in the new folder
    } cases[] = {{"sky.hdr", "sky.hdr", ""},          {"deep/er/sky.hdr", "deep/er/sky.hdr", ""},
                 {"sky.hdr", "sky 2.hdr", "sky.hdr"}, {"deep/sky.hdr", "sky.hdr", "deep"},
                 {"room.glb", "room 2.glb", ""},      {"room.scene.json", "room.scene 2.json", ""}};
    int number = 0;
    for (const auto& one : cases) {
        SCOPED_TRACE(one.file);
        const fs::path from = folder / std::to_string(number++), to = folder / std::to_string(number++);
        fs::create_directories((from / one.file).parent_path());
        fs::create_directories(to);
        fs::copy_file(hdr_picture, from / one.file);
        if (one.in_the_way[0] != '\0')
            fs::copy_file(png_picture, to / one.in_the_way);
        World before, moved, after;
        add_sky(before, one.file);
        ASSERT_TRUE(save(from / "scene.scene.json", before));
        ASSERT_TRUE(load(from / "scene.scene.json", moved).notes.empty());
        fs::remove_all(from); // the scene has brought along what it needs
        ASSERT_TRUE(save(to / "room.scene.json", moved));
        EXPECT_TRUE(load(to / "room.scene.json", after).notes.empty());
        ASSERT_NE(sky_of(after).image, nullptr);
        EXPECT_EQ(sky_of(after).file, one.saved);
        EXPECT_EQ(sky_of(after).image->texels(), sky_of(moved).image->texels());
        EXPECT_EQ(read_file(to / one.saved).value(), bytes);
        if (one.in_the_way[0] != '\0') {
            EXPECT_EQ(read_file(to / one.in_the_way).value(), read_file(png_picture).value()) << "nothing is replaced";
        }
        ASSERT_TRUE(save(to / "room.scene.json", after)) << "and once more";
        World again;
        static_cast<void>(load(to / "room.scene.json", again));
        EXPECT_EQ(sky_of(again).file, one.saved);
    }
}

// A picture that was painted over while the scene was open is the scene's as it is now.
TEST(SceneFiles, PicturesThatAreWhereTheyWereStayAsTheyAre) {
    const tests::Folder folder("sky_painted");
    fs::copy_file(hdr_picture, folder / "sky.hdr");
    World before, open;
    add_sky(before, "sky.hdr");
    ASSERT_TRUE(save(folder / "room.scene.json", before));
    static_cast<void>(load(folder / "room.scene.json", open));
    fs::copy_file(png_picture, folder / "sky.hdr", fs::copy_options::overwrite_existing);
    ASSERT_TRUE(save(folder / "room.scene.json", open));
    EXPECT_EQ(read_file(folder / "sky.hdr").value(), read_file(png_picture).value());
    World after;
    static_cast<void>(load(folder / "room.scene.json", after));
    EXPECT_EQ(sky_of(after).file, "sky.hdr");
}

} // namespace
} // namespace sunfleck
