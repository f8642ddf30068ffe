// Every option of `render` and `reference` does something: each that --help shows stands in a table here with a value
// that changes the picture, makes a file, or ends otherwise, or with the reason why nothing is to be seen of it.
#include "editor/command_line/program.h"
#include "engine/core/file.h"
#include "tests/support/gltf_files.h"
#include "tests/support/option_list.h"
#include "tests/support/test_size.h"

#include <algorithm>

namespace sunfleck::tests {
namespace {

enum class Effect { picture, file, failure, none };

struct OptionCase {
    std::string option, scene;
    std::vector<std::string> words; // the option with a value, and what else it takes to see it
    Effect effect = Effect::picture;
    const char* why = ""; // of Effect::none
};

const std::vector<OptionCase>& common_cases() {
    static const std::vector<OptionCase> cases = {
        {"--size", "four_pillars", {"--size", "20x14"}},
        {"--camera", "four_pillars", {"--camera", "0.5,1,2,0,1,0,60"}},
        {"--movers", "four_pillars", {"--movers", "static", "--bounces", "5"}},
        {"--motion", "four_pillars", {"--motion", "off", "--warmup", "40"}},
        {"--orbit", "four_pillars", {"--orbit", "20"}},
        {"--frames", "four_pillars", {"--frames", "40"}},
        {"--warmup", "four_pillars", {"--warmup", "40"}},
        {"--seed", "four_pillars", {"--seed", "2"}},
        {"--bounces", "four_pillars", {"--bounces", "0"}},
        {"--ev100", "four_pillars", {"--ev100", "3"}},
        {"--environment", "arena", {"--environment", "sky.png"}},
        {"--scene", "two.glb", {"--scene", "1"}},
        {"--variant", "two.glb", {"--variant", "red"}},
        {"--animation", "two.glb", {"--animation", "-1", "--warmup", "40"}},
        {"--allow-outside", "in/out.scene.json", {"--allow-outside"}, Effect::failure},
        {"--memory", "four_pillars", {"--memory", "1", "--size", "1200x900"}, Effect::failure},
        {"--device", "four_pillars", {"--device", "no such device"}, Effect::failure},
        {"--validation", "", {}, Effect::none, "only what is wrong gives a message"},
        {"--output", "", {}, Effect::none, "all of these cases have one"},
        {"--stats", "four_pillars", {"--stats", "made"}, Effect::file},
        {"--view", "four_pillars", {"--view", "irradiance"}},
    };
    return cases;
}

std::vector<OptionCase> render_cases() {
    std::vector<OptionCase> cases = common_cases();
    const std::vector<OptionCase> own = {
        {"--punctual", "two.glb", {"--punctual", "none"}},
        {"--direct", "four_pillars", {"--direct", "none"}},
        {"--indirect", "four_pillars", {"--indirect", "none"}},
        {"--specular", "", {}, Effect::none, "it has one value"},
        {"--source", "", {}, Effect::none, "it has one value"},
        {"--lights", "four_pillars", {"--lights", "12"}},
        {"--direct-share", "four_pillars", {"--direct-share", "0.9"}},
        {"--antialiasing", "four_pillars", {"--antialiasing", "false"}},
        {"--glare", "four_pillars", {"--glare", "0.4"}},
        {"--set", "four_pillars", {"--set", "shadows=off"}},
        {"--trace", "four_pillars", {"--trace", "made"}, Effect::file},
        {"--print-graph", "", {}, Effect::none, "it prints"},
    };
    cases.insert(cases.end(), own.begin(), own.end());
    return cases;
}

std::vector<OptionCase> reference_cases() {
    std::vector<OptionCase> cases = common_cases();
    for (OptionCase& of : cases) {
        if (of.option == "--device")
            of = {"--device", "", {}, Effect::none, "the path tracer runs on the CPU"};
        if (of.option == "--memory")
            of.words = {"--memory", "1", "--size", "1200x900", "--spp", "1"};
        if (of.option == "--movers")
            of = {"--movers",
                  "",
                  {},
                  Effect::none,
                  "to the path tracer all is alike, and light that movers reflect is there"};
    }
    const std::vector<OptionCase> own = {
        {"--spp", "four_pillars", {"--spp", "3"}},
        {"--antialiasing", "four_pillars", {"--antialiasing"}},
        {"--unlimited", "four_pillars", {"--unlimited", "--spp", "64"}},
        {"--caustics", "ring", {"--caustics", "off", "--spp", "64"}},
        {"--light-paths", "glass", {"--light-paths", "--view", "irradiance"}},
        {"--lambertian", "glass", {"--lambertian"}},
        {"--save-interval", "", {}, Effect::none, "the same picture, in whichever parts it is saved"},
    };
    cases.insert(cases.end(), own.begin(), own.end());
    return cases;
}

class RobustOptionEffects : public testing::Test {
protected:
    void SetUp() override {
        std::filesystem::create_directory(folder.path / "in");
        make_scene();
        before_ = std::filesystem::current_path();
        std::filesystem::current_path(folder.path);
        ASSERT_EQ(run({"render", "cornell", "-o", "sky.png", "--size", "8x4", "--lights", "4", "--warmup", "0"}), 0);
    }
    void TearDown() override { std::filesystem::current_path(before_); }

    // Two scenes of a square, with a variant, an animation and a lamp; and a scene file that names it from a folder
    // below.
    void make_scene() {
        GltfBuilder file;
        file.add_square();
        const int times = file.floats({0, 1}, "SCALAR", 1), places = file.floats({0, 0, 0, 0.4f, 0, 0}, "VEC3", 3);
        file.file["scenes"] = {{{"nodes", {0, 2}}}, {{"nodes", {1, 2}}}};
        file.file["nodes"] = {
            {{"name", "a"}, {"mesh", 0}},
            {{"name", "b"}, {"mesh", 0}, {"scale", {0.5, 0.5, 0.5}}},
            {{"name", "lamp"}, {"translation", {0, 1, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
        file.file["animations"] = {
            {{"samplers", {{{"input", times}, {"output", places}}}},
             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
        file.file["materials"] = {json::object(), {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}}};
        file.file["extensionsUsed"] = {"KHR_materials_variants", "KHR_lights_punctual"};
        file.file["extensions"] = {{"KHR_materials_variants", {{"variants", {{{"name", "red"}}}}}},
                                   {"KHR_lights_punctual", {{"lights", {{{"type", "point"}, {"intensity", 5000}}}}}}};
        file.primitive()["material"] = 0;
        file.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}}};
        ASSERT_TRUE(write_file(folder.path / "two.glb", file.glb()));
        ASSERT_TRUE(write_file(folder.path / "in/out.scene.json", R"({"sunfleck_scene":2,"gltf":"../two.glb"})"));
    }
    static int run(const std::vector<std::string>& words) {
        std::vector<const char*> arguments = {"sunfleck"};
        for (const std::string& word : words)
            arguments.push_back(word.c_str());
        return command_line::run_program(int(arguments.size()), arguments.data());
    }
    // The picture's bytes; empty where there is none.
    static std::string picture(const std::string& command, const std::string& scene,
                               const std::vector<std::string>& more) {
        std::vector<std::string> words = {command, scene, "-o", "picture.png"};
        const auto add = [&](const std::string& option, const std::string& value) {
            if (std::find(more.begin(), more.end(), option) == more.end())
                words.insert(words.end(), {option, value});
        };
        add("--size", "24x14");
        add("--warmup", "1");
        add(command == "render" ? "--lights" : "--spp", command == "render" ? "24" : "4");
        words.insert(words.end(), more.begin(), more.end());
        std::filesystem::remove("picture.png");
        std::filesystem::remove("made");
        return run(words) == 0 ? read_file("picture.png").value() : std::string();
    }
    // What else the case says, without the option.
    static std::vector<std::string> without_option(const OptionCase& of) {
        std::vector<std::string> rest;
        for (std::size_t i = 0; i < of.words.size(); ++i)
            if (of.words[i] == of.option)
                i += i + 1 < of.words.size() && of.words[i + 1].compare(0, 2, "--") != 0 ? 1u : 0u;
            else
                rest.push_back(of.words[i]);
        return rest;
    }
    static void judge(const std::string& command, const OptionCase& of) {
        const std::string what = command + " " + of.option;
        const std::string plain = picture(command, of.scene, without_option(of));
        const bool was_made = std::filesystem::exists("made");
        const std::string changed = picture(command, of.scene, of.words);
        switch (of.effect) {
        case Effect::picture:
            EXPECT_FALSE(plain.empty() || changed.empty()) << what;
            EXPECT_NE(plain, changed) << what << " changes nothing";
            break;
        case Effect::file:
            EXPECT_EQ(plain, changed) << what;
            EXPECT_TRUE(!was_made && std::filesystem::exists("made")) << what;
            break;
        case Effect::failure: // with it or without it
            EXPECT_NE(plain.empty(), changed.empty()) << what;
            break;
        case Effect::none:
            break;
        }
    }
    // In the short size every `step`th case is run; that all options are in the table is seen in both.
    static void judge_all(const std::string& command, const std::vector<OptionCase>& cases, std::size_t step) {
        for (const Option& option : options_of(Command{{command}, {}}))
            EXPECT_EQ(std::count_if(cases.begin(), cases.end(),
                                    [&](const OptionCase& of) { return of.option == option.name; }),
                      1)
                << command << " " << option.name << ": not in this test's table";
        int tried = 0, without_effect = 0;
        for (std::size_t i = 0; i < cases.size(); i += step) {
            ++tried;
            without_effect += cases[i].effect == Effect::none;
            if (cases[i].effect != Effect::none)
                judge(command, cases[i]);
        }
        std::printf("%s: %d options tried, of which %d have nothing to show\n", command.c_str(), tried, without_effect);
    }

    Folder folder;

private:
    std::filesystem::path before_;
};

TEST_F(RobustOptionEffects, OfRender) {
    judge_all("render", render_cases(), tests::by_size<std::size_t>(4, 1));
}

TEST_F(RobustOptionEffects, OfReference) {
    judge_all("reference", reference_cases(), 1);
}

} // namespace
} // namespace sunfleck::tests
