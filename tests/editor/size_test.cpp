// How edits scale with the scene: one entity's cost what they cost in a small scene, all entities' grow with their
// number.
#include "editor/document/edits.h"
#include "tests/editor/size_scene.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <map>
#include <random>

namespace sunfleck::editor {
namespace {

using tests::by_size, tests::make_scene, tests::Shape, tests::shape_name;

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
    const std::size_t start = document.history().position();
    for (int round = 0; round < rounds; ++round) {
        const Entity one = all[1 + random() % (all.size() - 1)];
        if (!document.exists(one))
            continue;
        const auto time = [&](const char* name, const std::function<void()>& edit) {
            times[name].push_back(seconds_of([&] {
                edit();
                document.roots(); // as the tree is drawn after it
            }));
            document.take_updates(); // as the window does after each frame
        };
        time("select", [&] { document.select({one}); });
        time("rename", [&] { EXPECT_TRUE(rename(document, one, "new " + std::to_string(round))); });
        time("reparent", [&] { static_cast<void>(reparent(document, {one}, Entity())); });
        // A leaf: with a subtree, it would not be one entity.
        Entity leaf = one;
        while (!document.children(leaf).empty())
            leaf = document.children(leaf).front();
        time("delete", [&] { remove(document, {leaf}); });
        time("undo", [&] { document.undo(); });
        while (document.history().position() > start)
            document.undo();
        document.roots();
        document.take_updates();
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
            times[name].push_back(seconds_of([&] {
                action();
                document.roots();
            }));
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
    // In the short size, beside other tests, nobody notices a hundredth of a frame of the GUI.
    const double unnoticed = by_size(2e-4, 0.0); // s
    for (const Shape shape : {Shape::flat, Shape::deep, Shape::one_parent}) {
        SCOPED_TRACE(shape_name(shape));
        const auto small = make_scene(shape, 100), large = make_scene(shape, 10000);
        const auto few = times_of_one(*small, 60), many = times_of_one(*large, 60);
        for (const auto& [name, seconds] : many) {
            EXPECT_LE(seconds, std::max(3.0 * few.at(name), unnoticed)) << name;
            std::printf("%s, %s of one: %.0f us of 100, %.0f us of 10,000\n", shape_name(shape), name.c_str(),
                        1e6 * few.at(name), 1e6 * seconds);
        }
    }
}

TEST(EditorSize, EditsOfAllGrowWithTheirNumber) {
    // The square would be 100. The long size holds the target, on a machine that does nothing else; in the short one
    // nobody waits for what fits into a frame.
    const double most = by_size(40.0, 15.0), frame = by_size(1.0 / 30.0, 0.0); // s
    for (const Shape shape : {Shape::flat, Shape::deep, Shape::one_parent}) {
        SCOPED_TRACE(shape_name(shape));
        const auto small = make_scene(shape, 1000), large = make_scene(shape, 10000);
        const auto few = times_of_all(*small), many = times_of_all(*large);
        for (const auto& [name, seconds] : many) {
            EXPECT_LE(seconds, std::max(most * few.at(name), frame)) << name;
            std::printf("%s, %s of all: %.2f ms of 1,000, %.2f ms of 10,000, %.1f times\n", shape_name(shape),
                        name.c_str(), 1e3 * few.at(name), 1e3 * seconds, seconds / few.at(name));
        }
    }
}

} // namespace
} // namespace sunfleck::editor
