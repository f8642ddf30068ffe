// A glTF file that is exported again on another day: the scene that was made from it still knows where it came from.
#include "editor/document/source_link.h"

#include "engine/core/file.h"
#include "test_places.h"
#include "tests/editor/change_component.h"
#include "tests/editor/panel_fixture.h"

#include <nlohmann/json.hpp>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

class EditorSessionSource : public PanelTest {
protected:
    EditorSessionSource() {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            add_from(theirs_, source, vec3(1.0f, 2.0f, 3.0f), 0.5f);
        fs::create_directories(folder_ / "models");
        export_again();
    }
    // What another program writes.
    void export_again() { export_again_as(gltf_); }
    void export_again_as(const fs::path& path) {
        ASSERT_TRUE(io::export_gltf(path, theirs_.registry(), theirs_.meshes(), theirs_.textures()));
        fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(++exports_));
    }
    void open(const fs::path& path) {
        auto opened = Document::open(path);
        ASSERT_TRUE(opened) << opened.error().message;
        session_.take(std::move(*opened));
    }
    // Messages on it since the last call.
    int announced() {
        session_.take_news();
        session_.take_news();
        int count = 0;
        for (const Message& message : session_.messages.all())
            if (message.number > seen_ &&
                message.text.find("artist.glb' was changed by another program") != std::string::npos)
                ++count;
        seen_ = session_.messages.count();
        return count;
    }
    std::string reload_source() {
        session_.reload_file();
        for (int tries = 0; tries < 3000 && newest_message().find("Reloaded") == std::string::npos; ++tries) {
            session_.take_news();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        seen_ = session_.messages.count();
        return newest_message();
    }
    // `value`: of what is edited here, and of what is exported then.
    void crash_and_recover(float value) {
        const auto place = [this] { return Recovery::Place(document().path().string(), document().folder()); };
        {
            ChangeCollector collector;
            Recovery recovery(folder_ / "recovery");
            recovery.change(*collector.collect(session_.document));
            recovery.saved(place());
            change<scene::Material>(document(), "box", [=](scene::Material& one) { one.roughness = value; });
            recovery.change(*collector.collect(session_.document));
            recovery.unsaved(place(), {"edit"}, 1);
            recovery.leave();
        }
        const std::vector<Recovered> left = Recovery::left_behind(folder_ / "recovery");
        ASSERT_EQ(left.size(), 1u);
        auto found = Recovery::load(left[0]);
        ASSERT_TRUE(found) << found.error().message;
        session_.take(std::move(*found));
        Recovery::discard(left[0]);
        change<scene::Material>(theirs_, "box", [=](scene::Material& one) { one.metallic = value; });
        export_again();
        EXPECT_EQ(announced(), 1);
        EXPECT_EQ(reload_source(), "Reloaded artist.glb: 1 changed, 0 new, 0 gone");
        EXPECT_EQ(material("box").roughness, value);
        EXPECT_EQ(material("box").metallic, value);
    }

    const scene::Material& material(const char* name) {
        return document().registry().get<scene::Material>(document().find(name));
    }

    Document theirs_;
    const fs::path gltf_ = folder_ / "models" / "artist.glb";
    int exports_ = 0;
    std::uint64_t seen_ = 0;
};

TEST_F(EditorSessionSource, IsKnownOnTheNextDay) {
    open(gltf_);
    change<scene::Material>(document(), "box", [](scene::Material& one) { one.roughness = 0.25f; });
    ASSERT_TRUE(rename(document(), document().find("ball"), "my ball"));
    remove(document(), {document().find("cylinder")});
    const Entity lamp = add("Point light");
    ASSERT_TRUE(rename(document(), lamp, "my lamp"));
    fs::create_directories(folder_ / "scenes");
    ASSERT_TRUE(session_.save(folder_ / "scenes" / "room.scene.json"));
    EXPECT_EQ(announced(), 0);

    // The scene and the model go to another place, together.
    fs::create_directories(folder_ / "moved");
    for (const char* part : {"scenes", "models"})
        fs::rename(folder_ / part, folder_ / "moved" / part);
    const fs::path scene = folder_ / "moved" / "scenes" / "room.scene.json",
                   model = folder_ / "moved" / "models" / "artist.glb";
    open(scene);
    EXPECT_EQ(announced(), 0) << "nothing was exported";
    const auto edits = document().history().position();
    EXPECT_EQ(reload_source(), "Reloaded artist.glb: 0 changed, 0 new, 0 gone");
    EXPECT_EQ(document().history().position(), edits);

    change<scene::Material>(theirs_, "box", [](scene::Material& one) {
        one.base_colour = vec3(0.1f, 0.2f, 0.7f);
        one.roughness = 0.75f;
    });
    change<scene::Transform>(theirs_, "ball", [](scene::Transform& one) { one.position.x = 7.0f; });
    change<scene::Transform>(theirs_, "cylinder", [](scene::Transform& one) { one.position.x = 7.0f; });
    remove(theirs_, {theirs_.find("floor")});
    export_again_as(model);
    open(scene);
    EXPECT_EQ(announced(), 1) << "it is said on the next day";
    EXPECT_EQ(reload_source(), "Reloaded artist.glb: 2 changed, 0 new, 1 gone");
    EXPECT_EQ(announced(), 0);
    EXPECT_EQ(material("box").base_colour, vec3(0.1f, 0.2f, 0.7f)) << "theirs";
    EXPECT_EQ(material("box").roughness, 0.25f) << "ours";
    EXPECT_EQ(document().registry().get<scene::Transform>(document().find("my ball")).position.x, 7.0f);
    EXPECT_TRUE(document().find("cylinder").is_null()) << "what was deleted stays so";
    EXPECT_TRUE(document().find("floor").is_null());
    EXPECT_TRUE(document().exists(document().find("my lamp")));

    // And once more, with the window open.
    ASSERT_TRUE(session_.save(scene));
    EXPECT_EQ(announced(), 0);
    change<scene::Material>(theirs_, "box", [](scene::Material& one) { one.metallic = 1.0f; });
    export_again_as(model);
    EXPECT_EQ(announced(), 1);
    EXPECT_EQ(reload_source(), "Reloaded artist.glb: 1 changed, 0 new, 0 gone");
    EXPECT_EQ(material("box").metallic, 1.0f);
}

TEST_F(EditorSessionSource, IsKnownAfterACrash) {
    open(gltf_);
    ASSERT_TRUE(session_.save(folder_ / "room.scene.json"));
    crash_and_recover(0.25f);
    crash_and_recover(0.5f); // before it was saved again
}

TEST_F(EditorSessionSource, IsKnownAfterACrashBeforeTheFirstSave) {
    open(gltf_);
    crash_and_recover(0.25f);
    crash_and_recover(0.5f);
}

// The file's geometry is nowhere in the scene any more.
TEST_F(EditorSessionSource, GeometryThatWasReplacedHereStays) {
    open(gltf_);
    scene::Mesh other =
        document().meshes()[document().registry().get<scene::MeshInstance>(document().find("box")).mesh];
    other.positions[0] += vec3(0.0f, 0.5f, 0.0f);
    const std::uint32_t number = document().add_mesh(other);
    change<scene::MeshInstance>(document(), "box", [&](scene::MeshInstance& one) { one.mesh = number; });
    ASSERT_TRUE(session_.save(folder_ / "room.scene.json"));
    open(folder_ / "room.scene.json");
    EXPECT_EQ(reload_source(), "Reloaded artist.glb: 0 changed, 0 new, 0 gone");
    const auto now = document().registry().get<scene::MeshInstance>(document().find("box")).mesh;
    EXPECT_EQ(document().meshes()[now].positions, other.positions);
    change<scene::Material>(theirs_, "box", [](scene::Material& one) { one.metallic = 1.0f; });
    export_again();
    EXPECT_EQ(announced(), 1);
    EXPECT_EQ(reload_source(), "Reloaded artist.glb: 1 changed, 0 new, 0 gone");
    EXPECT_EQ(document().registry().get<scene::MeshInstance>(document().find("box")).mesh, now);
}

// A scene of unknown origin may name any file: one that is not in its folder is read where the user asks for it.
// Whether it is newer is told by its time and size.
TEST_F(EditorSessionSource, OutsideOfTheFolderItIsNotReadUnasked) {
    open(gltf_);
    fs::create_directories(folder_ / "scenes");
    const fs::path outside = folder_ / "scenes" / "room.scene.json", inside = folder_ / "room.scene.json";
    ASSERT_TRUE(session_.save(outside));
    ASSERT_TRUE(session_.save(inside));
    for (const fs::path& scene : {outside, inside}) {
        open(scene);
        EXPECT_EQ(announced(), 0);
    }
    fs::last_write_time(gltf_, fs::last_write_time(gltf_) + std::chrono::seconds(5)); // with the same content
    open(inside);
    EXPECT_EQ(announced(), 0) << "it has been read, and is the same";
    open(outside);
    EXPECT_EQ(announced(), 1);
    EXPECT_EQ(reload_source(), "Reloaded artist.glb: 0 changed, 0 new, 0 gone");
    session_.allow_outside = true;
    open(outside);
    EXPECT_EQ(announced(), 0);
}

// Textures, skins and animations are what they were, too.
TEST_F(EditorSessionSource, IsTheSameWhereNothingWasExported) {
    int models = 0;
    for (const char* model : {"Fox.glb", "FlightHelmet/FlightHelmet.gltf"}) {
        const fs::path path = fs::path(SUNFLECK_SOURCE_DIR "/../shared/assets") / model;
        if (!fs::exists(path))
            continue;
        ++models;
        open(path);
        const fs::path scene = folder_ / (path.stem().string() + ".scene.json");
        ASSERT_TRUE(session_.save(scene));
        open(scene);
        EXPECT_EQ(announced(), 0);
        const std::string file = path.filename().string();
        EXPECT_EQ(reload_source(), "Reloaded " + file + ": 0 changed, 0 new, 0 gone");
    }
    if (models == 0)
        GTEST_SKIP() << "the sample models are not there";
}

// Whatever a file says of its source costs no more than that.
TEST_F(EditorSessionSource, MayBeDamaged) {
    open(gltf_);
    ASSERT_TRUE(session_.save(folder_ / "room.scene.json"));
    auto opened = Document::open(folder_ / "room.scene.json");
    ASSERT_TRUE(opened);
    ASSERT_NE((*opened)->source(), nullptr);
    const nlohmann::json good = nlohmann::json::parse(*(*opened)->source());
    EXPECT_EQ(good.at("file"), "models/artist.glb");
    std::vector<std::string> texts{
        "",
        "{}",
        "[]",
        "null",
        R"({"file":1})",
        R"({"file":"a.glb","checksum":"","content":"["})",
        R"({"file":"a.glb","checksum":"","content":"[]"})",
        R"({"file":"a.glb","checksum":"","content":"{\"box\":3}"})",
        R"({"file":"a.glb","checksum":"","content":"{\"box\":{\"Transform\":{\"position\":3}}}"})"};
    for (const char* component : {"Transform", "MeshInstance", "mesh", "textures", "entity", "Material"})
        for (const nlohmann::json& bad : {nlohmann::json(1), nlohmann::json("x"), nlohmann::json::array({"x", "y"}),
                                          nlohmann::json::array({{{"a", 1}}, 2, 3, 4, 5, 6, 7, 8, 9})}) {
            nlohmann::json nodes = nlohmann::json::parse(good.at("content").get<std::string>());
            nodes["box"][component] = bad;
            nlohmann::json link = good;
            link["content"] = nodes.dump();
            texts.push_back(link.dump());
        }
    int refused = 0;
    ContentHashes hashes;
    for (const std::string& text : texts)
        refused += source_link_of(**opened, text, folder_.path, hashes) ? 0 : 1;
    EXPECT_GE(refused, 20);
    EXPECT_TRUE(source_link_of(**opened, good.dump(), folder_.path, hashes));
}

// Edits that go on from a file which is another now, or gone, are not thrown away by a click: it is said what can be
// done.
TEST_F(EditorSessionSource, UnsavedEditsWithoutTheirFileAreExplained) {
    for (const bool gone : {false, true}) {
        Recovered left;
        left.folder = folder_ / "left";
        fs::create_directories(left.folder);
        left.file = "room.scene.json";
        left.count = 1;
        left.edits = {"Move lamp"};
        left.user_file = gone ? UserFile::gone : UserFile::changed;
        session_.recovered = {left};
        session_.dialog = Dialog::recover;
        frames(3);
        EXPECT_NE(value("dialog/fit").find(gone ? "is gone" : "was changed since"), std::string::npos);
        EXPECT_EQ(value("dialog/Recover"), gone ? "disabled" : "");
        ASSERT_NO_FATAL_FAILURE(click("dialog/Later"));
        EXPECT_EQ(session_.dialog, Dialog::none);
        EXPECT_TRUE(fs::exists(left.folder));
    }
}

} // namespace
} // namespace sunfleck::editor
