// The window answers while light is made: a static wall is dragged and let go, and dragged again while the new light is
// being prepared.
#include "tests/editor/window_fixture.h"
#include "tests/support/test_size.h"

#include <algorithm>

namespace sunfleck {
namespace {

using tests::DrivenEditor;

double now() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

struct Window {
    double begin = 0.0, end = 0.0;
    bool has(double at) const { return at >= begin && at <= end; }
};

std::vector<double> scene_ms(const nlohmann::json& report, const Window& window) {
    std::vector<double> result;
    for (std::size_t i = 0; i < report["scene_frames_at"].size(); ++i)
        if (window.has(report["scene_frames_at"][i]))
            result.push_back(report["scene_frame_ms"][i]);
    return result;
}

double longest_gap_ms(const nlohmann::json& report, const Window& window) {
    double longest = 0.0, last = window.begin;
    for (const double at : report["gui_frames_at"])
        if (window.has(at))
            longest = std::max(longest, at - std::exchange(last, at));
    return 1e3 * std::max(longest, window.end - last);
}

double longest_gap_ms(const nlohmann::json& report, const std::vector<Window>& windows) {
    double longest = 0.0;
    for (const Window& window : windows)
        longest = std::max(longest, longest_gap_ms(report, window));
    return longest;
}

using EditorWindowStuck = tests::EditorWindowTest;

// Of `atrium` (262,000 triangles) at full size, else of `gallery`. The pointer never rests, so that GUI frames are due
// all the time, and a gap between two is the program's.
TEST_F(EditorWindowStuck, TheWindowAnswersWhileAWallIsDragged) {
    const bool whole = tests::by_size(0, 1) == 1;
    editor->start({whole ? "atrium" : "gallery"});
    ASSERT_TRUE(editor->settles()) << editor->log();
    ASSERT_NO_FATAL_FAILURE(search("hierarchy/search", "wall z-"));
    ASSERT_TRUE(editor->click("hierarchy/wall z-"));
    ASSERT_TRUE(editor->wait_for("inspector/name", "wall z-", 60.0));
    editor->point_at(*editor->find("viewport/picture"));
    editor->key("f");
    ASSERT_TRUE(editor->settles()) << editor->log();
    const auto move = [&](int steps, int x, int y) {
        std::string command = "xdotool";
        for (int i = 0; i < steps; ++i)
            command += " mousemove_relative -- " + std::to_string(i % 2 == 0 ? x : -x / 2) + " " +
                       std::to_string(i % 2 == 0 ? y : -y / 2) + " sleep 0.02";
        editor->run(command);
    };
    // Scene frames as they are: the camera turns.
    Window before{now(), 0.0};
    editor->run("xdotool mousedown 3");
    move(100, 2, 1);
    editor->run("xdotool mouseup 3");
    before.end = now();
    ASSERT_TRUE(editor->settles());
    editor->key("f");
    ASSERT_TRUE(editor->settles());
    const auto drag = [&] {
        EXPECT_TRUE(editor->reach("viewport/gizmo y"));
        const double begin = now();
        editor->run("xdotool mousedown 1");
        move(60, 0, -2);
        editor->run("xdotool mouseup 1");
        return Window{begin, now()};
    };
    const Window first = drag();
    editor->point_at(*editor->find("viewport/picture"));
    const bool prepares = DrivenEditor::wait_until([&] { return editor->find("status/building").has_value(); }, 10.0);
    const Window second = drag(); // cancels what is prepared for the first
    editor->point_at(*editor->find("viewport/picture"));
    // Only while the pointer moves: when it rests and all light is there, no frame is due.
    std::vector<Window> after;
    // Until all light is there, and a while longer: what the widgets say may be of before. To and fro, since a pointer
    // at the edge of the screen moves no more.
    for (int round = 0, rested = 0; rested < 2 && now() - second.end < 120.0; ++round) {
        const double begin = now();
        move(100, round % 2 == 0 ? 3 : -3, 0);
        after.push_back({begin, now()});
        rested = editor->value("status/settled") == "yes" ? rested + 1 : 0;
    }
    ASSERT_TRUE(editor->settles());
    const auto report = editor->end();
    ASSERT_TRUE(report.is_object()) << editor->log();

    const double frame = median(scene_ms(report, before)), dragged = median(scene_ms(report, first));
    const double longest = std::max(longest_gap_ms(report, first), longest_gap_ms(report, second));
    const double longest_after = longest_gap_ms(report, after);
    std::printf("scene frame %.1f ms, %.1f ms while dragged; longest gap between GUI frames %.1f ms while dragged, "
                "%.1f ms while light is made; new light %d times, %d times cancelled\n",
                frame, dragged, longest, longest_after, int(report["long_builds"]), int(report["cancelled"]));
    ASSERT_GT(frame, 0.0);
    ASSERT_GT(dragged, 0.0);
    // The short size shares its machine with whatever else runs there.
    const double room = whole ? 1.0 : 1.2;
    EXPECT_LE(longest, room * 3.0 * frame);
    EXPECT_LE(longest_after, room * 3.0 * frame);
    EXPECT_LE(dragged, room * 1.5 * frame);
    EXPECT_TRUE(prepares || !whole) << "light is made behind the frames";
    // That of the first drag, which takes many times as long in `atrium` as the pointer needs to come back.
    EXPECT_TRUE(int(report["cancelled"]) > 0 || !whole) << "a new edit cancels it";
}

} // namespace
} // namespace sunfleck
