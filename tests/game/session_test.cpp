// Checkpoints and clock of a session: from a new game to its end.
#include "engine/io/scene_file.h"
#include "game_demo/game/level_contents.h"
#include "game_demo/game_session.h"
#include "tests/game/played_game.h"
#include "tests/game/small_level.h"
#include "tests/support/folder.h"
#include "viewer/built_in_scenes.h"

namespace sunfleck::demo {
namespace {

using tests::SmallLevel;

struct LevelWithGoal : SmallLevel {
    explicit LevelWithGoal(bool with_room = true) {
        scene::GameArea described;
        described.half_size = vec3(half, 2.0f, 2.0f);
        if (with_room)
            area("room", {0.0f, 1.0f, 4.0f}, described);
        described.goal = true;
        area("goal", {0.0f, 1.0f, -4.0f}, described);
        begin();
    }
    void walk_into_the_goal() {
        stand_at({0.0f, 0.0f, -4.0f});
        run(2);
    }
};

class GameSessionTest : public testing::Test {
protected:
    // When all is written.
    static void end(std::unique_ptr<GameSession>& session) {
        const std::string message = session->take_message();
        session.reset();
        EXPECT_EQ(message, "");
    }
    std::unique_ptr<GameSession> session() const {
        return std::make_unique<GameSession>("level", folder_ / "checkpoints");
    }
    const tests::Folder folder_{"game_session"};
    const CheckpointFiles files_{folder_ / "checkpoints", "level"};
};

// Whoever begins anew and takes the last checkpoint is at this game's beginning, and not in the one before.
TEST_F(GameSessionTest, ANewGameHasACheckpointOfItsOwn) {
    LevelWithGoal before, now, loaded;
    before.stand_at({3.0f, 0.0f, 5.0f});
    before.run(30);
    ASSERT_TRUE(files_.save(*before.world));
    auto one = session();
    EXPECT_TRUE(one->begin(*now.world, false));
    end(one);
    std::string message;
    ASSERT_TRUE(files_.load(*loaded.world, message)) << message;
    EXPECT_EQ(loaded.hash(), now.hash());
    EXPECT_NE(loaded.hash(), before.hash());
}

TEST_F(GameSessionTest, GoingOnLeavesTheCheckpoint) {
    LevelWithGoal before, now;
    before.stand_at({3.0f, 0.0f, 5.0f});
    before.run(30);
    ASSERT_TRUE(files_.save(*before.world));
    auto one = session();
    EXPECT_TRUE(one->begin(*now.world, true));
    EXPECT_EQ(now.hash(), before.hash());
    end(one);
    EXPECT_FALSE(std::filesystem::exists(files_.older()));
}

// There is nothing to go on with after the end.
TEST_F(GameSessionTest, TheEndRemovesTheCheckpoints) {
    LevelWithGoal level;
    auto one = session();
    EXPECT_TRUE(one->begin(*level.world, false));
    level.run(60);
    one->update(1.0);
    ASSERT_TRUE(one->keep());
    EXPECT_TRUE(one->can_resume());
    level.walk_into_the_goal();
    one->update(1.0);
    ASSERT_TRUE(one->finished());
    ASSERT_TRUE(one->keep());
    end(one);
    EXPECT_FALSE(files_.any());
}

// A goal alone makes a game, too: its end says how long it took.
TEST_F(GameSessionTest, ALevelWithAGoalAndNoRoomHasATime) {
    LevelWithGoal level(false);
    auto one = session();
    EXPECT_TRUE(one->begin(*level.world, false));
    level.run(120);
    one->update(2.0);
    level.walk_into_the_goal();
    one->update(2.0 / 60.0);
    EXPECT_TRUE(one->finished());
    EXPECT_NEAR(one->seconds(), 122.0 / 60.0, 1e-6);
    EXPECT_FALSE(one->has_hint());
    end(one);
}

// A game that the window saved is one of the level that tests make, too.
TEST(GameContents, OfTheLevelsFileAreThoseThatItWasMadeOf) {
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    scene::register_components(registry);
    ASSERT_TRUE(io::load_scene(viewer::find_scene("lantern_game").value(), registry, meshes, textures, {}));
    const tests::Played played;
    EXPECT_EQ(contents_of_level(registry), played.world->contents());
}

} // namespace
} // namespace sunfleck::demo
