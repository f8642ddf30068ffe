// The editor's program, killed while a user edits and saves: the file on the disk is always one that was saved whole,
// and what is offered at the next start has all edits that were seen but the last.
#include "editor/window/recovery.h"
#include "tests/editor/window_fixture.h"

#include <random>
#include <thread>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

constexpr int presses = 24; // of the keys that duplicate; each makes one entity
const std::string wall = "tall block";

class EditorWindowKills : public tests::EditorWindowTest {
protected:
    void SetUp() override {
        EditorWindowTest::SetUp();
        if (IsSkipped())
            return;
        auto opened = editor::Document::open(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/cornell.scene.json");
        ASSERT_TRUE(opened) << opened.error().message;
        first_ = (*opened)->entity_count();
        room_ = folder / "room.scene.json";
        ASSERT_TRUE((*opened)->save(room_));
    }
    // Entities beyond those of the scene that was opened first; -1: it does not load.
    int added_in_file(const fs::path& file) const {
        const auto opened = editor::Document::open(file);
        EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
        return opened ? int((*opened)->entity_count() - first_) : -1;
    }
    int added_in(const editor::Recovered& left) const {
        const auto loaded = editor::Recovery::load(left);
        EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().message);
        return loaded ? int((*loaded)->entity_count() - first_) : -1;
    }
    // How many copies the hierarchy has shown, at least: it may be too short for all.
    int added_on_screen() const {
        const std::string above = "hierarchy/" + wall + " ";
        int most = 1;
        for (const tests::Widget& widget : editor->widgets())
            if (widget.name.starts_with(above))
                most = std::max(most, std::atoi(widget.name.c_str() + above.size()));
        return most - 1;
    }
    // The user goes on while the program is killed.
    void edit_until_killed(bool saves, double after) {
        std::string keys = "xdotool key --delay 40";
        for (int i = 0; i < presses; ++i)
            keys += saves ? " ctrl+d ctrl+s" : " ctrl+d";
        std::thread user([&] { editor->run(keys); });
        EXPECT_TRUE(editor->wait_until([&] { return added_on_screen() > 0; }));
        std::this_thread::sleep_for(std::chrono::duration<double>(after));
        editor->crash();
        user.join();
    }

    fs::path room_;
    std::size_t first_ = 0;
};

TEST_F(EditorWindowKills, LoseNoEditButTheLast) {
    std::mt19937 random(5);
    int offered = 0, killed = 0;
    for (int kill = 0; kill < tests::by_size(1, 20); ++kill) {
        const bool saves = kill % 3 == 1;
        const double after = double(random() % 1000) / 1000.0; // s
        SCOPED_TRACE("kill " + std::to_string(kill) + ", after " + std::to_string(after) + " s");
        const fs::path place = folder / std::to_string(kill);
        fs::create_directories(place);
        for (const char* file : {"room.scene.json", "room.glb"})
            fs::copy_file(folder / file, place / file);
        const fs::path file = place / "room.scene.json";
        editor->start({file.string()});
        ASSERT_TRUE(editor->click("hierarchy/" + wall));
        ASSERT_TRUE(editor->catch_up());
        edit_until_killed(saves, after);
        ++killed;

        const int seen = added_on_screen(), in_file = added_in_file(file);
        ASSERT_GE(in_file, 0);
        const auto bytes = read_file(file).value();
        const std::vector<editor::Recovered> left = editor::Recovery::left_behind(folder / "recovery");
        ASSERT_LE(left.size(), 1u);
        const int kept = left.empty() ? in_file : added_in(left[0]);
        std::printf("killed after %.2f s: %d edits seen, %d in the file, %s\n", after, seen, in_file,
                    left.empty() ? "nothing to recover" : (std::to_string(kept) + " to recover").c_str());
        EXPECT_GE(std::max(kept, in_file), seen - 1);
        EXPECT_LE(kept, presses);
        EXPECT_TRUE(saves || in_file == 0) << "it was never saved";
        if (left.empty())
            continue;
        ++offered;

        // Offered, not applied; then applied in the document alone.
        editor->start({});
        ASSERT_TRUE(editor->appears("dialog/Recover"));
        EXPECT_EQ(read_file(file).value(), bytes);
        ASSERT_TRUE(editor->click("dialog/Recover"));
        ASSERT_TRUE(editor->catch_up());
        EXPECT_EQ(read_file(file).value(), bytes);
        saved("after" + std::to_string(kill));
        EXPECT_EQ(added_in_file(folder / ("after" + std::to_string(kill)) / "room.scene.json"), kept);
        int status = -1;
        const auto report = editor->quit(status);
        EXPECT_EQ(status, 0);
        EXPECT_EQ(report["validation_messages"], 0);
        EXPECT_TRUE(fs::is_empty(folder / "recovery")) << "what was taken is offered no more";
    }
    EXPECT_GE(4 * offered, killed);
}

} // namespace
} // namespace sunfleck
