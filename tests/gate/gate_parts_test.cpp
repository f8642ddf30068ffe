// The gate's parts one by one: plan of a pair, protocol, files of `bench level`, report.
#include "editor/gate/html_report.h"
#include "editor/gate/level_file.h"
#include "editor/gate/verdict_text.h"
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/support/run_tool.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace sunfleck::gate {
namespace {

namespace fs = std::filesystem;

const Hello walk{"device", "driver", "walk", "320x180", 600, false, {}};

// Frames of one process of a program with two passes; `seed` is its luck.
std::vector<Frame> made_up_frames(std::uint32_t count, double light, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, 0.01);
    std::vector<Frame> frames;
    for (std::uint32_t i = 0; i < count; ++i) {
        Frame frame{i, 0.0, {{"light", 8.0 * light}, {"shadow maps", 3.0}}, {{"recording", 1.0}}, {{"maps", 24.0}}};
        for (auto& [name, ms] : frame.passes)
            ms *= std::exp(normal(random));
        frame.frame_ms = 1.0 + frame.passes["light"] + frame.passes["shadow maps"] + 1.0;
        frames.push_back(frame);
    }
    return frames;
}

std::string level_file(const std::vector<Frame>& frames, const Hello& hello = walk) {
    nlohmann::ordered_json json = {{"gate", nlohmann::ordered_json::parse(hello_line(hello))}};
    for (const Frame& frame : frames)
        json["each_frame"].push_back(nlohmann::ordered_json::parse(frame_line(frame)));
    return json.dump();
}

TEST(GatePlan, TurnsCoverTheRecordingAndAlternate) {
    const PairOptions options;
    std::vector<int> drawn(629);
    int base_starts = 0;
    for (std::uint32_t pair = 0; pair < 48; ++pair) {
        const PairPlan plan = make_plan(options, 629, pair).value();
        base_starts += plan.base_starts;
        ASSERT_EQ(plan.turns.size(), 17u);
        std::uint32_t end = 0;
        for (std::size_t i = 0; i < plan.turns.size(); ++i) {
            const Turn& turn = plan.turns[i];
            EXPECT_GE(turn.frames.first, end);
            end = turn.frames.first + turn.frames.count;
            EXPECT_LE(end, 629u);
            EXPECT_EQ(turn.frames.count - turn.warm_up, i == 0 ? 0u : 6u);
            if (i > 1) {
                EXPECT_NE(turn.base_first, plan.turns[i - 1].base_first) << "A B, B A";
            }
            for (std::uint32_t frame = turn.frames.first + turn.warm_up; frame < end; ++frame)
                ++drawn[frame];
        }
    }
    EXPECT_GT(base_starts, 12);
    EXPECT_LT(base_starts, 36);
    // 48 pairs draw all frames: each is missed with a probability of (1 - 6/39)^48, 0.03 %, but for the edges.
    EXPECT_LT(std::count(drawn.begin() + 8, drawn.end() - 8, 0), 629 / 8);
    EXPECT_FALSE(make_plan(options, 131, 0));
    EXPECT_TRUE(make_plan(options, 132, 0));
}

TEST(GateProtocol, LinesSurviveTheJourney) {
    Hello hello = walk;
    hello.settings = {{"lights", "200"}, {"name", "a \"quoted\" one"}};
    const Hello read = parse_hello(hello_line(hello)).value();
    EXPECT_EQ(read.settings, hello.settings);
    EXPECT_EQ(read.frames, 600u);
    const Frame frame = made_up_frames(3, 1.0, 1)[2];
    const Frame back = parse_frame(frame_line(frame)).value();
    EXPECT_EQ(back.number, 2u);
    EXPECT_EQ(back.passes, frame.passes);
    EXPECT_EQ(back.stages, frame.stages);
    EXPECT_EQ(back.counters, frame.counters);
    const Request request = parse_request(request_line(DrawFrames{7, 3})).value();
    EXPECT_EQ(std::get<DrawFrames>(request).first, 7u);
    for (const char* line : {"", "frames", "frames 1", "frames 1 0", "frames -1 2", "frames 1 2 3", "picture ", "stop"})
        EXPECT_FALSE(parse_request(line)) << line;
    for (const char* line :
         {"{\"frame\":1}", "{\"frame\":1.5,\"frame_ms\":2}", "{\"frame\":1,\"frame_ms\":0}",
          "{\"frame\":1,\"frame_ms\":null}", "{\"frame\":1,\"frame_ms\":2,\"passes\":[]}",
          "{\"frame\":1,\"frame_ms\":2,\"passes\":{\"a\":null}}", "{\"frame\":1,\"frame_ms\":1e999}"})
        EXPECT_FALSE(parse_frame(line)) << line;
}

TEST(GateCommand, WordsKeepWhatIsQuoted) {
    EXPECT_EQ(split_words("a 'b c'  \"d'e\"f").value(), (std::vector<std::string>{"a", "b c", "d'ef"}));
    EXPECT_FALSE(split_words("a 'b"));
    EXPECT_FALSE(split_words("  "));
}

class GateFiles : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::path(testing::TempDir()) / ("sunfleck_gate_files_" + std::to_string(getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    fs::path write(const char* name, const std::string& text) const {
        EXPECT_TRUE(write_file(folder / name, text));
        return folder / name;
    }
    fs::path folder;
};

TEST_F(GateFiles, TellOnlyWhatIsFarBeyondDrift) {
    const fs::path base = write("a.json", level_file(made_up_frames(120, 1.0, 1)));
    const GateRun same = compare_files(base, write("b.json", level_file(made_up_frames(120, 1.05, 2))), {}).value();
    EXPECT_EQ(outcome_of(same), Outcome::fine);
    EXPECT_NE(verdict_text(same).find("weaker verdict"), std::string::npos);
    const GateRun slower = compare_files(base, write("c.json", level_file(made_up_frames(120, 1.4, 3))), {}).value();
    EXPECT_EQ(outcome_of(slower), Outcome::slower);
    EXPECT_NE(headline(slower).find("'light'"), std::string::npos);
    std::vector<Frame> frames = made_up_frames(120, 1.0, 4);
    frames[77].counters["maps"] -= 1.0;
    const GateRun changed = compare_files(base, write("d.json", level_file(frames)), {}).value();
    EXPECT_EQ(outcome_of(changed), Outcome::changed);
    EXPECT_NE(headline(changed).find("frame 77"), std::string::npos);
}

TEST_F(GateFiles, BadOnesGetOneMessage) {
    const std::string good = level_file(made_up_frames(120, 1.0, 1));
    const fs::path base = write("a.json", good);
    Hello other = walk;
    other.recording = "run";
    std::string with_null = good;
    const std::size_t number = with_null.find("\"frame_ms\":") + 11;
    with_null.replace(number, with_null.find(',', number) - number, "null");
    const std::pair<std::string, std::string> cases[] = {
        {"", "empty, cut off"},
        {good.substr(0, good.size() / 2), "empty, cut off"},
        {"{}", "bench level"},
        {level_file(made_up_frames(120, 1.0, 1), other), "recording"},
        {level_file(made_up_frames(119, 1.0, 1)), "119"},
        {with_null, "frame_ms"},
    };
    for (const auto& [text, word] : cases) {
        const auto run = compare_files(base, write("b.json", text), {});
        ASSERT_FALSE(run) << word;
        EXPECT_NE(run.error().message.find(word), std::string::npos) << run.error().message;
    }
    const fs::path few = write("few.json", level_file(made_up_frames(20, 1.0, 1)));
    EXPECT_FALSE(compare_files(few, few, {}));
    EXPECT_FALSE(compare_files(base, folder / "missing.json", {}));
}

// Its tags in order, with those that need no end left out.
std::string unclosed_tag(const std::string& html) {
    std::vector<std::string> open;
    static const std::set<std::string> single = {"meta", "img", "line", "circle", "th", "!DOCTYPE"};
    for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
        const bool closes = html[at + 1] == '/';
        const std::size_t start = at + 1 + closes;
        const std::string name = html.substr(start, html.find_first_of(" >/", start) - start);
        if (single.count(name))
            continue;
        if (!closes)
            open.push_back(name);
        else if (open.empty() || open.back() != name)
            return "</" + name + ">";
        else
            open.pop_back();
        if (name == "script" && !closes)
            at = html.find("</script>", at) - 1;
    }
    return open.empty() ? "" : open.back();
}

TEST_F(GateFiles, TheReportStandsAlone) {
    const fs::path base = write("a.json", level_file(made_up_frames(120, 1.0, 1)));
    GateRun run = compare_files(base, write("c.json", level_file(made_up_frames(120, 1.4, 3))), {}).value();
    const fs::path pictures = SUNFLECK_SOURCE_DIR "/tests/images/level";
    PictureResult result{{"<hall>", 5}, pictures / "hall.png", pictures / "attic.png", {}, {}};
    ASSERT_TRUE(compare_picture(result, true));
    run.pictures.push_back(result);
    ASSERT_TRUE(write_html_report(folder / "report.html", run));
    const std::string html = read_file(folder / "report.html").value();
    EXPECT_EQ(unclosed_tag(html), "");
    EXPECT_LT(html.find("slower: &#39;light&#39;"), html.find("<table>")) << "the verdict comes first";
    for (const char* word : {"weaker verdict", "shadow maps", "frame times over the recording", "&lt;hall&gt;",
                             "difference times eight", "data:image/png;base64,iVBORw0KGgo"})
        EXPECT_NE(html.find(word), std::string::npos) << word;
    for (const char* word : {"http://", "https://", "<link", "src='/", "@import"})
        EXPECT_EQ(html.find(word), std::string::npos) << "not offline: " << word;
    EXPECT_FALSE(write_html_report(folder / "no/such/folder.html", run));
}

// In Chromium: with scripts every figure gets its slider and nothing is complained about; without them the same is
// there to be read.
TEST_F(GateFiles, TheReportWorksInABrowser) {
    if (tests::shell("command -v chromium").status != 0)
        GTEST_SKIP() << "chromium is not installed";
    const fs::path base = write("a.json", level_file(made_up_frames(120, 1.0, 1)));
    GateRun run = compare_files(base, write("c.json", level_file(made_up_frames(120, 1.4, 3))), {}).value();
    const fs::path pictures = SUNFLECK_SOURCE_DIR "/tests/images/level";
    for (const char* name : {"attic.png", "hall.png"}) {
        PictureResult result{{name, 5}, pictures / "hall.png", pictures / name, {}, {}};
        ASSERT_TRUE(compare_picture(result, true));
        run.pictures.push_back(result);
    }
    ASSERT_TRUE(write_html_report(folder / "report.html", run));
    const auto chromium = [&](const std::string& options, const char* file) {
        return tests::shell("cd " + folder.string() +
                            " && timeout 60 chromium --headless --no-sandbox --disable-gpu "
                            "--user-data-dir=$PWD/profile --window-size=1000,3000 --enable-logging=stderr " +
                            options + " file://$PWD/" + file)
            .output;
    };
    const std::string dom = chromium("--dump-dom", "report.html");
    EXPECT_NE(dom.find("data-sliders=\"2\""), std::string::npos) << dom.substr(0, 2000);
    EXPECT_NE(dom.find("clip-path: inset"), std::string::npos);
    EXPECT_EQ(dom.find("CONSOLE"), std::string::npos) << dom.substr(0, 2000);
    // Chromium takes no picture where it may not run scripts: the report goes without its own.
    std::string html = read_file(folder / "report.html").value();
    const std::size_t script = html.find("<script>");
    html.erase(script, html.find("</script>") - script);
    chromium("--screenshot=plain.png", write("plain.html", html).filename().c_str());
    const auto plain = io::read_picture(folder / "plain.png");
    ASSERT_TRUE(plain);
    // The red bar with the verdict, and the attic's and the hall's wood.
    std::size_t bar = 0, wood = 0;
    for (const vec4& pixel : plain->pixels) {
        bar += glm::length(vec3(pixel) - vec3(198, 40, 40) / 255.0f) < 0.02f;
        wood += pixel.x > 1.4f * pixel.z && pixel.y > 1.1f * pixel.z && pixel.x < 0.9f;
    }
    EXPECT_GT(bar, 20000u);
    EXPECT_GT(wood, 20000u);
}

} // namespace
} // namespace sunfleck::gate
