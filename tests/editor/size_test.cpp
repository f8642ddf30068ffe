// How edits scale with the scene: one entity's cost what they cost in a small scene, all entities' grow with their
// number.
#include "editor/document/edits.h"
#include "tests/editor/driven_editor.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <random>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;
using tests::by_size;
using tests::DrivenEditor;

enum class Shape { flat, deep, one_parent };
constexpr const char* shape_names[] = {"flat", "fifty deep", "one parent"};
constexpr int depth = 50;

// Entities without geometry: what is measured is the editor, not the lighting.
std::unique_ptr<Document> make_scene(Shape shape, int count) {
    auto document = std::make_unique<Document>();
    document->begin("fill");
    ecs::PoolBase& names = pool_of<scene::Name>(*document);
    ecs::PoolBase& transforms = pool_of<scene::Transform>(*document);
    ecs::PoolBase& parents = pool_of<scene::Parent>(*document);
    Entity first, last;
    for (int i = 0; i < count; ++i) {
        const Entity entity = document->create();
        document->set(entity, names, std::make_shared<scene::Name>(scene::Name{"entity " + std::to_string(i)}));
        scene::Transform place;
        const int column = i % 100, row = i / 100;
        place.position = vec3(float(column), float(row), 0.0f);
        document->set(entity, transforms, std::make_shared<scene::Transform>(place));
        const bool below = i > 0 && (shape == Shape::one_parent || (shape == Shape::deep && i % depth != 0));
        if (below)
            document->set(entity, parents,
                          std::make_shared<scene::Parent>(scene::Parent{shape == Shape::deep ? last : first}));
        first = i == 0 ? entity : first;
        last = entity;
    }
    document->commit();
    return document;
}

// Of this thread on a processor: what else the machine does is not counted.
double seconds_of(const std::function<void()>& action) {
    const auto now = [] {
        timespec time{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
    };
    const double began = now();
    action();
    return now() - began;
}

// Of edits of one entity by name, in seconds, all of them undone again.
std::map<std::string, double> times_of_one(Document& document, int rounds) {
    const std::vector<Entity> all = document.registry().entities();
    std::mt19937 random(7);
    std::map<std::string, std::vector<double>> times;
    for (int round = 0; round < rounds; ++round) {
        const Entity one = all[1 + random() % (all.size() - 1)];
        if (!document.exists(one))
            continue;
        times["select"].push_back(seconds_of([&] { document.select({one}); }));
        times["rename"].push_back(
            seconds_of([&] { EXPECT_TRUE(rename(document, one, "new " + std::to_string(round))); }));
        times["reparent"].push_back(seconds_of([&] { static_cast<void>(reparent(document, {one}, Entity())); }));
        // A leaf: with a subtree, it would not be one entity.
        Entity leaf = one;
        while (!document.children(leaf).empty())
            leaf = document.children(leaf).front();
        times["delete"].push_back(seconds_of([&] { remove(document, {leaf}); }));
        times["undo"].push_back(seconds_of([&] { document.undo(); }));
        document.take_updates(); // as the window does after each frame
    }
    std::map<std::string, double> result;
    for (auto& [name, values] : times) {
        std::sort(values.begin(), values.end());
        result[name] = values[std::size_t(0.95 * double(values.size() - 1))];
    }
    return result;
}

// Between two edits the window draws: what the last one left in caches is gone, of small scenes, too.
void forget_caches() {
    static std::vector<std::uint8_t> other(std::size_t(64) << 20);
    for (std::size_t i = 0; i < other.size(); i += 64)
        ++other[i];
}

// Medians of some rounds, in seconds, all of them undone again.
std::map<std::string, double> times_of_all(Document& document) {
    Entities all;
    for (const Entity entity : document.registry().entities())
        if (document.exists(entity))
            all.push_back(entity);
    const std::size_t start = document.history().position();
    std::map<std::string, std::vector<double>> times;
    for (int round = 0; round < 5; ++round) {
        const auto time = [&](const char* name, const std::function<void()>& action) {
            forget_caches();
            times[name].push_back(seconds_of(action));
            document.take_updates(); // as the window does after each
        };
        time("select", [&] { document.select(all); });
        time("duplicate", [&] { duplicate(document, all); });
        time("undo", [&] { document.undo(); });
        time("delete", [&] { remove(document, all); });
        time("undo of that", [&] { document.undo(); });
        time("reparent", [&] { static_cast<void>(reparent(document, topmost(document, all), Entity())); });
        while (document.history().position() > start) // in a flat scene none has changed its place
            document.undo();
        document.take_updates();
    }
    std::map<std::string, double> result;
    for (auto& [name, values] : times) {
        std::nth_element(values.begin(), values.begin() + 2, values.end());
        result[name] = values[2];
    }
    return result;
}

TEST(EditorSize, EditsOfOneCostTheSameInLargeScenes) {
    // Below this nobody notices: a hundredth of a frame of the GUI here.
    constexpr double unnoticed = 2e-4; // s
    for (const Shape shape : {Shape::flat, Shape::deep, Shape::one_parent}) {
        SCOPED_TRACE(shape_names[int(shape)]);
        const auto small = make_scene(shape, 100), large = make_scene(shape, 10000);
        const auto few = times_of_one(*small, 60), many = times_of_one(*large, 60);
        for (const auto& [name, seconds] : many) {
            EXPECT_LE(seconds, std::max(3.0 * few.at(name), unnoticed)) << name;
            std::printf("%s, %s of one: %.0f us of 100, %.0f us of 10,000\n", shape_names[int(shape)], name.c_str(),
                        1e6 * few.at(name), 1e6 * seconds);
        }
    }
}

TEST(EditorSize, EditsOfAllGrowWithTheirNumber) {
    // The square would be 100. The long size holds the target, on a machine that does nothing else; in the short one
    // nobody waits for what fits into a frame.
    const double most = by_size(40.0, 15.0), frame = by_size(1.0 / 30.0, 0.0); // s
    for (const Shape shape : {Shape::flat, Shape::deep, Shape::one_parent}) {
        SCOPED_TRACE(shape_names[int(shape)]);
        const auto small = make_scene(shape, 1000), large = make_scene(shape, 10000);
        const auto few = times_of_all(*small), many = times_of_all(*large);
        for (const auto& [name, seconds] : many) {
            EXPECT_LE(seconds, std::max(most * few.at(name), frame)) << name;
            std::printf("%s, %s of all: %.2f ms of 1,000, %.2f ms of 10,000, %.1f times\n", shape_names[int(shape)],
                        name.c_str(), 1e3 * few.at(name), 1e3 * seconds, seconds / few.at(name));
        }
    }
}

// Frames of the GUI with all panels, while the pointer moves over them.
double median_gui_time(const fs::path& folder, Shape shape, int count) {
    DrivenEditor editor(folder / std::to_string(count));
    const fs::path file = folder / std::to_string(count) / "scene.scene.json";
    EXPECT_TRUE(make_scene(shape, count)->save(file));
    editor.start({file.string()});
    EXPECT_TRUE(editor.settles()) << editor.log();
    for (int x = 0; x < 150; ++x)
        editor.point_at(20 + x, 200 + x);
    const auto report = editor.end();
    return report.is_object() ? report["gui_ms"]["median"].get<double>() : 0.0;
}

TEST(EditorSize, PanelsCostTheSameForManyEntities) {
    if (!DrivenEditor::possible())
        GTEST_SKIP() << "Xvfb, xdotool and openbox are not installed";
    const fs::path folder = fs::path(testing::TempDir()) / ("sunfleck_size_" + std::to_string(getpid()));
    const std::vector<Shape> shapes = tests::long_size()
                                          ? std::vector<Shape>{Shape::flat, Shape::deep, Shape::one_parent}
                                          : std::vector<Shape>{Shape::deep};
    for (const Shape shape : shapes) {
        SCOPED_TRACE(shape_names[int(shape)]);
        fs::remove_all(folder);
        const double few = median_gui_time(folder, shape, 100), many = median_gui_time(folder, shape, 10000);
        ASSERT_GT(few, 0.0);
        EXPECT_LE(many, 2.0 * few);
        std::printf("%s: %.1f ms with 100, %.1f ms with 10,000\n", shape_names[int(shape)], few, many);
    }
    fs::remove_all(folder);
}

} // namespace
} // namespace sunfleck::editor
