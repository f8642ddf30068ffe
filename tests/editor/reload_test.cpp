// A file that was exported again: what is new in it is taken over, and edits stay.
#include "editor/document/reload.h"

#include "engine/core/file.h"
#include "engine/scene/animation.h"
#include "tests/editor/change_component.h"
#include "tests/editor/random_edits.h"
#include "tests/support/folder.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

class EditorReload : public testing::Test {
protected:
    EditorReload() {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            add_from(theirs_, source, vec3(1.0f, 2.0f, 3.0f), 0.5f);
        export_again();
    }
    // What another program writes: a glTF file.
    void export_again() {
        for (const char* file : {"room.scene.json", "room.glb"})
            fs::remove(folder_ / file);
        const Status saved = theirs_.save(folder_ / "room.scene.json");
        EXPECT_TRUE(saved) << (saved ? "" : saved.error().message);
    }
    std::unique_ptr<Document> open() {
        auto opened = Document::open(folder_ / "room.glb");
        EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
        return opened ? std::move(*opened) : nullptr;
    }
    std::string saved(Document& document) {
        const fs::path place = folder_ / "saved";
        fs::remove_all(place);
        fs::create_directories(place);
        const Status status = document.save(place / "a.scene.json");
        EXPECT_TRUE(status) << (status ? "" : status.error().message);
        return read_file(place / "a.scene.json").value() + read_file(place / "a.glb").value();
    }
    template <typename T>
    static const T& get(Document& document, const std::string& name) {
        return document.registry().get<T>(document.find(name));
    }
    const tests::Folder folder_{"editor_reload"};
    Document theirs_;
};

TEST_F(EditorReload, EditsStayWithTheNodesOfTheSameName) {
    const std::unique_ptr<Document> ours = open();
    FileContent content = FileContent::of(*ours);
    // Here: a rougher box, a ball with another name and something below it, a cylinder that is moved.
    ASSERT_GE(ours->entity_count(), 6u);
    change<scene::Material>(*ours, "box", [](scene::Material& material) { material.roughness = 0.25f; });
    ASSERT_TRUE(rename(*ours, ours->find("ball"), "my ball"));
    change<scene::Transform>(*ours, "floor", [](scene::Transform& place) { place.position.y = -1.0f; });
    const Entity lamp = add_from(*ours, scene::entity_templates()[0], vec3(0.0f, 3.0f, 0.0f), 0.2f);
    ASSERT_TRUE(reparent(*ours, {lamp}, ours->find("floor")));
    const std::string before = saved(*ours);
    const vec3 lamp_place(world_of(*ours, lamp)[3]);

    // There: the box has another colour, place and shape, the ball another place, the floor is gone, and a second box
    // has come.
    change<scene::Material>(theirs_, "box", [](scene::Material& material) {
        material.base_colour = vec3(0.1f, 0.2f, 0.7f);
        material.roughness = 0.75f;
    });
    change<scene::Transform>(theirs_, "box", [](scene::Transform& place) { place.position = vec3(5.0f, 0.0f, 0.0f); });
    change<scene::Transform>(theirs_, "ball", [](scene::Transform& place) { place.position.x = -2.0f; });
    const Entity second = duplicate(theirs_, {theirs_.find("box")})[0];
    ASSERT_TRUE(rename(theirs_, second, "second box"));
    remove(theirs_, {theirs_.find("floor")});
    export_again();

    const std::unique_ptr<Document> now = open();
    const ReloadReport report = reload(*ours, content, *now);
    EXPECT_EQ(report.changed, 2u);
    EXPECT_EQ(report.added, 1u);
    EXPECT_EQ(report.removed, 1u);
    EXPECT_EQ(report.lost, std::vector<std::string>{"floor"});
    EXPECT_EQ(get<scene::Transform>(*ours, "box").position, vec3(5.0f, 0.0f, 0.0f));
    EXPECT_LT(glm::length(get<scene::Material>(*ours, "box").base_colour - vec3(0.1f, 0.2f, 0.7f)), 1e-3f);
    EXPECT_EQ(get<scene::Material>(*ours, "box").roughness, 0.25f) << "changed on both sides: the edit stays";
    EXPECT_EQ(get<scene::Transform>(*ours, "my ball").position.x, -2.0f) << "under its name here";
    EXPECT_TRUE(ours->exists(ours->find("second box")));
    EXPECT_FALSE(ours->exists(ours->find("floor")));
    ASSERT_TRUE(ours->exists(lamp)) << "what was added here stays";
    EXPECT_LT(glm::length(vec3(world_of(*ours, lamp)[3]) - lamp_place), 1e-4f) << "where it was";

    // One gesture.
    EXPECT_EQ(ours->history().entries().back().name, "Reload the file");
    ASSERT_TRUE(ours->undo());
    EXPECT_EQ(saved(*ours), before);
    ASSERT_TRUE(ours->redo());
    // Nothing is new the second time.
    const std::size_t edits = ours->history().position();
    const ReloadReport again = reload(*ours, content, *open());
    EXPECT_EQ(again.changed + again.added + again.removed, 0u);
    EXPECT_EQ(ours->history().position(), edits);
}

// An exported animation is taken over, and is no edit of anybody here.
TEST_F(EditorReload, AnimationsThatWereExportedAgainAreTakenOver) {
    const std::unique_ptr<Document> ours = open(), now = open();
    FileContent content = FileContent::of(*ours);
    const auto animate = [](Document& document, float duration) {
        scene::Animation animation;
        animation.curves.push_back({scene::AnimationTarget::position,
                                    scene::AnimationInterpolation::linear,
                                    {0.0f, duration},
                                    {vec4(0.0f), vec4(1.0f)}});
        animation.duration = duration;
        document.registry().emplace_or_replace<scene::Animation>(document.find("box"), std::move(animation));
    };
    animate(*now, 2.0f);
    EXPECT_EQ(reload(*ours, content, *now).changed, 1u);
    EXPECT_EQ(get<scene::Animation>(*ours, "box").duration, 2.0f);
    EXPECT_EQ(reload(*ours, content, *now).changed, 0u);
    animate(*now, 3.0f);
    EXPECT_EQ(reload(*ours, content, *now).changed, 1u);
    EXPECT_EQ(get<scene::Animation>(*ours, "box").duration, 3.0f);
    ASSERT_TRUE(ours->undo());
    EXPECT_EQ(get<scene::Animation>(*ours, "box").duration, 2.0f);
}

TEST_F(EditorReload, LightingSettingsAreMergedOneByOne) {
    const std::unique_ptr<Document> ours = open(), now = open();
    FileContent content = FileContent::of(*ours);
    const auto set = [](Document& document, const char* name, const char* value) {
        document.begin("Set");
        ASSERT_TRUE(document.set_setting(name, value));
        document.commit();
    };
    set(*ours, "lights", "77");
    set(*now, "lights", "88");
    set(*now, "bounces", "2");
    const ReloadReport report = reload(*ours, content, *now);
    EXPECT_EQ(report.settings, 1u);
    EXPECT_EQ(report.text("room.glb"), "Reloaded room.glb: 0 changed, 0 new, 0 gone, 1 setting");
    EXPECT_EQ(ours->settings().get("lights"), "77") << "the edit stays";
    EXPECT_EQ(ours->settings().get("bounces"), "2");
    ASSERT_TRUE(ours->undo());
    EXPECT_EQ(ours->settings().get("bounces"), open()->settings().get("bounces"));
}

// Whatever was edited here: a file that has not changed changes nothing.
TEST_F(EditorReload, AnUnchangedFileChangesNothing) {
    for (std::uint32_t seed = 1; seed <= tests::by_size(10u, 200u); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const std::unique_ptr<Document> ours = open();
        FileContent content = FileContent::of(*ours);
        tests::RandomEdits edits(*ours, seed);
        for (int i = 0; i < 40; ++i)
            edits.once();
        const std::string before = saved(*ours);
        const ReloadReport report = reload(*ours, content, *open());
        EXPECT_EQ(report.changed + report.added + report.removed, 0u);
        EXPECT_TRUE(saved(*ours) == before);
    }
}

// Without edits here, the document becomes what the file holds; undo brings the first back.
TEST_F(EditorReload, WithoutEditsTheFileIsTakenAsItIs) {
    for (std::uint32_t seed = 1; seed <= tests::by_size(10u, 200u); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const std::unique_ptr<Document> ours = open();
        FileContent content = FileContent::of(*ours);
        const std::string before = saved(*ours);
        tests::RandomEdits edits(theirs_, seed);
        for (int i = 0; i < 12; ++i)
            edits.once();
        export_again();
        const std::unique_ptr<Document> now = open();
        static_cast<void>(reload(*ours, content, *now));
        ASSERT_EQ(ours->entity_count(), now->entity_count());
        const FileContent theirs = FileContent::of(*now);
        for (const auto& [name, node] : theirs.nodes()) {
            const Entity entity = ours->find(name);
            ASSERT_TRUE(ours->exists(entity)) << name;
            for (const auto& [pool, value] : node.components) {
                const ecs::PoolBase& own = ours->registry().counterpart(*pool);
                if (pool->description() == nullptr || is_part_of_tree(*ours, own))
                    continue;
                EXPECT_TRUE(same_value(own, ours->registry().value(own, entity), value))
                    << name << ": " << pool->description()->name;
            }
            const Entity above = now->parent(now->find(name));
            EXPECT_EQ(ours->parent(entity), above.is_null() ? above : ours->find(now->name(above))) << name;
        }
        while (ours->undo()) {
        }
        EXPECT_TRUE(saved(*ours) == before);
    }
}

} // namespace
} // namespace sunfleck::editor
