// What a save and a recovery keep that is in no described value: animations, textures, pictures of the sky; and edits
// that go on from a file which is another now.
#include "tests/editor/journal_fixture.h"

#include "engine/scene/animation.h"
#include "engine/scene/deformation.h"

#include <chrono>

namespace sunfleck::editor {
namespace {

const fs::path sky_source = SUNFLECK_SOURCE_DIR "/tests/corpus/image/two.hdr";

class EditorJournalKeeps : public EditorJournal {
protected:
    static Entity add_sky(Document& document, const std::string& file) {
        const Entity sky = add_from(document, scene::entity_templates()[0], vec3(0.0f), 1.0f);
        for (const char* component : {"Environment", "EnvironmentMap"})
            add_component(document, {sky}, *find_component(document, component));
        set_file(document, sky, file);
        return sky;
    }
    static void set_file(Document& document, Entity sky, const std::string& file) {
        ecs::PoolBase& pool = *find_component(document, "EnvironmentMap");
        EXPECT_TRUE(edit_field(document, {sky}, pool, *pool.description()->find("file"), file));
    }
    static void turn(Document& document, Entity sky, const char* angle) {
        ecs::PoolBase& pool = *find_component(document, "EnvironmentMap");
        EXPECT_TRUE(edit_field(document, {sky}, pool, *pool.description()->find("rotation"), angle));
    }
    static const scene::EnvironmentMap& sky_in(Document& document) {
        const scene::EnvironmentMap* found = nullptr;
        document.registry().view<scene::EnvironmentMap>().each(
            [&](Entity, const scene::EnvironmentMap& map) { found = &map; });
        static const scene::EnvironmentMap none;
        EXPECT_NE(found, nullptr);
        return found != nullptr ? *found : none;
    }
    // What the next run finds after edits that nobody saved.
    Recovered recovered_edits(const std::shared_ptr<Document>& document, const std::function<void()>& edits) {
        {
            ChangeCollector collector;
            Recovery recovery(folder_ / "recovery");
            recovery.change(*collector.collect(document));
            recovery.saved(document->path().string());
            for (int tries = 0; tries < 5000 && !fs::exists(own_folder() / "base.json"); ++tries)
                ::usleep(1000);
            edits();
            recovery.change(*collector.collect(document));
            recovery.unsaved(document->path().string(), {"edit"}, 1);
            recovery.leave();
        }
        const std::vector<Recovered> left = Recovery::left_behind(folder_ / "recovery");
        EXPECT_EQ(left.size(), 1u);
        return left.empty() ? Recovered() : left[0];
    }
};

// As long as a name is that of a picture, the picture is seen, saved and recovered; else one message says so.
TEST_F(EditorJournalKeeps, PicturesOfTheSky) {
    fs::copy_file(sky_source, folder_ / "dusk.hdr");
    auto document = open();
    const Entity sky = add_sky(*document, "dusk.hdr");
    ASSERT_NE(sky_in(*document).image, nullptr);
    EXPECT_TRUE(document->take_remarks().empty());
    set_file(*document, sky, "dawn.hdr");
    EXPECT_EQ(sky_in(*document).image, nullptr);
    EXPECT_EQ(document->take_remarks().size(), 1u);
    turn(*document, sky, "0.5");
    EXPECT_TRUE(document->take_remarks().empty()) << "it has been said";
    ASSERT_TRUE(document->save(folder_ / "room.scene.json"));
    document = open();
    ASSERT_NE(document, nullptr) << "a name that was mistyped costs no scene";
    EXPECT_EQ(document->notes().size(), 1u);
    EXPECT_EQ(sky_in(*document).file, "dawn.hdr");
}

TEST_F(EditorJournalKeeps, PicturesOfTheSkyThroughUndo) {
    fs::copy_file(sky_source, folder_ / "dusk.hdr");
    const auto document = open();
    const Entity sky = add_sky(*document, "summer_sky");
    const auto made = sky_in(*document).image;
    ASSERT_NE(made, nullptr);
    set_file(*document, sky, "dusk.hdr");
    const auto read = sky_in(*document).image;
    ASSERT_NE(read, nullptr);
    EXPECT_NE(read, made);
    set_file(*document, sky, "");
    EXPECT_EQ(sky_in(*document).image, nullptr);
    document->undo();
    EXPECT_EQ(sky_in(*document).image, read);
    document->undo();
    EXPECT_EQ(sky_in(*document).image, made);
}

// A picture of the same name that was painted over is another one on request, and undo brings the first back.
TEST_F(EditorJournalKeeps, PicturesOfTheSkyThatArePaintedOver) {
    fs::copy_file(sky_source, folder_ / "dusk.hdr");
    const auto document = open();
    add_sky(*document, "dusk.hdr");
    const auto before = sky_in(*document).image;
    ASSERT_NE(before, nullptr);
    const std::size_t edits = document->history().entries().size();
    EXPECT_EQ(document->read_skies_again(), 0u);
    EXPECT_EQ(document->history().entries().size(), edits) << "nothing was painted";
    ASSERT_TRUE(io::write_picture(folder_ / "new.exr", io::Picture{4, 2, std::vector<vec4>(8, vec4(0.5f))}));
    fs::rename(folder_ / "new.exr", folder_ / "dusk.hdr"); // the kind is told by the content
    EXPECT_EQ(document->read_skies_again(), 1u);
    EXPECT_EQ(sky_in(*document).image->width(), 4u);
    EXPECT_TRUE(document->take_remarks().empty());
    document->undo();
    EXPECT_EQ(sky_in(*document).image, before);
    document->redo();
    fs::remove(folder_ / "dusk.hdr");
    EXPECT_EQ(document->read_skies_again(), 0u) << "what is seen stays";
    EXPECT_EQ(sky_in(*document).image->width(), 4u);
}

// Saved elsewhere, even under a name that leads out of the scene's folder, it opens there.
TEST_F(EditorJournalKeeps, PicturesOfTheSkyInOtherFolders) {
    for (const bool far : {false, true}) {
        fs::create_directories(folder_ / "far");
        fs::copy_file(sky_source, folder_ / (far ? "far/noon.hdr" : "dusk.hdr"));
        const auto document = open();
        add_sky(*document, far ? (folder_ / "far" / "noon.hdr").string() : "dusk.hdr");
        const fs::path other = folder_ / (far ? "other" : "another");
        fs::create_directories(other);
        ASSERT_TRUE(document->save(other / "room.scene.json"));
        auto opened = Document::open(other / "room.scene.json");
        ASSERT_TRUE(opened) << opened.error().message;
        EXPECT_TRUE((*opened)->notes().empty());
        EXPECT_EQ(sky_in(**opened).file, far ? "noon.hdr" : "dusk.hdr");
        EXPECT_NE(sky_in(**opened).image, nullptr);
    }
}

// A picture that was named before the crash is there after it, even if its file is gone.
TEST_F(EditorJournalKeeps, PicturesOfTheSkyAfterACrash) {
    fs::copy_file(sky_source, folder_ / "dusk.hdr");
    const auto document = open();
    const Recovered left = recovered_edits(document, [&] { add_sky(*document, "dusk.hdr"); });
    fs::remove(folder_ / "dusk.hdr");
    auto found = Recovery::load(left);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE((*found)->notes().empty()) << (*found)->notes()[0];
    ASSERT_NE(sky_in(**found).image, nullptr);
    EXPECT_EQ(sky_in(**found).image->texels(), sky_in(*document).image->texels());
    Recovery::discard(left);
    fs::create_directories(folder_ / "new");
    ASSERT_TRUE((*found)->save(folder_ / "new" / "room.scene.json"));
    EXPECT_EQ(read_file(folder_ / "new" / "dusk.hdr").value(), read_file(sky_source).value());
}

// The same, from the journal alone.
TEST_F(EditorJournalKeeps, PicturesOfTheSkyInTheJournal) {
    fs::copy_file(sky_source, folder_ / "dusk.hdr");
    auto document = open();
    add_sky(*document, "summer_sky");
    ASSERT_TRUE(document->save(folder_ / "room.scene.json"));
    document = open();
    const Recovered left = recovered_edits(document, [&] {
        const Entity sky = find_component(*document, "EnvironmentMap")->entities()[0];
        set_file(*document, sky, "dusk.hdr");
        turn(*document, sky, "1");
    });
    fs::remove(left.folder / "about.json");
    const std::vector<Recovered> again = Recovery::left_behind(folder_ / "recovery");
    ASSERT_EQ(again.size(), 1u);
    EXPECT_EQ(again[0].user_file, UserFile::as_it_was);
    auto found = Recovery::load(again[0]);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_NE(sky_in(**found).image, nullptr);
    EXPECT_EQ(sky_in(**found).file, "dusk.hdr");
    EXPECT_EQ(sky_in(**found).image->texels(), sky_in(*document).image->texels());
}

// The journal alone is left, and the file that it goes on from is another one: nothing is removed unasked.
TEST_F(EditorJournalKeeps, EditsOfAFileThatIsAnotherNow) {
    edit_and_die(7, 8, 0);
    const auto look = [&] {
        std::error_code code;
        for (const fs::path& run : folder_content(folder_ / "recovery", code))
            fs::remove(run / "about.json", code);
        return Recovery::left_behind(folder_ / "recovery");
    };
    const std::shared_ptr<Document> wanted = open();
    tests::RandomEdits edits(*wanted, 7);
    for (int i = 0; i < 8; ++i)
        edits.once();
    std::vector<Recovered> left = look();
    ASSERT_EQ(left.size(), 1u);
    EXPECT_EQ(left[0].user_file, UserFile::as_it_was);

    // Written again, with the same content.
    ASSERT_TRUE(write_file(folder_ / "room.scene.json", read_file(folder_ / "room.scene.json").value() + "\n"));
    left = look();
    ASSERT_EQ(left.size(), 1u);
    EXPECT_EQ(left[0].user_file, UserFile::changed);
    left[0].made = std::make_shared<Replayed>();
    auto found = Recovery::load(left[0]);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(left[0].made->complete);
    EXPECT_EQ(content(**found), content(*wanted)) << first_difference(content(**found), content(*wanted));

    // Emptied by somebody else: what was edited there has no place any more.
    const std::shared_ptr<Document> theirs = open();
    remove(*theirs, theirs->roots());
    ASSERT_TRUE(theirs->save(folder_ / "room.scene.json"));
    left = look();
    ASSERT_EQ(left.size(), 1u);
    EXPECT_EQ(left[0].user_file, UserFile::changed);
    left[0].made = std::make_shared<Replayed>();
    found = Recovery::load(left[0]);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_FALSE(left[0].made->complete);
    EXPECT_LT(left[0].made->names.size(), left[0].count);
    for (const Entity entity : (*found)->registry().entities())
        EXPECT_TRUE((*found)->exists(entity)) << "no pieces of what is not there";

    fs::remove(folder_ / "room.scene.json");
    left = look();
    ASSERT_EQ(left.size(), 1u) << "they are kept until somebody puts the file back, or gives them up";
    EXPECT_EQ(left[0].user_file, UserFile::gone);
    EXPECT_FALSE(Recovery::load(left[0]));
    EXPECT_TRUE(fs::exists(left[0].folder));
}

// Opened, saved, opened again, and after a crash: the fox still runs.
TEST_F(EditorJournalKeeps, Animations) {
    const fs::path fox = SUNFLECK_SOURCE_DIR "/../shared/assets/Fox.glb";
    if (!fs::exists(fox))
        GTEST_SKIP() << "the sample model is not there";
    auto opened = Document::open(fox);
    ASSERT_TRUE(opened) << opened.error().message;
    const std::shared_ptr<Document> document = std::move(*opened);
    const auto count = [](Document& of) {
        return std::array{of.registry().count<scene::Animation>(), of.registry().count<scene::Deformation>(),
                          of.registry().count<scene::OtherAnimations>()};
    };
    const auto wanted = count(*document);
    EXPECT_GT(wanted[0], 0u);
    EXPECT_GT(wanted[1], 0u);
    EXPECT_GT(wanted[2], 0u) << "it also walks and looks about";
    ASSERT_TRUE(document->save(folder_ / "fox.scene.json"));
    auto again = Document::open(folder_ / "fox.scene.json");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(count(**again), wanted);
    const std::shared_ptr<Document> second = std::move(*again);
    const Recovered left =
        recovered_edits(second, [&] { ASSERT_TRUE(rename(*second, second->roots()[0], "renamed")); });
    auto found = Recovery::load(left);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(count(**found), wanted);
}

// By both who save: each texture is encoded once, and files are the same as if each were encoded anew.
TEST_F(EditorJournalKeeps, TexturesAreEncodedOnce) {
    const auto document = open();
    std::mt19937 random(3);
    const auto add = [&] {
        scene::Texture texture;
        texture.width = texture.height = 512;
        texture.pixels.resize(std::size_t(512) * 512 * 4);
        for (std::uint8_t& byte : texture.pixels)
            byte = std::uint8_t(random());
        document->texture_store().add(std::move(texture));
    };
    const auto save = [&](const char* name) {
        fs::create_directories(folder_ / name);
        const auto began = std::chrono::steady_clock::now();
        EXPECT_TRUE(document->save(folder_ / name / "room.scene.json"));
        const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
        std::printf("save of %u textures: %.0f ms\n", document->textures().size(), ms);
        return read_file(folder_ / name / "room.glb").value();
    };
    for (int i = 0; i < 24; ++i)
        add();
    const std::string first = save("first");
    EXPECT_EQ(document->encoded_textures()->encoded(), 24u);
    EXPECT_EQ(save("second"), first);
    EXPECT_EQ(document->encoded_textures()->encoded(), 24u);
    add();
    const std::string more = save("third");
    EXPECT_EQ(document->encoded_textures()->encoded(), 25u);
    ASSERT_TRUE(io::export_gltf(folder_ / "anew.glb", document->registry(), document->meshes(), document->textures()));
    EXPECT_EQ(more, read_file(folder_ / "anew.glb").value());
    const Recovered left = recovered_edits(
        document, [&] { add_component(*document, {document->roots()[0]}, *find_component(*document, "Exposure")); });
    EXPECT_TRUE(Recovery::load(left));
    EXPECT_EQ(document->encoded_textures()->encoded(), 25u) << "whoever saves a copy has them, too";
}

} // namespace
} // namespace sunfleck::editor
