// What the editor writes beside its scenes and journal, with each system call failing in turn: as in
// tests/robust/writers_test.cpp.
#include "tests/robust/writers.h"

#include "editor/document/edits.h"
#include "editor/window/presets.h"
#include "editor/window/recovery.h"
#include "editor/window/script_files.h"
#include "editor/window/state_file.h"
#include "engine/core/file.h"
#include "tests/support/driven_display.h"
#include "tests/support/folder.h"
#include "tests/support/test_size.h"

#include <nlohmann/json.hpp>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

class EditorWriters : public testing::Test {
protected:
    void SetUp() override { fs::create_directory(folder / "files"); }
    fs::path at(const std::string& name) const { return folder / ("files/" + name); }
    void expect_old_or_new(const tests::Writer& writer) const {
        const tests::WriterCounts counts = tests::FailingWriter(folder / "files", writer).try_all();
        std::printf("%s: %d tried, %d refused, %d written\n", writer.name.c_str(), counts.tried, counts.refused,
                    counts.written);
    }
    tests::Folder folder{"sunfleck_editor_writers"};
};

TEST_F(EditorWriters, LayoutPresetsAndWidgets) {
    const auto state_of = [](int which) {
        EditorState state;
        state.width = std::uint32_t(800 + which);
        return state;
    };
    const auto read_state = [&] {
        std::string problem;
        bool may_save = false;
        const int which = int(load_state(at("editor.json"), problem, may_save).width) - 800;
        return problem.empty() && (which == 0 || which == 1) ? which : -1;
    };
    expect_old_or_new(
        {"layout", [&](int which) { return save_state(at("editor.json"), state_of(which)); }, read_state});

    const auto save = [&](int which) {
        gi::Settings settings;
        settings.seed = std::uint32_t(7 + which);
        return save_preset(at("presets"), "mine", settings);
    };
    const auto read_preset = [&] {
        const auto settings = load_preset(at("presets"), "mine");
        return settings ? int(settings->seed) - 7 : -1;
    };
    expect_old_or_new({"preset", save, read_preset});

    const auto note = [&](int which) { return write_widgets(at("widgets"), {}, vec2(float(which), 0.0f)); };
    const auto read_widgets = [&] {
        const auto text = read_file(at("widgets"));
        const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
        return json.is_object() ? json["pointer"][0].get<int>() : -1;
    };
    expect_old_or_new({"widgets", note, read_widgets});
}

// A document whose unsaved edits are kept: each adds an entity.
class KeptEdits {
public:
    explicit KeptEdits(const fs::path& folder)
        : folder_(folder), document_(std::make_shared<Document>()), recovery_(folder) {
        edit();
    }
    // Waits until the thread has done with it.
    void edit() {
        add_from(*document_, scene::entity_templates().front(), vec3(float(++edits_)), 0.5f);
        if (const auto change = collector_.collect(document_))
            recovery_.change(*change);
        const std::uint64_t before = recovery_.writes();
        recovery_.unsaved(Recovery::Place(""), {"edit"}, std::uint64_t(edits_));
        EXPECT_TRUE(tests::DrivenDisplay::wait_until([&] { return recovery_.writes() > before; }));
    }
    // How many edits a crash now would leave. Of a copy, as the folder itself is held.
    int left(const fs::path& copy) const {
        fs::remove_all(copy);
        fs::copy(folder_, copy, fs::copy_options::recursive);
        const std::vector<Recovered> found = Recovery::left_behind(copy);
        if (found.size() != 1)
            return 0;
        const auto document = Recovery::load(found[0]);
        return document ? int((*document)->roots().size()) : 0;
    }

private:
    const fs::path folder_;
    std::shared_ptr<Document> document_;
    ChangeCollector collector_;
    int edits_ = 0;
    Recovery recovery_;
};

// Each call once: the edit is kept all the same, by the journal or by the scene. Each call and all that come after it,
// in two edits: those before are. Once the disk works again, all.
TEST_F(EditorWriters, UnsavedEditsSurviveFailures) {
    int tried = 0;
    for (const int later : {0, EIO}) {
        const fs::path place = at(std::to_string(later));
        KeptEdits kept(place);
        ASSERT_EQ(kept.left(folder / "copy"), 1);
        tests::CallFault fault;
        int edits = 1;
        for (int call = 0; call == 0 || fault.name != nullptr; call += tests::by_size(3, 1)) {
            const int before = edits;
            for (int times = later == 0 ? 1 : 2; times > 0; --times, ++edits) {
                fault = {call, EIO, later};
                tests::fail_calls_of_all_threads(&fault);
                kept.edit();
                tests::fail_calls_of_all_threads(nullptr);
            }
            if (fault.name == nullptr)
                break;
            ++tried;
            const int left = kept.left(folder / "copy");
            const std::string what = std::string(fault.name) + ", call " + std::to_string(call);
            EXPECT_LE(left, edits) << what;
            EXPECT_GE(left, later == 0 ? edits : before) << what;
            kept.edit();
            EXPECT_EQ(kept.left(folder / "copy"), ++edits) << what;
        }
    }
    EXPECT_GE(tried, 10);
    std::printf("%d tried\n", tried);
}

} // namespace
} // namespace sunfleck::editor
