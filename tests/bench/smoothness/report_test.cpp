// The report of smoothness: held where all was measured and is within its bounds, and not otherwise.
#include "tests/bench/smoothness/report.h"

#include "engine/core/file.h"
#include "tests/bench/smoothness/pass_times.h"
#include "tests/bench/smoothness/picture_errors.h"
#include "tests/support/folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace sunfleck::bench {
namespace {

struct SmoothnessReport : testing::Test {
    using Json = nlohmann::json;

    void write(const std::string& name, const Json& content) {
        ASSERT_TRUE(write_file(folder.path / (name + ".json"), content.dump()));
    }
    static Json pacing(double milliseconds, const std::string& ended = "the time is over") {
        return {{"measured", "pacing"},
                {"room", "porch"},
                {"ended", ended},
                {"frames_ms", std::vector<double>(300, milliseconds)}};
    }
    static Json latency(unsigned lost) {
        const std::vector<double> quick(20, 60.0);
        return {{"measured", "latency"},
                {"room", "porch"},
                {"looking_ms", quick},
                {"walking_ms", quick},
                {"frames_ms", std::vector<double>(50, 50.0)},
                {"lost", lost}};
    }
    // Of the program itself: a pass runs in every frame, another in half of them, a stage in every frame.
    static Json passes(double milliseconds, double sensors = 0.04) {
        const std::vector<double> all(200, milliseconds), half(100, 3.0 * milliseconds),
            rays(200, sensors * milliseconds);
        return {{"each_frame",
                 {{"frame_ms", all},
                  {"gpu_ms", {{"shade", all}, {"bake", half}}},
                  {"cpu_ms", {{"sort", all}, {"light sensors", rays}}}}}};
    }
    static Json picture(double flip, const char* room = "porch") {
        return {{"measured", "picture"}, {"room", room}, {"moment", "settled"}, {"spp", 64}, {"flip", flip}};
    }
    void write_all() {
        write("before-passes1", passes(150.0));
        write("after-passes1", passes(50.0));
        write("before-picture-porch-settled", picture(0.100));
        write("after-picture-porch-settled", picture(0.109));
        write("before-pacing-porch", pacing(150.0));
        write("after-pacing-porch", pacing(50.0));
        write("after-latency-porch", latency(1));
        write("least-pacing-porch", pacing(45.0));
        for (const int target : {100, 66, 50})
            write("target" + std::to_string(target) + "-pacing-porch", pacing(target));
    }
    bool held() const { return report(folder.path).value(); }

    tests::Folder folder{"sunfleck_smoothness"};
};

TEST_F(SmoothnessReport, HoldsWhereAllIsMeasuredAndWithinBounds) {
    EXPECT_FALSE(held()) << "nothing was measured";
    write_all();
    EXPECT_TRUE(held());
}

TEST_F(SmoothnessReport, WhatWasNotMeasuredIsMissed) {
    for (const char* name :
         {"before-pacing-porch", "after-pacing-porch", "after-latency-porch", "least-pacing-porch",
          "target100-pacing-porch", "target66-pacing-porch", "target50-pacing-porch", "before-passes1", "after-passes1",
          "before-picture-porch-settled", "after-picture-porch-settled"}) {
        write_all();
        std::filesystem::remove(folder.path / (std::string(name) + ".json"));
        EXPECT_FALSE(held()) << name;
    }
}

TEST_F(SmoothnessReport, BoundsAreHeld) {
    write_all();
    write("after-latency-porch", latency(4));
    EXPECT_FALSE(held()) << "events that never showed";
    write_all();
    write("after-pacing-corner", pacing(50.0, "the lantern is out of reach"));
    EXPECT_FALSE(held()) << "a run that ended early";
    write("after-pacing-corner", pacing(50.0, "the game is over"));
    EXPECT_TRUE(held());
    write("after-pacing-corner", pacing(200.0));
    EXPECT_FALSE(held()) << "long frames";
    write("after-pacing-corner", pacing(50.0));
    write("target50-pacing-porch", pacing(60.0));
    EXPECT_FALSE(held()) << "a target that is missed";
    write("target50-pacing-porch", pacing(39.0));
    EXPECT_FALSE(held()) << "frames much shorter than the target";
    write("least-pacing-porch", pacing(58.0));
    write("target50-pacing-porch", pacing(60.0));
    EXPECT_FALSE(held()) << "a target below what the least settings take, of which the game said nothing";
    Json beyond = pacing(60.0);
    beyond["said_out_of_reach"] = true;
    write("target50-pacing-porch", beyond);
    EXPECT_TRUE(held()) << "the game said so";
    write("least-pacing-porch", pacing(57.0));
    EXPECT_FALSE(held()) << "the least settings hold it, whatever the game said";
    write_all();
    write("after-passes1", passes(50.0, 0.06));
    EXPECT_FALSE(held()) << "rays that take more than a twentieth of a frame";
    write_all();
    EXPECT_TRUE(held());
    write("after-picture-porch-settled", picture(0.111));
    EXPECT_FALSE(held()) << "a picture that is worse";
    write_all();
    write("after-picture-corner-settled", picture(0.01, "corner"));
    EXPECT_FALSE(held()) << "a view that was not measured before";
}

// Where a line begins with this, what stands behind it.
std::string behind(const std::string& table, const std::string& name) {
    const std::size_t at = table.find("\n    " + name + " ");
    if (at == std::string::npos)
        return "no line";
    const std::size_t from = at + 5 + name.size();
    std::string line = table.substr(from, table.find('\n', from) - from), squeezed;
    for (const char c : line)
        if (c != ' ' || (!squeezed.empty() && squeezed.back() != ' '))
            squeezed += c;
    squeezed.erase(squeezed.find_last_not_of(' ') + 1);
    return squeezed;
}

TEST(SmoothnessPasses, TableHasBothSidesTheLongestFirst) {
    using List = std::vector<double>;
    PassTimes before, after;
    const nlohmann::json whole = List{100.0, 100.0, 100.0};
    before.add(
        {{"frame_ms", whole}, {"gpu_ms", {{"shade", {8.0, 9.0, 10.0}}, {"gone", {5.0, 5.0, 5.0}}, {"load", {0.001}}}}});
    after.add({{"frame_ms", whole}, {"gpu_ms", {{"shade", {3.0, 2.0, 1.0}}}}, {"cpu_ms", {{"sort", {4.0, 4.0, 4.0}}}}});
    after.add({{"frame_ms", whole},
               {"gpu_ms", {{"shade", {2.0, 2.0, 2.0}}, {"new", {1.0}}}},
               {"cpu_ms", {{"sort", {4.0, 4.0, 4.0}}}}});
    const std::string table = pass_table(before, after);
    EXPECT_EQ(behind(table, "whole frame"), "100.00 100.00 ..100.00 100.00 100.00 ..100.00");
    EXPECT_EQ(behind(table, "shade"), "9.00 8.10 .. 9.90 2.00 1.25 .. 2.75");
    EXPECT_EQ(behind(table, "sort (CPU)"), "- 4.00 4.00 .. 4.00");
    EXPECT_EQ(behind(table, "gone"), "5.00 5.00 .. 5.00 -");
    EXPECT_EQ(behind(table, "new"), "- 0.00 0.00 .. 0.75") << "frames without it are frames in which it takes nothing";
    for (const auto& [first, second] :
         {std::pair("whole frame", "sort"), {"sort", "shade"}, {"shade", "new"}, {"new", "gone"}})
        EXPECT_LT(table.find(first), table.find(second)) << first << ", " << second;
}

TEST(SmoothnessPictures, TableHasTheRatioAndWhatIsBeyondTheTarget) {
    PictureErrors errors;
    const auto add = [&](const char* side, const char* room, double flip) {
        errors.add(side, {{"room", room}, {"moment", "settled"}, {"spp", 64}, {"flip", flip}});
    };
    add("before", "porch", 0.1);
    add("after", "porch", 0.05);
    add("reference", "porch", 0.01);
    EXPECT_TRUE(errors.held());
    add("before", "corner", 0.1);
    EXPECT_FALSE(errors.held());
    EXPECT_EQ(behind(errors.table(), "corner, settled"), "not measured after MISSED");
    add("after", "corner", 0.12);
    EXPECT_FALSE(errors.held());
    EXPECT_EQ(behind(errors.table(), "porch, settled"), "0.1000 0.0500 0.50");
    EXPECT_EQ(behind(errors.table(), "corner, settled"), "0.1000 0.1200 1.20 MISSED");
    EXPECT_NE(errors.table().find("64 samples"), std::string::npos);
    EXPECT_NE(errors.table().find("porch: 0.0100"), std::string::npos);
}

} // namespace
} // namespace sunfleck::bench
