// The report of smoothness: held where all was measured and is within its bounds, and not otherwise.
#include "tests/bench/smoothness/report.h"

#include "engine/core/file.h"
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
    void write_all() {
        write("before-pacing-porch", pacing(150.0));
        write("after-pacing-porch", pacing(50.0));
        write("after-latency-porch", latency(1));
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
    for (const char* name : {"before-pacing-porch", "after-pacing-porch", "after-latency-porch",
                             "target100-pacing-porch", "target66-pacing-porch", "target50-pacing-porch"}) {
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
}

} // namespace
} // namespace sunfleck::bench
