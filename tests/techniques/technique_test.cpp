// A technique that is not the module's: one call adds it, and everything that users see of techniques shows it.
#include "editor/command_line/metrics.h"
#include "editor/command_line/program.h"
#include "engine/core/file.h"
#include "gi_module/include/sunfleck/host.h"
#include "test_places.h"
#include "tests/support/gpu_world.h"
#include "tests/techniques/constant_light.h"

#include <nlohmann/json.hpp>
#include <unistd.h>

namespace sunfleck::tests {
namespace {

class AddedTechnique : public GpuTest {
protected:
    void SetUp() override {
        GpuTest::SetUp();
        folder = std::filesystem::path(testing::TempDir()) / ("sunfleck_technique_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
    }
    void TearDown() override {
        std::filesystem::remove_all(folder);
        GpuTest::TearDown();
    }
    // The tool in this process: its exit status; what it printed is in `printed`.
    int tool(std::vector<std::string> arguments) {
        std::vector<const char*> words = {"sunfleck"};
        for (const std::string& argument : arguments)
            words.push_back(argument.c_str());
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        const int status = command_line::run_program(int(words.size()), words.data());
        printed = testing::internal::GetCapturedStdout();
        errors = testing::internal::GetCapturedStderr();
        return status;
    }
    int render(std::vector<std::string> arguments) {
        const std::vector<std::string> common = {"render",   "cornell", "--size",   "32x24",
                                                 "--lights", "8",       "--frames", "1",
                                                 "--warmup", "1",       "--set",    "shadow_map_resolution=32"};
        arguments.insert(arguments.begin(), common.begin(), common.end());
        return tool(arguments);
    }
    std::string path(const char* name) const { return (folder / name).string(); }

    std::filesystem::path folder;
    std::string printed, errors;
};

bool contains(const std::vector<std::string_view>& list, std::string_view name) {
    return std::find(list.begin(), list.end(), name) != list.end();
}

TEST_F(AddedTechnique, IsOfferedForTheTermsThatItCanLight) {
    EXPECT_TRUE(contains(gi::Settings::find("indirect")->choices, "constant_light"));
    EXPECT_FALSE(contains(gi::Settings::find("direct")->choices, "constant_light"));
    EXPECT_FALSE(contains(gi::Settings::find("specular")->choices, "constant_light"));
    gi::Settings settings;
    EXPECT_TRUE(settings.set("indirect", "constant_light"));
    EXPECT_TRUE(settings.validate());
    EXPECT_TRUE(settings.set("plan", "indirect.dynamic=constant_light"));
    EXPECT_TRUE(settings.validate());
    EXPECT_TRUE(settings.set("plan", "direct=constant_light"));
    EXPECT_FALSE(settings.validate());
}

TEST_F(AddedTechnique, ItsSettingsCountersAndViewsAreListed) {
    EXPECT_TRUE(contains(gi::Settings::names(), "constant_irradiance"));
    gi::Settings settings;
    EXPECT_TRUE(settings.set("constant_irradiance", "2"));
    EXPECT_EQ(settings.of<ConstantLightSettings>().constant_irradiance, 2.0f);
    EXPECT_FALSE(settings.set("constant_irradiance", "-1"));
    std::vector<std::string_view> counters, views;
    for (const gi::Counter* counter : gi::all_counters())
        counters.push_back(counter->name);
    for (const gi::DebugView* view : gi::debug_views())
        views.push_back(view->name);
    EXPECT_TRUE(contains(counters, "constant_light_pixels"));
    EXPECT_TRUE(contains(views, "constant_light_surfaces"));
}

TEST_F(AddedTechnique, TheToolDescribesIt) {
    ASSERT_EQ(tool({"info"}), 0) << errors;
    EXPECT_NE(printed.find("constant_irradiance"), std::string::npos) << printed;
    EXPECT_NE(printed.find("What every surface gets of the constant light"), std::string::npos);
    EXPECT_NE(printed.find("constant_light"), std::string::npos);
    ASSERT_EQ(tool({"render", "--help"}), 0);
    EXPECT_NE(printed.find("constant_light"), std::string::npos) << printed;
    EXPECT_NE(printed.find("constant_light_surfaces"), std::string::npos) << printed;
}

TEST_F(AddedTechnique, TheToolRendersWithIt) {
    ASSERT_EQ(render({"-o", path("a.exr"), "--indirect", "constant_light", "--set", "constant_irradiance=0.5",
                      "--stats", path("a.json")}),
              0)
        << errors;
    const auto json = nlohmann::json::parse(read_file(path("a.json")).value());
    EXPECT_EQ(json["settings"]["indirect"], "constant_light");
    EXPECT_EQ(json["settings"]["constant_irradiance"], 0.5);
    EXPECT_EQ(json["counters"]["constant_light_pixels"], 32 * 24);
    EXPECT_TRUE(json["gpu_ms"].contains("constant light"));
    EXPECT_NE(render({"-o", path("b.exr"), "--set", "constant_irradiance=-1"}), 0);
    EXPECT_NE(errors.find("constant_irradiance"), std::string::npos) << errors;
    EXPECT_NE(render({"-o", path("b.exr"), "--direct", "constant_light"}), 0);
}

TEST_F(AddedTechnique, TheToolShowsItsView) {
    ASSERT_EQ(render({"-o", path("a.exr"), "--indirect", "constant_light", "--view", "constant_light_surfaces"}), 0)
        << errors;
    const auto picture = io::read_picture(path("a.exr"));
    ASSERT_TRUE(picture);
    for (const vec4& pixel : picture->pixels)
        EXPECT_EQ(vec3(pixel), pixel.w > 0.0f ? vec3(0, 1, 0) : vec3(0));
    // A view of a technique that lights nothing is refused.
    EXPECT_NE(render({"-o", path("b.exr"), "--view", "constant_light_surfaces"}), 0);
    EXPECT_NE(errors.find("constant_light"), std::string::npos) << errors;
}

TEST_F(AddedTechnique, AForeignHostHasIt) {
    const auto context = host::Context::create({device().instance(), device().physical_device(), device().handle(),
                                                device().queue(), device().queue_family()});
    ASSERT_TRUE(context) << context.error().message;
    EXPECT_TRUE((*context)->set("indirect", "constant_light"));
    EXPECT_TRUE((*context)->set("constant_irradiance", "0.5"));
    EXPECT_FALSE((*context)->set("constant_irradiance", "nan"));
    bool listed = false;
    for (const host::Statistic& statistic : (*context)->statistics().counters)
        listed = listed || (statistic.name == "constant_light_pixels" && statistic.unit == "pixels");
    EXPECT_TRUE(listed);
}

// Light is a sum: beside another technique for direct light, the picture is that technique's plus the constant.
TEST_F(AddedTechnique, ItsLightIsAdded) {
    for (const gi::TechniqueEntry& other : gi::techniques()) {
        if (!contains(gi::Settings::find("direct")->choices, other.name))
            continue;
        GpuWorld world(assets::make_four_pillars, "view");
        gi::Settings settings;
        settings.lights = 40;
        settings.low_resolution = 1;
        settings.with("direct", other.name).with("indirect", "none").with("sampled_light", "all");
        world.set(settings);
        const io::Picture direct = world.picture();
        settings.with("indirect", "constant_light").with("constant_irradiance", "0.5");
        world.set(settings);
        const io::Picture both = world.picture();
        ASSERT_EQ(both.pixels.size(), direct.pixels.size());
        for (std::size_t i = 0; i < both.pixels.size(); ++i) {
            const vec3 expected = vec3(direct.pixels[i]) + (direct.pixels[i].w > 0.0f ? 0.5f : 0.0f);
            EXPECT_EQ(both.pixels[i].w, direct.pixels[i].w);
            ASSERT_LE(glm::length(vec3(both.pixels[i]) - expected), 1e-3f * glm::length(expected)) << other.name;
        }
        EXPECT_EQ(world.renderer->lighting().counters()["constant_light_pixels"], 64.0 * 48.0);
    }
}

// What is not the technique's own: nothing else of the project names it.
TEST_F(AddedTechnique, NothingElseKnowsIt) {
    namespace fs = std::filesystem;
    const fs::path root = SUNFLECK_SOURCE_DIR;
    int files = 0;
    for (const char* part : {"gi_module", "engine", "viewer", "editor", "game_demo", "assets", "cmake"})
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / part)) {
            if (!entry.is_regular_file())
                continue;
            const std::string text = read_file(entry.path()).value();
            ++files;
            for (const char* word : {"constant_light", "ConstantLight", "constant_irradiance"})
                EXPECT_EQ(text.find(word), std::string::npos) << word << " in " << entry.path();
        }
    EXPECT_GT(files, 300);
}

} // namespace
} // namespace sunfleck::tests

int main(int argc, char** argv) {
    sunfleck::gi::add_technique(sunfleck::tests::constant_light());
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
