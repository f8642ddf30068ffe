// Files that are opened and saved: what somebody has made is not lost without a question.
#include "tests/editor/panel_fixture.h"

#include "engine/core/file.h"
#include "engine/scene/simulation_components.h"

namespace sunfleck::editor {
namespace {

class EditorSession : public PanelTest {
protected:
    std::filesystem::path save_room(const std::string& name) {
        Document room;
        for (const scene::EntityTemplate& source : scene::entity_templates())
            add_from(room, source, vec3(1.0f), 1.0f);
        EXPECT_TRUE(room.save(folder_ / name));
        return folder_ / name;
    }
    // Frames until the file has been loaded; whether it has taken the document's place.
    bool finish_loading() {
        const int before = taken_;
        for (int tries = 0; tries < 3000 && session_.opening != nullptr && !session_.opening->finished(); ++tries)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        try_to_finish();
        return taken_ > before;
    }
    void try_to_finish() {
        session_.finish_opening([this](const Loaded& loaded) {
            ++taken_;
            session_.take(loaded.document);
        });
        frame();
    }
    void reload() {
        session_.reload_file();
        for (int tries = 0; tries < 3000 && !session_.can_reload(); ++tries) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            session_.take_news();
        }
        EXPECT_TRUE(session_.can_reload());
    }
    // A field of the material.
    static void edit(Document& document, const std::string& entity, const std::string& name, const std::string& value) {
        const Field* const found = material_field(document, entity, name);
        ASSERT_NE(found, nullptr);
        ASSERT_TRUE(edit_field(document, {document.find(entity)}, pool_of<scene::Material>(document), *found, value));
    }
    void edit(const std::string& entity, const std::string& name, const std::string& value) {
        edit(document(), entity, name, value);
    }
    std::string field(const std::string& entity, const std::string& name) {
        const Field* const found = material_field(document(), entity, name);
        return found == nullptr
                   ? "(not there)"
                   : field_to_text(*found, document().registry().try_get<scene::Material>(document().find(entity)));
    }
    static const Field* material_field(Document& document, const std::string& entity, const std::string& name) {
        const Entity known = document.find(entity);
        if (known.is_null() || !document.registry().has<scene::Material>(known))
            return nullptr;
        for (const Field& one : scene::Material::description().fields)
            if (one.name == name)
                return &one;
        return nullptr;
    }
    int taken_ = 0;
};

TEST_F(EditorSession, WhatLoadsTakesThePlaceOfWhatNobodyHasEdited) {
    const auto room = save_room("room.scene.json");
    session_.open(room);
    EXPECT_TRUE(finish_loading());
    EXPECT_EQ(document().path(), room);
    EXPECT_EQ(session_.opening, nullptr);
    session_.open(folder_ / "nothing.scene.json");
    EXPECT_FALSE(finish_loading());
    EXPECT_EQ(document().path(), room) << "what cannot be opened leaves the scene";
    EXPECT_NE(newest_message().find("nothing.scene.json"), std::string::npos) << newest_message();
}

// A door's name that is mistyped would open nothing, and nobody would know why.
TEST_F(EditorSession, ASaveSaysWhichNamesMeanNothing) {
    const auto messages = [&] {
        std::string all;
        for (const Message& message : session_.messages.all())
            all += message.text + "\n";
        return all;
    };
    add("Sliding door");
    const Entity eye = add("Light sensor");
    const auto& opens = *scene::LightSensor::description().find("opens");
    ASSERT_TRUE(edit_field(document(), {eye}, pool_of<scene::LightSensor>(document()), opens, " sliding door "));
    ASSERT_TRUE(session_.save(folder_ / "level.scene.json"));
    EXPECT_EQ(messages().find("names"), std::string::npos) << messages();
    ASSERT_TRUE(edit_field(document(), {eye}, pool_of<scene::LightSensor>(document()), opens, "sliding dor"));
    ASSERT_TRUE(session_.save(folder_ / "level.scene.json"));
    EXPECT_NE(messages().find("'sliding dor', which 'light sensor' names (opens), does not exist"), std::string::npos)
        << messages();
}

TEST_F(EditorSession, EditsMadeWhileAFileLoadsAreAskedAbout) {
    const auto room = save_room("room.scene.json");
    session_.open(room);
    const Entity box = add("Box");
    EXPECT_FALSE(finish_loading());
    EXPECT_EQ(session_.dialog, Dialog::unsaved);
    ASSERT_NO_FATAL_FAILURE(click("dialog/Cancel"));
    EXPECT_EQ(session_.dialog, Dialog::none);
    EXPECT_TRUE(document().exists(box)) << "the edit stays, and the file is not opened";
    EXPECT_TRUE(document().path().empty());

    // Asked before, when there was something to lose: whoever gave that up is not asked again.
    session_.open(room);
    EXPECT_EQ(session_.opening, nullptr);
    ASSERT_NO_FATAL_FAILURE(click("dialog/Discard"));
    ASSERT_NE(session_.opening, nullptr);
    EXPECT_TRUE(finish_loading());
    EXPECT_EQ(document().path(), room);

    // But for what was made since.
    add("Box");
    session_.open(room);
    ASSERT_NO_FATAL_FAILURE(click("dialog/Discard"));
    const Entity ball = add("Ball");
    EXPECT_FALSE(finish_loading());
    EXPECT_TRUE(document().exists(ball));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Discard"));
    EXPECT_FALSE(document().exists(ball));
    EXPECT_EQ(taken_, 2);
}

TEST_F(EditorSession, WhatHasLoadedWaitsForTheHandAndForOtherQuestions) {
    const auto room = save_room("room.scene.json");
    session_.open(room);
    document().begin("Drag");
    EXPECT_FALSE(finish_loading()) << "a drag is not cut off";
    EXPECT_EQ(session_.dialog, Dialog::none);
    document().commit();
    const Entity box = add("Box");
    session_.dialog = Dialog::save_as;
    try_to_finish();
    EXPECT_EQ(session_.dialog, Dialog::save_as) << "and neither is a name that is being typed";
    session_.dialog = Dialog::none;
    frame();
    try_to_finish();
    EXPECT_EQ(session_.dialog, Dialog::unsaved);
    EXPECT_TRUE(document().exists(box));
    EXPECT_EQ(taken_, 0);
}

TEST_F(EditorSession, ANewSceneIsNotReplacedByWhatStillLoads) {
    session_.open(save_room("room.scene.json"));
    ASSERT_NO_FATAL_FAILURE(run("File/New"));
    EXPECT_FALSE(finish_loading());
    EXPECT_EQ(document().entity_count(), 0u);
}

// By typing its name: the first press says what it would replace, and the second one does.
TEST_F(EditorSession, SaveAsReplacesAnotherSceneWhenAskedTwice) {
    const auto mine = folder_ / "mine.scene.json", room = save_room("room.scene.json");
    const std::string theirs = read_file(room).value(), geometry = read_file(folder_ / "room.glb").value();
    add("Box");
    EXPECT_FALSE(document().save(room)) << "without a question it is not replaced at all";
    ASSERT_TRUE(session_.save(mine));
    const auto name = [&](const std::string& path) {
        ASSERT_NO_FATAL_FAILURE(click("dialog/name"));
        key("Ctrl+A");
        type(path);
    };
    add("Ball");
    ASSERT_NO_FATAL_FAILURE(run("File/Save as..."));
    ASSERT_NO_FATAL_FAILURE(name(room.string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    EXPECT_NE(value("dialog/problem").find("'room.scene.json' exists"), std::string::npos) << value("dialog/problem");
    EXPECT_EQ(read_file(room).value(), theirs);

    // Another name in between, or the dialog closed: that is not the second time.
    ASSERT_NO_FATAL_FAILURE(name((folder_ / "mine.txt").string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    ASSERT_NO_FATAL_FAILURE(name(room.string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    ASSERT_NO_FATAL_FAILURE(run("File/Save as..."));
    ASSERT_NO_FATAL_FAILURE(name(room.string()));
    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    EXPECT_EQ(read_file(room).value(), theirs);
    EXPECT_EQ(read_file(folder_ / "room.glb").value(), geometry);
    EXPECT_EQ(document().path(), mine);

    ASSERT_NO_FATAL_FAILURE(click("dialog/Save"));
    EXPECT_EQ(session_.dialog, Dialog::none) << value("dialog/problem");
    EXPECT_EQ(document().path(), room);
    EXPECT_NE(read_file(room).value(), theirs);

    // Its own file is replaced at once, however its name is written.
    add("Ball");
    EXPECT_TRUE(session_.save(folder_ / "../" / folder_.path.filename() / "room.scene.json"));
    EXPECT_FALSE(document().unsaved());
}

// The scene was made of a glTF file and saved; then others write both files.
TEST_F(EditorSession, ReloadTakesOverWhatOthersWroteIntoEitherFile) {
    const auto first = save_room("first.scene.json"), room = folder_ / "room.scene.json";
    session_.open(folder_ / "first.glb");
    ASSERT_TRUE(finish_loading());
    edit("box", "roughness", "0.25");
    ASSERT_TRUE(session_.save(room));

    const auto by_others = [](const std::filesystem::path& file, const std::string& entity, const std::string& field,
                              const std::string& value) {
        const bool is_export = file.filename() == "first.scene.json";
        auto theirs = Document::open(file);
        ASSERT_TRUE(theirs);
        edit(**theirs, entity, field, value);
        (*theirs)->begin("Set");
        EXPECT_TRUE((*theirs)->set_setting("bounces", "2"));
        (*theirs)->commit();
        if (is_export) // or the geometry would get another name
            for (const char* written : {"first.scene.json", "first.glb"})
                std::filesystem::remove(file.parent_path() / written);
        ASSERT_TRUE((*theirs)->save(file));
    };
    by_others(room, "ball", "roughness", "0.125");
    session_.take_news();
    EXPECT_NE(newest_message().find("room.scene.json' was changed"), std::string::npos) << newest_message();
    by_others(first, "floor", "roughness", "0.375");
    session_.take_news();
    EXPECT_NE(newest_message().find("first.glb' was changed"), std::string::npos) << newest_message();
    const std::string theirs = read_file(room).value();
    EXPECT_FALSE(session_.save(room)) << "what others wrote is not replaced unasked";

    reload();
    EXPECT_EQ(field("box", "roughness"), "0.25") << "edits stay";
    EXPECT_EQ(field("ball", "roughness"), "0.125");
    EXPECT_EQ(field("floor", "roughness"), "0.375");
    EXPECT_EQ(document().settings().get("bounces"), "2");
    EXPECT_TRUE(document().unsaved());
    EXPECT_EQ(read_file(room).value(), theirs);

    // Again, of one alone: the other is as it was.
    by_others(room, "ball", "roughness", "0.5");
    session_.take_news();
    reload();
    EXPECT_EQ(field("ball", "roughness"), "0.5");
    by_others(first, "floor", "roughness", "0.75");
    EXPECT_FALSE(document().file_changed());
    reload();
    EXPECT_EQ(field("floor", "roughness"), "0.75");
    EXPECT_TRUE(session_.save(room)) << newest_message();
}

// Each time before it was undone.
TEST_F(EditorSession, WhatReloadTookOverAndWasUndoneCanBeTakenOverAgain) {
    const auto room = save_room("room.scene.json");
    session_.open(room);
    ASSERT_TRUE(finish_loading());
    auto theirs = Document::open(room);
    ASSERT_TRUE(theirs);
    edit(**theirs, "ball", "roughness", "0.125");
    ASSERT_TRUE((*theirs)->save(room));
    const std::string before = field("ball", "roughness");
    for (int i = 0; i < 3; ++i) {
        reload();
        EXPECT_EQ(field("ball", "roughness"), "0.125");
        ASSERT_TRUE(document().undo());
        EXPECT_EQ(field("ball", "roughness"), before);
        edit("box", "roughness", i == 0 ? "0.5" : i == 1 ? "0.25" : "0.125"); // nothing is left to be redone
    }
    reload();
    edit("ball", "roughness", "0.75");
    reload();
    EXPECT_EQ(field("ball", "roughness"), "0.75") << "the file is as it was read";
}

// Of a scene that came from a glTF file the geometry's name is taken; Enter takes the name that is proposed.
TEST_F(EditorSession, TheNameThatIsProposedIsFree) {
    save_room("room.scene.json");
    std::filesystem::remove(folder_ / "room.scene.json");
    const std::string geometry = read_file(folder_ / "room.glb").value();
    for (const char* name : {"room 2.scene.json", "room 3.scene.json"}) {
        session_.open(folder_ / "room.glb");
        ASSERT_TRUE(finish_loading());
        add("Box");
        ASSERT_NO_FATAL_FAILURE(key("Ctrl+S"));
        frames(3);
        EXPECT_EQ(value("dialog/name"), name);
        ASSERT_NO_FATAL_FAILURE(key("Enter"));
        frames(2);
        EXPECT_EQ(session_.dialog, Dialog::none) << value("dialog/problem");
        EXPECT_EQ(document().path(), folder_ / name);
        EXPECT_FALSE(document().unsaved());
    }
    EXPECT_EQ(read_file(folder_ / "room.glb").value(), geometry);
    ASSERT_NO_FATAL_FAILURE(run("File/Save as..."));
    frames(3);
    EXPECT_EQ(value("dialog/name"), "room 3.scene.json") << "its own";
}

TEST_F(EditorSession, WhatLoadsIsNamedAndCanBeLeft) {
    const Entity box = add("Box");
    session_.opening = std::make_unique<Opening>(
        folder_ / "palace.glb",
        Opening::Load([](const std::function<bool(float)>& progress) -> Result<std::unique_ptr<Document>> {
            while (progress(0.5f))
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            return Error{"cancelled"};
        }),
        [] {});
    frames(3);
    EXPECT_EQ(value("status/loading"), "Loading palace.glb");
    ASSERT_NO_FATAL_FAILURE(click("status/Cancel"));
    EXPECT_EQ(session_.opening, nullptr);
    frames(2);
    EXPECT_EQ(find("status/loading"), nullptr);
    EXPECT_EQ(newest_message(), "'palace.glb' was not opened");
    EXPECT_TRUE(document().exists(box));
}

TEST_F(EditorSession, RecentFilesAreListedOnce) {
    const std::string a = (folder_ / "a.scene.json").string(), b = (folder_ / "b.scene.json").string();
    add("Box");
    ASSERT_TRUE(session_.save(a));
    ASSERT_TRUE(session_.save(b));
    ASSERT_TRUE(session_.save(a, Replace::any));
    EXPECT_EQ(session_.recent_files, (std::vector<std::string>{a, b}));
    session_.open(b);
    EXPECT_TRUE(finish_loading());
    EXPECT_EQ(session_.recent_files, (std::vector<std::string>{b, a}));
}

} // namespace
} // namespace sunfleck::editor
