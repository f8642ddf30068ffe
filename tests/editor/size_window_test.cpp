// Frames of the window in scenes of any size: with each panel in front, with one and with all entities selected, and
// after edits of one.
#include "tests/editor/size_scene.h"
#include "tests/editor/window_fixture.h"
#include "tests/support/test_size.h"

#include <algorithm>
#include <map>
#include <span>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenEditor, tests::make_scene, tests::Shape, tests::shape_name;

constexpr const char* panels[] = {"Hierarchy", "Inspector", "History", "Lighting", "Pixel",    "Views",
                                  "Counters",  "Browser",   "Compare", "Profile",  "Messages", "Commands"};
constexpr std::size_t panels_in_short = 3; // those that know the selection, and one that knows edits
constexpr const char* edits[] = {"rename", "reparent", "delete", "undo"};

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Milliseconds of GUI frames by what was done meanwhile.
using Times = std::map<std::string, std::vector<double>>;

double percentile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[std::size_t(share * double(values.size() - 1))];
}

class EditorSizeWindow : public tests::EditorWindowTest {
protected:
    EditorSizeWindow() : EditorWindowTest("1440x900") {}
    // Of all frames: those of panels, of which each is as dear as it is; of edits, the dearest frame of each.
    Times measure(Shape shape, int count);

private:
    struct Part {
        std::string name;
        double begin, end;
        bool dearest;
    };
    void note(const std::string& name, bool dearest, const std::function<void()>& action) {
        const double begin = seconds_now();
        action();
        ASSERT_TRUE(editor->catch_up());
        parts_.push_back({name, begin, seconds_now(), dearest});
    }
    void look_at_panels(const std::string& selected);
    void edit_one(int round);
    Times times_of(const nlohmann::json& report) const;
    std::vector<Part> parts_;
};

void EditorSizeWindow::look_at_panels(const std::string& selected) {
    for (const char* panel : std::span(panels).first(tests::by_size(panels_in_short, std::size(panels)))) {
        const std::string tab = std::string("tab ") + panel;
        ASSERT_TRUE(editor->click(tab));
        ASSERT_TRUE(editor->wait_for(tab, "open"));
        const tests::Widget place = editor->find(tab).value();
        note(std::string(panel) + ", " + selected + " selected", false, [&] {
            for (int i = 0; i < 24; ++i)
                editor->point_at(int(place.x) + 5 + i, int(place.y + 2.0 * place.height) + 4 * i);
        });
    }
}

// What is edited is found by search, so that it is the same in all scenes.
void EditorSizeWindow::edit_one(int round) {
    const std::string name = "entity " + std::to_string(41 + round), other = "other " + std::to_string(round);
    ASSERT_NO_FATAL_FAILURE(search("hierarchy/search", name));
    ASSERT_TRUE(editor->click("hierarchy/" + name));
    ASSERT_TRUE(editor->wait_for("inspector/name", name));
    ASSERT_TRUE(editor->select_text("hierarchy/search"));
    editor->key("BackSpace");
    ASSERT_TRUE(editor->wait_for("hierarchy/search", ""));
    ASSERT_TRUE(editor->write("inspector/name", other));
    ASSERT_TRUE(editor->catch_up());
    note("rename", true, [&] { editor->key("Return"); });
    ASSERT_TRUE(editor->wait_for("inspector/name", other));
    note("reparent", true, [&] { editor->key("ctrl+g"); }); // under a new entity
    note("delete", true, [&] { editor->key("Delete"); });
    note("undo", true, [&] { editor->key("ctrl+z"); });
    editor->run("xdotool key --delay 40 ctrl+z ctrl+z");
    ASSERT_TRUE(editor->catch_up());
}

Times EditorSizeWindow::times_of(const nlohmann::json& report) const {
    const std::vector<double> ends = report["gui_frames_at"], times = report["gui_frame_ms"];
    Times result;
    for (const Part& part : parts_) {
        std::vector<double> found;
        for (std::size_t i = 0; i < ends.size(); ++i)
            if (ends[i] >= part.begin && ends[i] <= part.end)
                found.push_back(times[i]);
        EXPECT_FALSE(found.empty()) << part.name;
        std::vector<double>& all = result[part.name];
        if (part.dearest && !found.empty())
            all.push_back(*std::max_element(found.begin(), found.end()));
        else
            all.insert(all.end(), found.begin(), found.end());
    }
    return result;
}

Times EditorSizeWindow::measure(Shape shape, int count) {
    parts_.clear();
    // A name of its own: a document does not replace a file that it is not of.
    const fs::path file = folder / (std::string(shape_name(shape)) + " " + std::to_string(count) + ".scene.json");
    const Status saved = make_scene(shape, count)->save(file);
    EXPECT_TRUE(saved) << saved.error().message;
    editor->start({file.string()});
    EXPECT_TRUE(editor->settles()) << editor->log();
    EXPECT_TRUE(editor->click("tab Inspector")); // the run before has left another one in front
    for (int round = 0; round < tests::by_size(2, 20) && !HasFailure(); ++round)
        edit_one(round);
    EXPECT_TRUE(editor->settles());
    if (!HasFailure())
        look_at_panels("one");
    editor->key("Escape");
    editor->key("ctrl+a");
    EXPECT_TRUE(editor->settles());
    if (!HasFailure())
        look_at_panels("all");
    const auto report = editor->end();
    EXPECT_TRUE(report.is_object()) << editor->log();
    return report.is_object() ? times_of(report) : Times();
}

TEST_F(EditorSizeWindow, FramesTakeTheSameInLargeScenes) {
    std::vector<Shape> shapes{Shape::deep};
    if (tests::long_size())
        shapes = {Shape::flat, Shape::deep, Shape::one_parent};
    for (const Shape shape : shapes) {
        if (tests::long_size() && !tests::in_part(unsigned(shape)))
            continue;
        SCOPED_TRACE(shape_name(shape));
        Times few = measure(shape, 100), many = measure(shape, 10000);
        if (HasFailure())
            return;
        for (const auto& [name, times] : many) {
            const bool is_edit = std::find(std::begin(edits), std::end(edits), name) != std::end(edits);
            const double share = is_edit ? 0.95 : 0.5, most = is_edit ? 3.0 : 2.0;
            const double before = percentile(few[name], share), now = percentile(times, share);
            std::printf("%s, %s: %.2f ms with 100, %.2f ms with 10,000\n", shape_name(shape), name.c_str(), before,
                        now);
            EXPECT_LE(now, most * before) << name;
        }
    }
}

} // namespace
} // namespace sunfleck
