// What is open in the editor, and what panels share. Panels change the document through gestures and the rest here; the
// program's loop (editor.h) sees to it that the scene thread follows.
//
// On the GUI thread only.
#pragma once

#include "editor/document/followed_file.h"
#include "editor/document/source_link.h"
#include "editor/window/camera.h"
#include "editor/window/recovery.h"
#include "editor/window/scene_thread.h"
#include "engine/app/window.h"

#include <algorithm>
#include <deque>
#include <imgui.h>
#include <map>

namespace sunfleck::editor {

class Commands;
class Comparison;
class CostThread;
class Opening;
class Saving;

struct Message {
    enum class Kind { note, warning, error } kind = Kind::note;
    std::string text;
    std::uint64_t number = 0; // from 1
};

// What the user is told: the newest in the status bar, all in a panel.
class Messages {
public:
    void say(std::string text, Message::Kind kind = Message::Kind::note);
    // An error, if there is one; true if there was none.
    bool check(const Status& status);
    const std::deque<Message>& all() const { return all_; }
    std::uint64_t count() const { return count_; }

private:
    std::deque<Message> all_; // the newest hundreds
    std::uint64_t count_ = 0;
};

// What the viewport shows besides the scene's own look.
struct ViewOptions {
    std::string lighting_view; // of gi::debug_views(); empty: none
    std::uint32_t picture = shared::view_final;
    std::vector<std::string> overlays;          // of viewer::overlays()
    std::optional<std::uint32_t> chosen_sample; // light sample that is singled out
    bool show_grid = false, show_icons = true;
    float scale = 1.0f; // rendered pixels for each of the screen's, along a side
    viewer::PictureSettings look;
    std::optional<float> ev100;  // in place of the scene's, or of the picture's own
    std::uint32_t exposures = 0; // raised: the picture is exposed again
    bool playing = false, paused = false;

    bool has_overlay(const std::string& name) const {
        return std::find(overlays.begin(), overlays.end(), name) != overlays.end();
    }
    void toggle_overlay(const std::string& name) {
        if (std::erase(overlays, name) == 0)
            overlays.push_back(name);
    }
    // The same for the scene thread, without camera and size.
    ViewRequest request() const;
};

// What movements of handles are multiples of.
struct SnapSteps {
    float length = 0.1f, angle = 15.0f, factor = 0.1f; // m, degrees, 1
    struct Range {
        float least, most;
        bool has(float step) const { return step >= least && step <= most; }
    };
    static constexpr Range lengths{1e-4f, 1e4f}, angles{0.01f, 180.0f}, factors{0.001f, 10.0f};
    bool operator==(const SnapSteps&) const = default;
};

enum class GizmoMode { none, move, rotate, scale, inspect };
struct GizmoOptions {
    GizmoMode mode = GizmoMode::move;
    bool local = false; // along the axes of what is selected last
    bool snap = false;  // always; holding Ctrl is the other way about
    SnapSteps steps;
};

// A component that was copied.
struct CopiedComponent {
    std::string type;
    ecs::Value value;
};

// What a frame of the scene took.
struct ProfiledFrame {
    static constexpr std::size_t most = 300; // that are kept
    std::uint64_t number = 0;
    viewer::FrameStatistics statistics;
};

// What frames should stay below; shown where it is not so.
struct Budgets {
    static constexpr float least_ms = 1.0f, most_ms = 1000.0f;
    float frame_ms = 33.3f;
    std::map<std::string, double> counters; // by name
};

// While only some lamps shine: which they are, what is hidden for it, and what was hidden before.
struct Solo {
    std::unordered_set<Entity> lamps, hidden, before;
};

// Questions that stand in the way of everything else until they are answered.
enum class Dialog { none, open, save_as, unsaved, recover };

// What has been loaded, before it takes the document's place.
struct Loaded {
    std::filesystem::path path;
    std::shared_ptr<Document> document;
    std::optional<Recovered> recovered; // whose edits it has; none: it is the file
};

// Of a file, for lists that last; the name as it is where the current folder is gone.
std::string full_name(const std::filesystem::path& path);

class Session {
public:
    explicit Session(SceneThread& the_scene);
    ~Session();

    SceneThread& scene;
    std::shared_ptr<Document> document;
    Camera camera;
    ViewOptions view;
    GizmoOptions gizmo;
    Messages messages;
    CopiedComponent copied;
    std::unique_ptr<Commands> commands;
    std::unique_ptr<Comparison> comparison; // from the program
    std::filesystem::path preset_folder;    // empty: presets are not kept
    bool allow_outside = false;             // io::ImportOptions::allow_outside, of all that is opened
    std::unique_ptr<CostThread> cost;       // null before something was measured
    std::unique_ptr<ShaderWatch> shaders;   // null: none are watched
    std::unique_ptr<Opening> opening;       // a file that loads; null: none does
    static constexpr std::size_t most_recent = 12;
    std::vector<std::string> recent_files; // newest first
    std::deque<ProfiledFrame> frames;      // newest last
    bool profiling = true;                 // further frames are kept
    Budgets budgets;
    // Of no concern to the document (switches.h): not shown, and not lit by; lamps that give no light; what clicks,
    // handles and Delete leave alone.
    std::unordered_set<Entity> hidden, muted, locked;
    std::uint64_t hiding = 0;        // HiddenFilter::count of what the scene was told
    std::uint64_t lock_revision = 0; // raised with every change of `locked`
    std::optional<Solo> solo;        // no longer on where something else was hidden or shown meanwhile

    Dialog dialog = Dialog::none;
    std::function<void()> after_unsaved; // what the user wanted when there were unsaved edits
    std::vector<Recovered> recovered;    // edits of runs that are gone; the last is offered first
    std::optional<Recovered> recovering; // that loads
    bool quit = false, rebuild = false;  // what the loop is to do next

    const app::InputState* input = nullptr; // of this frame
    ViewRequest shown;                      // what the scene thread was told last
    ImVec4 viewport_area{0, 0, 0, 0};       // x, y, width, height: pixels of the window

    bool usual_layout = false;       // is asked for: panels as large as at first
    bool keys_are_asked_for = false; // the next ones are no commands; a panel that waits for keys says so each frame
    std::string listing;             // that a panel wants to show in this frame; empty: none does
    std::string front;               // a panel that is to be brought to the front
    Entity to_rename;                // its name is to be asked for; null: none is

    // Looks into the pixel at a place of the viewport: what is there, and what lights it.
    void inspect(vec2 place);
    std::optional<InspectRequest> inspecting;

    // Replaces the document, as it is when it has been opened.
    void take(std::shared_ptr<Document> opened);
    // Before a frame is drawn: no gesture goes on while another window has the focus.
    void follow_focus(const app::InputState& now);
    // Begins to load; asks first if there is something to lose.
    void open(const std::filesystem::path& path);
    void open_now(const std::filesystem::path& path);
    // The first of them.
    void open_dropped(const std::vector<std::filesystem::path>& files);
    // Once all is loaded it goes to `replace`; who has made edits meanwhile is asked first.
    void finish_opening(const std::function<void(const Loaded&)>& replace);
    // How much, and whether something was left out.
    void say_what_was_opened(const std::filesystem::path& path);
    // Begins to measure what the setting's value costs over an old one.
    void measure_cost(const std::string& setting, const std::string& old_value);
    std::function<std::unique_ptr<CostThread>()> make_cost_thread; // from the program
    std::function<void()> wake; // from the program; from any thread: there is something new to draw
    std::function<void(bool on)> capture_pointer = [](bool) {}; // from the program
    // Reads the file that others have written again, the document's or the glTF file that it came from, and takes over
    // what has changed in it; edits stay. Where neither was written the latter is read.
    void reload_file();
    bool can_reload() const { return !(own_.path().empty() && imported_.path().empty()) && reloading_ == nullptr; }
    // The unsaved edits of a run that is gone.
    void recover(const Recovered& recovered);
    // False: it was not saved, which has been said.
    bool save(const std::filesystem::path& path, Replace replace = Replace::own);
    // The document's own file, while edits go on; that it is done, or why not, is said. Once more meanwhile: again
    // then.
    void save_behind();
    // Whether something would be lost, once what is being saved is.
    bool still_unsaved();
    std::unique_ptr<Saving> saving; // null: nothing is being saved
    // Of files that other programs write: the document's, and shaders that are watched.
    void take_news();
    // Runs `action` now, or when the user has dealt with unsaved edits.
    void unless_unsaved(std::function<void()> action);
    // Side of a cube that the scene would fit in, m; for things whose size nothing else says.
    float scene_size();
    // Side of the grid's squares, m: 5 times a power of ten, a half to a twentieth of the scene's size.
    float grid_step();
    // "room.scene.json", or "untitled".
    std::string file_name() const;
    // Keeps what the newest picture took, and where it shows things.
    void note_frame(const ScenePicture* picture);
    std::shared_ptr<const PlayedPlaces> played; // of that picture; null: everything stands as edited
    // What is selected, without what is below something that is.
    Entities selected_tops() { return topmost(*document, document->selection()); }

private:
    // A state of the document.
    using Edits = std::pair<const Document*, std::uint64_t>;
    Edits edits() const { return {document.get(), document->history().serial()}; }
    void begin_opening(std::unique_ptr<Opening> loads);
    void note_recent(const std::filesystem::path& path);
    void watch_file();
    void find_import();
    void remember_source(const std::filesystem::path& folder);
    void finish_reload();
    void finish_saving();
    void end_saving(); // waits until nothing is being saved
    void take_saved();
    void note_saved(const std::filesystem::path& path, FileContent content);

    Edits given_up_; // what was there when loading began: all that it has may be lost

    // The document's own file, and the glTF file that was opened, in this session or an earlier one, once the scene is
    // saved in another.
    FollowedFile own_, imported_;
    FollowedFile* reloaded_ = &own_; // that loads again
    std::optional<FileStamp> stamp_; // of it, when that began
    ContentHashes hashes_;           // of the document
    std::unique_ptr<Opening> reloading_;
    FileContent saved_content_; // what `saving` writes
    bool saves_again_ = false;
    bool file_was_changed_ = false, import_was_changed_ = false;
    std::string bad_shader_;
    std::uint64_t size_revision_ = 0;
    float size_ = 1.0f;
};

} // namespace sunfleck::editor
