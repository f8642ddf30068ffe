// A host may have set the user's language, whose decimals have a comma: numbers of files, options and settings stay as
// they are, and so do pictures.
#include "editor/command_line/program.h"
#include "engine/core/file.h"
#include "engine/io/scene_file.h"
#include "gi_module/settings.h"
#include "tests/support/gltf_files.h"
#include "tests/support/gpu_device.h"
#include "tests/support/host_program.h"
#include "tests/support/run_tool.h"

#include <clocale>

namespace sunfleck::tests {
namespace {

// The language is made for the test where the system has none.
class RobustDecimalComma : public GpuTest {
protected:
    void SetUp() override {
        GpuTest::SetUp();
        const std::string made = folder.path.string();
        shell("localedef -i de_DE -f UTF-8 '" + made + "/de_DE.UTF-8'");
        ::setenv("LOCPATH", made.c_str(), 1);
        if (!speak(true))
            GTEST_SKIP() << "no language with a decimal comma is here: Debian's package locales has one";
    }
    void TearDown() override {
        speak(false);
        GpuTest::TearDown();
    }
    static bool speak(bool comma) {
        return std::setlocale(LC_ALL, comma ? "de_DE.UTF-8" : "C") != nullptr &&
               *std::localeconv()->decimal_point == (comma ? ',' : '.');
    }
    // Once in each language; the same comes of both.
    template <typename Make>
    static void expect_same(const Make& make) {
        const auto with_comma = make();
        ASSERT_TRUE(speak(false));
        const auto with_point = make();
        EXPECT_TRUE(with_comma == with_point);
    }
    // The picture that the tool makes; its statistics are JSON, and have fractions.
    std::string picture(std::vector<std::string> words) const {
        const std::string at = (folder / "picture").string();
        words.insert(words.begin(), "sunfleck");
        words.insert(words.end(), {"-o", at + ".exr", "--stats", at + ".json", "--camera", "0.25,1.5,2.5,0,1,0,45.5"});
        std::vector<const char*> arguments;
        for (const std::string& word : words)
            arguments.push_back(word.c_str());
        EXPECT_EQ(command_line::run_program(int(arguments.size()), arguments.data()), 0);
        const std::string statistics = read_file(at + ".json").value();
        EXPECT_TRUE(json::accept(statistics)) << statistics;
        EXPECT_NE(statistics.find('.'), std::string::npos);
        return read_file(at + ".exr").value();
    }
    const Folder folder{"sunfleck_comma"};
};

TEST_F(RobustDecimalComma, SettingsAndSceneFiles) {
    gi::Settings settings;
    EXPECT_TRUE(settings.set("direct_share", "0.5"));
    EXPECT_FALSE(settings.set("direct_share", "0,5"));
    EXPECT_EQ(settings.direct_share, 0.5f);
    EXPECT_EQ(settings.get("direct_share"), "0.5");
    World world, after;
    GltfBuilder square;
    square.add_square();
    square.file["nodes"][0]["translation"] = {0.25, 1.5, -0.125};
    ASSERT_TRUE(world.import(square.glb()));
    const std::filesystem::path path = folder / "a.scene.json";
    ASSERT_TRUE(io::save_scene(path, world.registry, world.meshes, world.textures, {{}, {{"direct_share", "0.5"}}}));
    const auto report = io::load_scene(path, after.registry, after.meshes, after.textures);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->settings.at("direct_share"), "0.5");
    EXPECT_EQ(after.registry.get<scene::Transform>(scene::find_by_name(after.registry, "square")).position,
              vec3(0.25f, 1.5f, -0.125f));
}

TEST_F(RobustDecimalComma, APictureOfThePathTracer) {
    expect_same([&] { return picture({"reference", "cornell", "--size", "12x9", "--spp", "2"}); });
}

TEST_F(RobustDecimalComma, APictureThatIsRendered) {
    expect_same([&] {
        return picture({"render", "four_pillars", "--size", "24x14", "--lights", "12", "--warmup", "1", "--orbit",
                        "1.5", "--set", "direct_share=0.5"});
    });
}

TEST_F(RobustDecimalComma, AFrameOfAHost) {
    HostProgram program(device());
    expect_same([&] {
        const OwnedContext context = make_context(program);
        describe_room(*context);
        EXPECT_TRUE(context->set("direct_share", "0.25"));
        EXPECT_FALSE(context->set("direct_share", "0,25"));
        return picture_of_room(program, *context);
    });
}

} // namespace
} // namespace sunfleck::tests
