// The editor when its GPU stops answering, by a Vulkan layer (tests/robust/lossy_layer.cpp): one message, everything is
// where it was, a new device goes on with the picture; the third loss ends the program, and no edit is lost.
#include "tests/editor/window_fixture.h"
#include "tests/support/test_size.h"

#include <fstream>
#include <random>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;
using tests::DrivenEditor;

// Set for programs that are started while it lives.
class Environment {
public:
    explicit Environment(std::vector<std::pair<std::string, std::string>> variables)
        : variables_(std::move(variables)) {
        for (const auto& [name, value] : variables_)
            ::setenv(name.c_str(), value.c_str(), 1);
    }
    ~Environment() {
        for (const auto& [name, value] : variables_)
            ::unsetenv(name.c_str());
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

private:
    std::vector<std::pair<std::string, std::string>> variables_;
};

class EditorWindowLoss : public tests::EditorWindowTest {
protected:
    void SetUp() override {
        EditorWindowTest::SetUp();
        environment = std::make_unique<Environment>(std::vector<std::pair<std::string, std::string>>{
            {"VK_LAYER_PATH", SUNFLECK_LAYERS ":/usr/share/vulkan/explicit_layer.d"},
            {"VK_INSTANCE_LAYERS", "VK_LAYER_SUNFLECK_lossy"},
            {"SUNFLECK_LOSE_FILE", (folder / "lose").string()}});
    }
    void TearDown() override {
        EditorWindowTest::TearDown();
        environment.reset();
    }
    int count(const std::string& part) const {
        const std::string text = editor->log();
        int found = 0;
        for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
            ++found;
        return found;
    }
    // The device that submits next is lost; the pointer's movement lets the window submit something.
    void lose() {
        std::ofstream(folder / "lose").close();
        editor->run("xdotool mousemove_relative -- 3 0 mousemove_relative -- -3 0");
    }
    bool goes_on(int loss) const {
        return DrivenEditor::wait_until([&] { return count(again) == loss; }) &&
               editor->wait_for("status/message", "The GPU stopped answering; a new device goes on with the picture");
    }
    static constexpr const char *again = "begins again on a new device",
                                *roughness = "inspector/Material/roughness/value";
    std::unique_ptr<Environment> environment;
};

TEST_F(EditorWindowLoss, EverythingIsWhereItWas) {
    editor->start({"cornell"});
    ASSERT_TRUE(editor->settles()) << editor->log();
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    ASSERT_TRUE(editor->appears(roughness));
    const std::string before = editor->value(roughness);
    ASSERT_TRUE(editor->enter(roughness, "0.25"));
    ASSERT_TRUE(editor->wait_for(roughness, "0.25"));

    // In the middle of a word, and while light is compared.
    ASSERT_TRUE(editor->write(roughness, "0.7"));
    lose();
    ASSERT_TRUE(goes_on(1)) << editor->log();
    editor->type("5");
    editor->key("Return");
    EXPECT_TRUE(editor->wait_for(roughness, "0.75")) << editor->value(roughness);
    ASSERT_TRUE(editor->settles());
    EXPECT_EQ(editor->value("menu/title"), "cornell.scene.json *");
    const int frame = std::atoi(editor->value("viewport/picture").c_str());
    EXPECT_GT(frame, 0) << "frames are counted on";

    editor->key("ctrl+z");
    EXPECT_TRUE(editor->wait_for(roughness, "0.25"));
    ASSERT_TRUE(editor->click("viewport/Inspect"));
    ASSERT_TRUE(editor->click("viewport/picture"));
    ASSERT_TRUE(editor->appears("pixel/light 1"));
    const std::string light = editor->value("pixel/in the picture");
    lose();
    ASSERT_TRUE(goes_on(2)) << editor->log();
    ASSERT_TRUE(editor->settles());
    EXPECT_TRUE(editor->wait_for("pixel/in the picture", light)) << "another device, the same light";
    ASSERT_TRUE(editor->click("tab Inspector"));
    ASSERT_TRUE(editor->appears(roughness));
    editor->key("ctrl+z");
    EXPECT_TRUE(editor->wait_for(roughness, before));
    editor->key("ctrl+shift+z");
    EXPECT_TRUE(editor->wait_for(roughness, "0.25"));

    lose();
    EXPECT_EQ(editor->wait_for_end(), 1);
    EXPECT_EQ(count("3 times"), 1);
    EXPECT_EQ(count("are offered by the next run"), 1);
    const auto report = nlohmann::json::parse(read_file(folder / "report.json").value());
    EXPECT_EQ(report["unsaved"], true);

    editor->start({});
    ASSERT_TRUE(editor->click("dialog/Recover"));
    ASSERT_TRUE(editor->click("hierarchy/tall block"));
    EXPECT_TRUE(editor->wait_for(roughness, "0.25"));
}

// At any moment: each program loses three devices, and the next one has all but the last edit. Once in the short size;
// twenty-one losses in the long one.
TEST_F(EditorWindowLoss, NoEditIsLost) {
    std::mt19937 random(7);
    const int programs = tests::by_size(1, 7);
    for (int program = 0; program < programs; ++program) {
        SCOPED_TRACE("program " + std::to_string(program));
        fs::remove(folder / "log");
        editor->start({"cornell"});
        ASSERT_TRUE(editor->appears("hierarchy/tall block"));
        ASSERT_TRUE(editor->click("hierarchy/tall block"));
        std::string last = "(none)", wanted = "(none)";
        for (int loss = 1; loss <= 3; ++loss) {
            last = wanted;
            wanted = "0." + std::to_string(11 + random() % 80);
            ASSERT_TRUE(editor->enter(roughness, wanted));
            std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
            lose();
            if (loss < 3) {
                ASSERT_TRUE(goes_on(loss)) << editor->log();
                EXPECT_TRUE(DrivenEditor::wait_until([&] {
                    return std::abs(std::atof(editor->value(roughness).c_str()) - std::atof(wanted.c_str())) < 1e-4;
                })) << wanted
                    << " but " << editor->value(roughness);
            }
        }
        EXPECT_EQ(editor->wait_for_end(), 1);
        editor->start({});
        ASSERT_TRUE(editor->click("dialog/Recover")) << editor->log();
        ASSERT_TRUE(editor->click("hierarchy/tall block"));
        ASSERT_TRUE(editor->appears(roughness));
        const double found = std::atof(editor->value(roughness).c_str());
        EXPECT_TRUE(std::abs(found - std::atof(wanted.c_str())) < 1e-4 ||
                    std::abs(found - std::atof(last.c_str())) < 1e-4)
            << found << " is neither " << wanted << " nor " << last;
        editor->key("ctrl+q");
        ASSERT_TRUE(editor->click("dialog/Discard"));
        EXPECT_EQ(editor->wait_for_end(), 0);
    }
}

} // namespace
} // namespace sunfleck
