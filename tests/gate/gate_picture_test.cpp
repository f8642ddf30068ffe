// Stored pictures: which differences may pass for another machine's rounding, and which may not. The faults are planted
// in pictures of the level as it is drawn.
#include "editor/gate/picture_store.h"
#include "engine/core/file.h"
#include "test_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sunfleck::gate {
namespace {

namespace fs = std::filesystem;

const fs::path stored_pictures = SUNFLECK_SOURCE_DIR "/tests/images/level";

io::Picture hall() {
    return io::read_picture(stored_pictures / "hall.png").value();
}

// To the steps of a PNG.
float rounded(float value) {
    return std::round(std::clamp(value, 0.0f, 1.0f) * 255.0f) / 255.0f;
}

// Multiplies pixels of a rectangle.
void brighten(io::Picture& picture, std::uint32_t left, std::uint32_t top, std::uint32_t width, std::uint32_t height,
              const vec3& by) {
    for (std::uint32_t y = top; y < top + height; ++y)
        for (std::uint32_t x = left; x < left + width; ++x)
            for (int c = 0; c < 3; ++c) {
                float& value = picture.pixels[y * picture.width + x][c];
                value = rounded(value * by[c]);
            }
}

std::string fault_elsewhere(const io::Picture& picture) {
    return picture_fault(picture_difference(hall(), picture), false);
}

TEST(GatePictures, EqualPicturesAreEqual) {
    const PictureDifference difference = picture_difference(hall(), hall());
    EXPECT_TRUE(difference.equal);
    EXPECT_EQ(picture_fault(difference, true), "");
}

// What another processor may do: every value off by one at most, and 40 of 57,600 pixels anything at all.
TEST(GatePictures, AnotherMachinesRoundingPassesElsewhereOnly) {
    io::Picture picture = hall();
    std::mt19937 random(1);
    for (vec4& pixel : picture.pixels)
        for (int c = 0; c < 3; ++c)
            pixel[c] = rounded(pixel[c] + (float(random() % 3) - 1.0f) / 255.0f);
    for (std::uint32_t i = 0; i < 40; ++i) {
        vec4& pixel = picture.pixels[(i / 8 * 35 + 5) * picture.width + i % 8 * 38 + 9];
        pixel = {rounded(pixel.x + 0.1f), rounded(pixel.y - 0.1f), pixel.z, 1.0f};
    }
    const PictureDifference difference = picture_difference(hall(), picture);
    EXPECT_EQ(picture_fault(difference, false), "");
    EXPECT_NE(picture_fault(difference, true), "");
    EXPECT_GE(difference.beyond, 40u);
    EXPECT_GT(difference.flip, 0.0);
}

// One pixel's last bit is enough where the stored picture was drawn on the same kind of machine.
TEST(GatePictures, OneBitIsSeenOnTheSameMachine) {
    io::Picture picture = hall();
    picture.pixels[1234].x = rounded(picture.pixels[1234].x - 1.0f / 255.0f);
    EXPECT_NE(picture_fault(picture_difference(hall(), picture), true), "");
    EXPECT_EQ(fault_elsewhere(picture), "");
}

// A bright seam between floor and wall, one pixel high and with gaps: fewer pixels than may differ anywhere.
TEST(GatePictures, ALeakAlongOneEdgeIsCaught) {
    io::Picture picture = hall();
    for (std::uint32_t x = 60; x < 124; x += 2)
        brighten(picture, x, 92, 1, 1, vec3(1.06f));
    const PictureDifference difference = picture_difference(hall(), picture);
    EXPECT_LE(double(difference.beyond), 0.001 * double(difference.pixels));
    EXPECT_NE(fault_elsewhere(picture).find("patch or line"), std::string::npos) << fault_elsewhere(picture);
}

TEST(GatePictures, TwoPerCentMoreRedIsCaught) {
    io::Picture picture = hall();
    brighten(picture, 0, 0, picture.width, picture.height, {1.02f, 1.0f, 1.0f});
    EXPECT_NE(fault_elsewhere(picture), "");
    // By its mean alone, too, where no pixel is beyond the difference: 2 % of at most 0.5 is less than 3/255.
    io::Picture dark = hall(), dark_red = dark;
    for (vec4& pixel : dark.pixels)
        pixel = vec4(rounded(pixel.x * 0.5f), pixel.y, pixel.z, 1.0f);
    for (std::size_t i = 0; i < dark.pixels.size(); ++i)
        dark_red.pixels[i] = vec4(rounded(dark.pixels[i].x * 1.02f), dark.pixels[i].y, dark.pixels[i].z, 1.0f);
    const std::string fault = picture_fault(picture_difference(dark, dark_red), false);
    EXPECT_NE(fault.find("mean of red"), std::string::npos) << fault;
}

// The shadow of the pillar's foot, 20 by 5 pixels, is gone.
TEST(GatePictures, AMissingShadowIsCaught) {
    io::Picture picture = hall();
    brighten(picture, 180, 165, 8, 5, vec3(1.15f));
    EXPECT_NE(fault_elsewhere(picture).find("patch or line"), std::string::npos) << fault_elsewhere(picture);
    // A faint one, which no pixel gives away, by the mean of its tile.
    io::Picture faint = hall();
    brighten(faint, 85, 95, 30, 12, vec3(0.984f));
    EXPECT_NE(fault_elsewhere(faint).find("tile"), std::string::npos) << fault_elsewhere(faint);
}

TEST(GatePictures, AnotherSizeIsAFault) {
    io::Picture picture = hall();
    picture.height -= 1;
    picture.pixels.resize(std::size_t(picture.width) * picture.height);
    EXPECT_NE(fault_elsewhere(picture), "");
}

class GatePictureStore : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("sunfleck_store_" + std::to_string(getpid()));
        fs::create_directories(folder / "drawn");
    }
    void TearDown() override { fs::remove_all(folder); }
    fs::path folder;
};

TEST_F(GatePictureStore, AcceptListsWhatItWrote) {
    const Hello hello{"device", "driver", "walk", "320x180", 100, true, {{"lights", "200"}}};
    for (const char* name : {"a.png", "b.png"})
        fs::copy(stored_pictures / "hall.png", folder / "drawn" / name);
    const PictureStore store{folder / "stored", {}, {}, {}, {}, {{"a", 5}, {"b", 7}}};
    EXPECT_EQ(accept_pictures(store, hello, folder / "drawn").value().size(), 3u); // with the manifest
    const PictureStore read = read_picture_store(folder / "stored").value();
    EXPECT_EQ(read.maker, (Maker{processor_name(), "driver"}));
    EXPECT_EQ(read.frames.size(), 2u);
    EXPECT_EQ(compare_with_store(read, hello, folder / "drawn").value()[1].fault, "");
    // Only what differs is written again.
    fs::copy(stored_pictures / "attic.png", folder / "drawn/b.png", fs::copy_options::overwrite_existing);
    EXPECT_NE(compare_with_store(read, hello, folder / "drawn").value()[1].fault, "");
    const auto written = accept_pictures(read, hello, folder / "drawn").value();
    ASSERT_EQ(written.size(), 2u);
    EXPECT_EQ(written[0], folder / "stored/b.png");
}

TEST_F(GatePictureStore, OtherSettingsAndDamageGetOneMessage) {
    Hello hello{"device", "driver", "walk", "320x180", 100, true, {{"lights", "200"}}};
    fs::copy(stored_pictures / "hall.png", folder / "drawn/a.png");
    ASSERT_TRUE(accept_pictures({folder / "stored", {}, {}, {}, {}, {{"a", 5}}}, hello, folder / "drawn"));
    const PictureStore store = read_picture_store(folder / "stored").value();
    hello.settings["lights"] = "300";
    const auto other = compare_with_store(store, hello, folder / "drawn");
    ASSERT_FALSE(other);
    EXPECT_NE(other.error().message.find("'lights'"), std::string::npos);
    for (const char* text : {"", "{", "[]", "{\"sunfleck_pictures\":1}",
                             R"({"sunfleck_pictures":1,"processor":"","driver":"","recording":"","size":"",)"
                             R"("frames":{"../a":1}})"}) {
        ASSERT_TRUE(write_file(folder / "stored/manifest.json", text));
        EXPECT_FALSE(read_picture_store(folder / "stored")) << text;
    }
    EXPECT_FALSE(parse_named_frame("a"));
    EXPECT_FALSE(parse_named_frame("a/b=3"));
    EXPECT_FALSE(parse_named_frame("a=-3"));
    EXPECT_EQ(parse_named_frame("a=3").value().frame, 3u);
}

} // namespace
} // namespace sunfleck::gate
