// What the viewport shows: the picture that `sunfleck render` draws of the saved file, and, after edits that light
// follows behind the frames, that of a start with the edited scene.
#include "editor/document/picking.h"
#include "engine/core/file.h"
#include "engine/io/image.h"
#include "engine/scene/simulation_components.h"
#include "tests/editor/editor_scene.h"
#include "tests/support/techniques.h"

namespace sunfleck::editor {
namespace {

TEST_F(EditorScene, ShowsWhatRenderDraws) {
    for (std::uint32_t seed = 1; seed <= by_size(3u, 200u); ++seed) {
        if (!tests::in_part(seed))
            continue;
        SCOPED_TRACE("seed " + std::to_string(seed));
        const std::shared_ptr<Document> document = open_scene();
        ASSERT_NE(document, nullptr);
        tests::RandomEdits edits(*document, seed);
        for (std::uint32_t left = edits.below(12); left > 0; --left)
            edits.once();
        const fs::path file = folder_ / "edited.scene.json", drawn = folder_ / "drawn.png";
        ASSERT_TRUE(document->save(file, Replace::any));
        const Picture shown = from_nothing(document);
        ASSERT_NE(shown, nullptr);
        const tests::Outcome outcome = tests::shell(std::string(SUNFLECK_TOOL) + " render " + file.string() + " -o " +
                                                    drawn.string() + " --size " + std::to_string(width) + "x" +
                                                    std::to_string(height) + " --camera=" + camera_text);
        ASSERT_EQ(outcome.status, 0) << outcome.output;
        // Both by way of a file: what is read from one is no longer the bytes of the picture.
        ASSERT_TRUE(io::write_picture(folder_ / "shown.png", *shown->pixels));
        const auto wanted = io::read_picture(drawn), found = io::read_picture(folder_ / "shown.png");
        ASSERT_TRUE(wanted && found);
        EXPECT_EQ(differing(*found, *wanted), 0u);
    }
}

// Frames that only refine light wait while somebody does something, and then go on until all of it is refined.
TEST_F(EditorScene, LightIsRefinedWhileTheHandRests) {
    if (!tests::has_technique("light_samples"))
        GTEST_SKIP() << "it is what light is refined by";
    const std::shared_ptr<Document> document = open_scene();
    ASSERT_NE(document, nullptr);
    SceneThread scene(tests::device(), [] {});
    SceneChange change = ChangeCollector::everything(document);
    change.settings->baked_samples = 1000;
    scene.note_hand();
    scene.change(std::move(change));
    scene.show(view(*document));
    const auto waiting = [&] {
        const Picture picture = scene.picture();
        return picture != nullptr ? picture->statistics.counters["refined_light_waiting"] : 0.0;
    };
    std::uint64_t frames = 0, unchanged = 0;
    for (int i = 0; i < 1000 && unchanged < 20; ++i) { // until the frames of the edit have been drawn
        scene.note_hand();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        const std::uint64_t now = scene.status().frames;
        unchanged = now > 0 && now == frames ? unchanged + 1 : 0;
        frames = now;
    }
    ASSERT_EQ(unchanged, 20u);
    EXPECT_GT(waiting(), 0.0);
    EXPECT_TRUE(scene.busy()) << "there is something left to do";
    EXPECT_FALSE(scene.picture()->settled);
    ASSERT_NE(settled(scene, *document), nullptr);
    EXPECT_EQ(waiting(), 0.0);
    EXPECT_GT(scene.status().frames, frames);
}

// A body is dropped into the room, falls while it plays, and hangs where it was edited when play ends: the same
// picture, bit for bit, and the document has heard nothing of it.
TEST_F(EditorScene, PlayLeavesThePictureAsItWas) {
    const std::shared_ptr<Document> document = open_scene();
    ASSERT_NE(document, nullptr);
    const auto templates = scene::entity_templates();
    const auto box =
        std::find_if(templates.begin(), templates.end(), [](const auto& one) { return one.name == "Box"; });
    ASSERT_NE(box, templates.end());
    const Entity body = add_from(*document, *box, vec3(2.0f, 4.0f, 2.0f), 0.8f);
    scene::Mover at_rest;
    at_rest.path = scene::MoverPath::none;
    document->begin("Make it fall");
    document->set(body, pool_of<scene::Mover>(*document), std::make_shared<scene::Mover>(at_rest));
    document->set(body, pool_of<scene::RigidBody>(*document), std::make_shared<scene::RigidBody>());
    document->commit();
    ASSERT_TRUE(document->save(folder_ / "before.scene.json"));
    const std::string saved = read_file(folder_ / "before.scene.json").value();

    SceneThread scene(tests::device(), [] {});
    scene.change(ChangeCollector::everything(document));
    ViewRequest request = view(*document);
    scene.show(request);
    const Picture before = settled(scene, *document);
    ASSERT_NE(before, nullptr);
    request.playing = request.paused = true;
    scene.show(request);
    scene.step(40);
    const Picture fallen = wait_for(scene, [](const ScenePicture& picture) {
        return picture.settled && picture.pixels != nullptr && picture.step == 40;
    });
    ASSERT_NE(fallen, nullptr);
    EXPECT_GT(differing(*fallen->pixels, *before->pixels), width * height / 100u) << "it has fallen";
    // A click meets it where the picture shows it.
    EXPECT_EQ(before->played, nullptr);
    ASSERT_NE(fallen->played, nullptr);
    const mat4* const place = fallen->played->find(body);
    ASSERT_NE(place, nullptr);
    // On the block, 0.3 m below: a ray that meets its lower half passes under where it was edited to be.
    const vec3 in_front = vec3((*place)[3]) + vec3(0.0f, -0.3f, 3.0f), ahead(0.0f, 0.0f, -1.0f);
    EXPECT_LT(in_front.y, 3.55f);
    EXPECT_EQ(pick(*document, in_front, ahead, {}, fallen->played.get()).entity, body);
    EXPECT_NE(pick(*document, in_front, ahead).entity, body);
    request.paused = false; // in real time
    scene.show(request);
    ASSERT_NE(wait_for(scene, [](const ScenePicture& picture) { return picture.step > 60; }), nullptr);
    request.playing = false;
    scene.show(request);
    const Picture after = wait_for(scene, [](const ScenePicture& picture) {
        return picture.settled && picture.pixels != nullptr && picture.step == 0;
    });
    ASSERT_NE(after, nullptr);
    EXPECT_EQ(differing(*after->pixels, *before->pixels), 0u);
    fs::create_directories(folder_ / "after");
    ASSERT_TRUE(document->save(folder_ / "after/before.scene.json"));
    EXPECT_EQ(read_file(folder_ / "after/before.scene.json").value(), saved);
}

// Light is made behind the frames wherever frames that make it take half as long again as those that do not.
TEST_F(EditorScene, LightFollowsBehindTheFrames) {
    SceneThread scene(tests::device(), [] {});
    ChangeCollector collector;
    const std::shared_ptr<Document> document = show_room(scene, collector);
    ASSERT_NE(document, nullptr);
    const Picture before = settled(scene, *document);
    ASSERT_NE(before, nullptr);
    const std::uint64_t builds = scene.status().builds;

    // Three edits of something static, the last two in quick succession.
    ecs::PoolBase& transforms = pool_of<scene::Transform>(*document);
    const Entity block = document->find("short block");
    ASSERT_TRUE(document->exists(block));
    for (const char* place : {"3.4,0.825,3.9", "3,0.825,4", "2.5,0.825,4.5"}) {
        ASSERT_TRUE(edit_field(*document, {block}, transforms, transforms.description()->fields[0], place));
        scene.change(*collector.collect(document));
        const Picture first =
            wait_for(scene, [&](const ScenePicture& picture) { return picture.revision == document->revision(); });
        ASSERT_NE(first, nullptr);
        EXPECT_FALSE(first->settled) << "shown at once, in the old light";
    }
    const Picture after = settled(scene, *document);
    ASSERT_NE(after, nullptr);
    EXPECT_EQ(scene.status().builds, builds + 1) << "edits cancelled what they made useless";
    const Picture fresh = from_nothing(document);
    ASSERT_NE(fresh, nullptr);
    EXPECT_EQ(differing(*after->pixels, *fresh->pixels), 0u);
    EXPECT_GT(differing(*after->pixels, *before->pixels), width * height / 100u);
}

// While light is under way, an edit cancels it; where it was ready sooner, it is tried again.
TEST_F(EditorScene, ANewEditCancelsLightThatIsOnItsWay) {
    SceneThread scene(tests::device(), [] {});
    ChangeCollector collector;
    const std::shared_ptr<Document> document = show_room(scene, collector);
    ASSERT_NE(document, nullptr);
    EXPECT_EQ(scene.status().cancelled, 0u);
    ecs::PoolBase& transforms = pool_of<scene::Transform>(*document);
    const Entity block = document->find("short block");
    ASSERT_TRUE(document->exists(block));
    const auto move = [&](int step) {
        const std::string place = std::to_string(2.5 + 0.1 * step) + ",0.825,4";
        ASSERT_TRUE(edit_field(*document, {block}, transforms, transforms.description()->fields[0], place));
        scene.change(*collector.collect(document));
    };
    for (int tries = 0; tries < 6 && scene.status().cancelled == 0; ++tries) {
        move(2 * tries);
        for (const auto end = Clock::now() + std::chrono::seconds(20); Clock::now() < end;)
            if (const SceneStatus status = scene.status(); status.building && status.share > 0.0f)
                break;
        move(2 * tries + 1);
        ASSERT_NE(settled(scene, *document), nullptr);
    }
    EXPECT_GT(scene.status().cancelled, 0u);
    const Picture after = settled(scene, *document), fresh = from_nothing(document);
    ASSERT_TRUE(after && fresh);
    EXPECT_EQ(differing(*after->pixels, *fresh->pixels), 0u) << "nothing of it is left";
}

// Light follows edits of a lamp in its samples as they are; once it is left alone, it has those of a start.
TEST_F(EditorScene, LampsThatWereEditedAreAsAStartShowsThem) {
    SceneThread scene(tests::device(), [] {});
    ChangeCollector collector;
    const std::shared_ptr<Document> document = show_room(scene, collector);
    ASSERT_NE(document, nullptr);
    const Entity lamp = document->find("lamp");
    ASSERT_TRUE(document->exists(lamp));
    ecs::PoolBase& lamps = pool_of<scene::AreaLight>(*document);
    const Field* radiance = lamps.description()->find("radiance");
    ASSERT_NE(radiance, nullptr);
    const auto is_as_a_start = [&] {
        if (auto change = collector.collect(document))
            scene.change(std::move(*change));
        const Picture edited = settled(scene, *document), fresh = from_nothing(document);
        ASSERT_TRUE(edited && fresh);
        EXPECT_EQ(differing(*edited->pixels, *fresh->pixels), 0u);
    };
    for (const char* value : {"8,8,8", "4,6,2"}) {
        SCOPED_TRACE(value);
        ASSERT_TRUE(edit_field(*document, {lamp}, lamps, *radiance, value));
        ASSERT_NO_FATAL_FAILURE(is_as_a_start());
    }
    SCOPED_TRACE("its mesh shines, and no lamp"); // another kind of light from the same entity
    remove_component(*document, {lamp}, lamps);
    ASSERT_NO_FATAL_FAILURE(is_as_a_start());
}

// Shadows of what is dragged wait for the hand to rest. However the gesture ends, the picture is then that of a start
// with the document.
TEST_F(EditorScene, DraggingLeavesNoTrace) {
    const std::shared_ptr<Document> document = open_scene();
    ASSERT_NE(document, nullptr);
    SceneThread scene(tests::device(), [] {});
    ChangeCollector collector;
    scene.change(*collector.collect(document));
    scene.show(view(*document));
    ecs::PoolBase& transforms = pool_of<scene::Transform>(*document);
    const Entity block = document->find("short block");
    ASSERT_TRUE(document->exists(block));
    const auto drag = [&](vec3 step) {
        document->begin("Move block");
        auto place = document->registry().get<scene::Transform>(block);
        for (int i = 0; i < 3; ++i) {
            place.position += step;
            document->set(block, transforms, std::make_shared<scene::Transform>(place));
            scene.change(*collector.collect(document));
            const Picture moved =
                wait_for(scene, [&](const ScenePicture& picture) { return picture.revision == document->revision(); });
            ASSERT_NE(moved, nullptr);
            EXPECT_FALSE(moved->settled);
        }
    };
    const auto end = [&] {
        if (auto change = collector.collect(document))
            scene.change(std::move(*change));
    };
    const struct {
        const char* name;
        std::function<void()> make;
        bool moved; // since it began, in the document
    } endings[] = {{"the button is let go", [&] { document->commit(); }, true},
                   {"Escape", [&] { document->cancel(); }, false},
                   {"undo, also of the first drag", [&] { document->undo(); }, true},
                   {"it is deleted", [&] { remove(*document, {block}); }, true}};
    for (const auto& ending : endings) {
        SCOPED_TRACE(ending.name);
        const Picture old = settled(scene, *document);
        ASSERT_NE(old, nullptr);
        drag(vec3(0.1f, 0.0f, 0.1f));
        ending.make();
        end();
        const Picture after = settled(scene, *document);
        ASSERT_NE(after, nullptr);
        const Picture fresh = from_nothing(document);
        ASSERT_NE(fresh, nullptr);
        EXPECT_EQ(differing(*after->pixels, *fresh->pixels), 0u);
        EXPECT_EQ(differing(*after->pixels, *old->pixels) > width * height / 100u, ending.moved);
    }
}

// A hand that rests without letting go gets shadows and light, too.
TEST_F(EditorScene, LightFollowsAHandThatRests) {
    SceneThread scene(tests::device(), [] {});
    ChangeCollector collector;
    const std::shared_ptr<Document> document = show_room(scene, collector);
    ASSERT_NE(document, nullptr);
    const Entity block = document->find("short block");
    ASSERT_TRUE(document->exists(block));
    document->begin("Move block");
    auto place = document->registry().get<scene::Transform>(block);
    place.position.x += 0.4f;
    document->set(block, pool_of<scene::Transform>(*document), std::make_shared<scene::Transform>(place));
    scene.change(*collector.collect(document));
    const Picture resting = settled(scene, *document);
    ASSERT_NE(resting, nullptr);
    document->commit();
    EXPECT_EQ(document->history().entries().size(), 1u);
    const auto end = collector.collect(document);
    ASSERT_TRUE(end) << "the end of a drag is told";
    EXPECT_TRUE(end->is_empty());
    EXPECT_FALSE(collector.collect(document));
    scene.change(*end);
    const Picture fresh = from_nothing(document);
    ASSERT_NE(fresh, nullptr);
    EXPECT_EQ(differing(*resting->pixels, *fresh->pixels), 0u);
}

// More was added than the copy has room for: it asks for everything, and shows what was added.
TEST_F(EditorScene, ADocumentThatGrowsIsFollowed) {
    SceneThread scene(tests::device(), [] {});
    ChangeCollector collector;
    const std::shared_ptr<Document> document = show_room(scene, collector);
    ASSERT_NE(document, nullptr);
    EXPECT_FALSE(scene.wants_everything());
    const std::uint32_t before = document->handle_count();
    while (document->create().index < 3 * before + 8192) {
    }
    const Entity block = document->find("short block");
    ASSERT_FALSE(duplicate(*document, {block}).empty());
    remove(*document, {block});
    scene.change(*collector.collect(document));
    for (const auto end = Clock::now() + std::chrono::seconds(60); !scene.wants_everything();) {
        ASSERT_LT(Clock::now(), end) << "it does not ask";
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_EQ(scene.status().error, "");
    scene.change(ChangeCollector::everything(document));
    const Picture followed = settled(scene, *document), fresh = from_nothing(document);
    ASSERT_TRUE(followed && fresh);
    EXPECT_EQ(differing(*followed->pixels, *fresh->pixels), 0u);
    EXPECT_FALSE(scene.wants_everything());
}

// A copy of the sources is edited: a good change shows, a bad one is said and shows nothing.
TEST_F(EditorScene, EditedShadersShow) {
    const fs::path shader = "engine/render/composition.comp";
    for (const char* part : {"engine", "gi_module"})
        fs::copy(fs::path(SUNFLECK_SOURCE_DIR) / part, folder_ / part, fs::copy_options::recursive);
    const std::shared_ptr<Document> document = open_scene();
    ASSERT_NE(document, nullptr);
    SceneThread scene(tests::device(), [] {});
    ShaderWatch watch(folder_.path, viewer::SceneRenderer::shader_paths(), [] {});
    scene.change(ChangeCollector::everything(document));
    ViewRequest colours = view(*document);
    colours.view = shared::view_albedo; // which this shader draws
    scene.show(colours);
    const Picture before = settled(scene, *document);
    ASSERT_NE(before, nullptr);

    const std::string source = read_file(folder_ / shader).value(), line = "imageStore(output_image, pixel, value);";
    const auto with = [&](const std::string& replacement) {
        std::string text = source;
        text.replace(text.find(line), line.size(), replacement);
        EXPECT_TRUE(write_file(folder_ / shader, text));
        ShaderWatch::News all;
        for (const auto end = Clock::now() + std::chrono::seconds(20); Clock::now() < end;) {
            all = watch.take();
            if (!all.compiled.empty() || !all.errors.empty())
                break;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return all;
    };
    ShaderWatch::News news = with("imageStore(output_image, pixel, value * 0.5);");
    ASSERT_EQ(news.compiled.size(), 1u);
    EXPECT_EQ(news.compiled[0].path, shader);
    scene.replace_shader(news.compiled[0]);
    const Picture after = wait_for(
        scene, [&](const ScenePicture& picture) { return picture.number > before->number && picture.settled; });
    ASSERT_NE(after, nullptr);
    EXPECT_EQ(scene.status().bad_shader, "");
    EXPECT_GT(differing(*after->pixels, *before->pixels), width * height / 4u);
    news = with("nonsense;");
    EXPECT_TRUE(news.compiled.empty());
    ASSERT_EQ(news.errors.size(), 1u);
    EXPECT_NE(news.errors[0].find("composition.comp"), std::string::npos) << news.errors[0];
    EXPECT_NE(news.errors[0].find("nonsense"), std::string::npos) << news.errors[0];
}

} // namespace
} // namespace sunfleck::editor
