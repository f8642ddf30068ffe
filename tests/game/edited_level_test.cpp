// Checkpoints of a level that was edited since: set aside, with one message, and the game begins anew.
#include "game_demo/game/checkpoint_files.h"
#include "tests/game/small_level.h"
#include "tests/support/folder.h"

#include <functional>

namespace sunfleck::demo {
namespace {

using tests::SmallLevel;

// A door that is used, a lamp with its switch, and a lantern, in one area.
struct FurnishedLevel : SmallLevel {
    FurnishedLevel() {
        door = box("door", {0.0f, 1.0f, 0.0f}, {1.0f, 2.0f, 0.1f});
        scene::Mover mover;
        mover.path = scene::MoverPath::line;
        mover.activation = scene::MoverActivation::use;
        registry.emplace<scene::Mover>(door, mover);
        lamp = builder.point_light("lamp", {0.0f, 2.5f, 0.0f}, vec3(5.0f));
        plate = box("switch", {2.0f, 1.2f, 0.0f}, {0.2f, 0.2f, 0.2f});
        registry.emplace<scene::LightSwitch>(plate, {"lamp", true});
        hand_lamp = lantern("lantern", {-2.0f, 0.0f, 0.0f});
        scene::GameArea described;
        described.half_size = vec3(half, 3.0f, half);
        area("area", {0.0f, 1.0f, 0.0f}, described);
    }
    ecs::Entity door, lamp, plate, hand_lamp;
};

// Saves with the lantern in hand, edits the level, and goes on there.
void expect_set_aside(const std::string& what, const std::function<void(FurnishedLevel&)>& edit) {
    const tests::Folder folder("edited_level");
    const CheckpointFiles files(folder / "checkpoints", "level");
    FurnishedLevel level, edited;
    level.begin();
    level.run(2);
    level.world->simulation().hand_lantern(level.registry, level.hand_lamp);
    level.run(2);
    ASSERT_TRUE(files.save(*level.world));
    edit(edited);
    edited.begin();
    std::string message;
    EXPECT_FALSE(files.load(*edited.world, message)) << what;
    EXPECT_NE(message.find("the level has been changed"), std::string::npos) << what << ": " << message;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0);
    EXPECT_FALSE(files.any()) << what;
    edited.press(simulation::button_reset);
    edited.run(30);
    EXPECT_NEAR(edited.foot().y, 0.0f, 0.05f) << what;
}

TEST(GameEditedLevel, ItsCheckpointsAreSetAside) {
    expect_set_aside("no switch", [](FurnishedLevel& l) { l.registry.remove<scene::LightSwitch>(l.plate); });
    expect_set_aside("no lantern", [](FurnishedLevel& l) { l.registry.remove<scene::Lantern>(l.hand_lamp); });
    expect_set_aside("no mover", [](FurnishedLevel& l) { l.registry.remove<scene::Mover>(l.door); });
    expect_set_aside("no place", [](FurnishedLevel& l) { l.registry.remove<scene::Transform>(l.hand_lamp); });
    expect_set_aside("a door elsewhere", [](FurnishedLevel& l) {
        l.registry.patch<scene::Transform>(l.door, [](scene::Transform& t) { t.position.x += 1.0f; });
    });
    expect_set_aside("another name", [](FurnishedLevel& l) {
        l.registry.patch<scene::Name>(l.lamp, [](scene::Name& name) { name.name = "ceiling lamp"; });
    });
    expect_set_aside("a box more", [](FurnishedLevel& l) { l.box("box", vec3(3.0f), vec3(1.0f)); });
}

// Where nothing was edited, they are loaded, and colours are no matter.
TEST(GameEditedLevel, OneThatLooksOtherwiseGoesOn) {
    const tests::Folder folder("edited_level");
    const CheckpointFiles files(folder / "checkpoints", "level");
    FurnishedLevel level, edited;
    level.begin();
    level.run(20);
    ASSERT_TRUE(files.save(*level.world));
    edited.registry.patch<scene::Material>(edited.door, [](scene::Material& m) { m.base_colour = vec3(0.1f); });
    edited.begin();
    std::string message;
    EXPECT_TRUE(files.load(*edited.world, message)) << message;
    EXPECT_EQ(edited.hash(), level.hash());
}

} // namespace
} // namespace sunfleck::demo
