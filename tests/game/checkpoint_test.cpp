// Checkpoints: the world after loading, and files that were harmed or whose writer was killed.
#include "engine/core/file.h"
#include "game_demo/game/checkpoint_files.h"
#include "tests/game/played_game.h"
#include "tests/support/test_size.h"

#include <csignal>
#include <filesystem>
#include <functional>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace sunfleck::demo {
namespace {

using tests::Played;

struct Folder {
    Folder() : path(std::filesystem::temp_directory_path() / ("sunfleck_checkpoints_" + std::to_string(getpid()))) {
        std::filesystem::remove_all(path);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path path;
};

std::uint64_t hash_of(Played& played) {
    return played.world->simulation().world_hash(played.registry);
}

TEST(GameCheckpoints, AWorldIsTheSameAfterLoading) {
    const Folder folder;
    const CheckpointFiles files(folder.path, "lantern_game");
    Played played;
    played.enter("area red wall");
    for (std::uint32_t k = 0; k < 700; ++k)
        played.step(tests::aimless(3, k));
    ASSERT_TRUE(files.save(*played.world));
    Played other;
    std::string message;
    ASSERT_TRUE(files.load(*other.world, message)) << message;
    EXPECT_EQ(message, "");
    EXPECT_EQ(hash_of(other), hash_of(played));
    EXPECT_EQ(other.world->area_entity(), played.world->area_entity());
    EXPECT_EQ(other.world->simulation().carries_lantern(), played.world->simulation().carries_lantern());
}

// Saves and loads into a fresh level.
void expect_the_same_after_loading(Played& played, const std::string& when) {
    Played other;
    const Status loaded = load_game(*other.world, "lantern_game", save_game(*played.world, "lantern_game"));
    ASSERT_TRUE(loaded) << when << ": " << loaded.error().message;
    EXPECT_EQ(hash_of(other), hash_of(played)) << when;
    EXPECT_EQ(other.world->area_entity(), played.world->area_entity()) << when;
    EXPECT_EQ(other.world->sensors_opened(), played.world->sensors_opened()) << when;
}

// All along the solution: in each room that it enters, and while the block is under way.
TEST(GameCheckpoints, EveryRoomAndAHalfPushedBlockAreTheSameAfterLoading) {
    Played played;
    const ecs::Entity block = scene::find_by_name(played.registry, "green block");
    const auto place = [&] { return played.registry.get<scene::Transform>(block).position; };
    const float half_side =
        0.5f * played.meshes.bounds(played.registry.get<scene::MeshInstance>(block).mesh).extent().x;
    const vec3 start = place();
    vec3 before = start;
    ecs::Entity area = played.world->area_entity();
    std::size_t rooms = 0;
    bool pushed = false;
    played.watch = [&] {
        if (std::exchange(area, played.world->area_entity()) != area) {
            ++rooms;
            expect_the_same_after_loading(played, played.world->area()->title);
        }
        const bool moves = std::exchange(before, place()) != place();
        if (!pushed && moves && glm::length(place() - start) > half_side) {
            pushed = true;
            expect_the_same_after_loading(played, "the block under way");
        }
    };
    played.solve();
    EXPECT_EQ(played.problem, "");
    EXPECT_EQ(rooms, 7u);
    EXPECT_TRUE(pushed);
}

// Files are from the future then; which of the two is newer, their names say.
TEST(GameCheckpoints, AClockThatWasSetBack) {
    const Folder folder;
    const CheckpointFiles files(folder.path, "lantern_game");
    Played played, other;
    ASSERT_TRUE(files.save(*played.world));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path))
        std::filesystem::last_write_time(entry, std::filesystem::file_time_type::clock::now() + std::chrono::years(20));
    played.step({50, 0, 30, 0, 0});
    ASSERT_TRUE(files.save(*played.world));
    std::string message;
    ASSERT_TRUE(files.load(*other.world, message)) << message;
    EXPECT_EQ(hash_of(other), hash_of(played));
}

// As long as a scene's file can be called.
TEST(GameCheckpoints, OfALevelWithALongName) {
    const Folder folder;
    const std::string level = (folder.path / std::string(244, 'n').append(".scene.json")).string(),
                      other = (folder.path / std::string(243, 'n').append("o.scene.json")).string();
    const CheckpointFiles files(folder.path, level), files_of_other(folder.path, other);
    for (int times = 0; times < 2; ++times) {
        ASSERT_TRUE(files.write("game"));
        ASSERT_TRUE(files_of_other.write("another game"));
    }
    EXPECT_EQ(read_file(files.older()).value(), "game");
    EXPECT_EQ(read_file(files_of_other.newest()).value(), "another game");
    Played played;
    std::string message;
    EXPECT_FALSE(files.load(*played.world, message));
    EXPECT_FALSE(files.any()) << "set aside";
}

// Damages the newest of two checkpoints by `harm`; the older one is loaded, and the newest set aside.
void expect_older(const std::function<std::string(std::string)>& harm, const std::string& why) {
    const Folder folder;
    const CheckpointFiles files(folder.path, "lantern_game");
    Played played, other;
    ASSERT_TRUE(files.save(*played.world));
    const std::uint64_t older = hash_of(played);
    played.step({50, 0, 30, 0, 0});
    ASSERT_TRUE(files.save(*played.world));
    ASSERT_TRUE(write_file(files.newest(), harm(read_file(files.newest()).value())));
    std::string message;
    ASSERT_TRUE(files.load(*other.world, message)) << why;
    EXPECT_EQ(hash_of(other), older) << why;
    EXPECT_NE(message.find(why), std::string::npos) << message;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0);
    EXPECT_FALSE(std::filesystem::exists(files.newest()));
    EXPECT_TRUE(std::filesystem::exists(files.newest().string() + ".damaged"));
}

TEST(GameCheckpoints, WhatIsNotGoodIsSetAside) {
    expect_older([](const std::string& text) { return text.substr(0, text.size() / 2); }, "not a saved game");
    expect_older(
        [](std::string text) {
            char& digit = text[text.find("\"steps\"") + 9];
            digit = digit == '7' ? '8' : '7';
            return text;
        },
        "checksum");
    expect_older([](const std::string&) { return std::string("\0\1\2", 3); }, "not a saved game");
    expect_older(
        [](std::string text) {
            const std::string mark = "\"sunfleck_game\": 2";
            return text.replace(text.find(mark), mark.size(), "\"sunfleck_game\": 3");
        },
        "later version");
    expect_older(
        [](std::string text) {
            const std::string mark = "\"sunfleck_game\": 2";
            return text.replace(text.find(mark), mark.size(), "\"sunfleck_game\": 1");
        },
        "earlier version");
    expect_older(
        [](std::string text) {
            const std::string mark = "\"lantern_game\"";
            return text.replace(text.find(mark), mark.size(), "\"other_level\"");
        },
        "another level");
}

// Two levels of one name, in two folders: neither sees the other's. One level, however it is called, has one game.
TEST(GameCheckpoints, LevelsOfOneNameHaveGamesOfTheirOwn) {
    const Folder folder;
    const std::filesystem::path a = folder.path / "a", b = folder.path / "b";
    for (const std::filesystem::path& level : {a, b}) {
        std::filesystem::create_directories(level);
        ASSERT_TRUE(write_file(level / "level.scene.json", "{}"));
    }
    const CheckpointFiles of_a(folder.path, (a / "level.scene.json").string());
    const CheckpointFiles of_b(folder.path, (b / "level.scene.json").string());
    const CheckpointFiles again(folder.path, (b / ".." / "a" / "." / "level.scene.json").string());
    Played played, other;
    played.step({50, 0, 30, 0, 0});
    ASSERT_TRUE(of_a.save(*played.world));
    std::string message;
    EXPECT_FALSE(of_b.any());
    EXPECT_FALSE(of_b.load(*other.world, message));
    EXPECT_EQ(message, "");
    ASSERT_TRUE(again.load(*other.world, message)) << message;
    EXPECT_EQ(hash_of(other), hash_of(played));
    EXPECT_TRUE(std::filesystem::exists(of_a.newest()));
    EXPECT_EQ(identity_of_level("lantern_game"), "lantern_game");
    EXPECT_EQ(CheckpointFiles(folder.path, "lantern_game").newest().filename(), "lantern_game.checkpoint");
}

// A limit on the size of files fails a write as a full disk does: in the middle.
TEST(GameCheckpoints, AFullDiskLeavesTheLastOne) {
    const Folder folder;
    const CheckpointFiles files(folder.path, "lantern_game");
    Played played, other;
    ASSERT_TRUE(files.save(*played.world));
    const std::uint64_t saved = hash_of(played);
    played.step({50, 0, 30, 0, 0});
    const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{64, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const Status failed = files.save(*played.world);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, ignored);
    ASSERT_FALSE(failed);
    EXPECT_NE(failed.error().message.find(folder.path.string()), std::string::npos) << failed.error().message;
    std::string message;
    ASSERT_TRUE(files.load(*other.world, message)) << message;
    EXPECT_EQ(message, "");
    EXPECT_EQ(hash_of(other), saved);
}

TEST(GameCheckpoints, KilledWritersLeaveAGoodOne) {
    const Folder folder;
    const CheckpointFiles files(folder.path, "lantern_game");
    Played played;
    ASSERT_TRUE(files.save(*played.world));
    for (std::uint32_t kill_number = 0; kill_number < tests::by_size(10u, 200u); ++kill_number) {
        const pid_t child = fork();
        if (child == 0)
            for (;;)
                (void)files.save(*played.world).has_value();
        usleep(useconds_t(2000 + hash_combine(kill_number, 5) % 20000));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        Played other;
        std::string message;
        ASSERT_TRUE(files.load(*other.world, message));
        EXPECT_EQ(message, "");
        EXPECT_EQ(hash_of(other), hash_of(played));
    }
}

} // namespace
} // namespace sunfleck::demo
