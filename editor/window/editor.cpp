#include "editor/window/editor.h"

#include "editor/window/cost_thread.h"
#include "editor/window/display.h"
#include "editor/window/opening.h"
#include "editor/window/script_files.h"
#include "editor/window/state_file.h"
#include "engine/core/caught.h"
#include "engine/core/log.h"
#include "engine/core/output.h"
#include "engine/core/stop_signals.h"
#include "viewer/built_in_scenes.h"
#include "viewer/lost_devices.h"

#include <algorithm>
#include <thread>

namespace sunfleck::editor {
namespace {

using Clock = std::chrono::steady_clock;
constexpr float usual_scale = 0.875f; // of letters of 16 pixels
constexpr int frames_after_event = 3; // until Dear ImGui has settled
constexpr double longest_sleep = 0.1; // s: how soon a signal that asks for the end is seen
constexpr std::chrono::nanoseconds flying_interval{1000000000 / 60};

class Program {
public:
    explicit Program(const Options& options) : options_(options) {}

    Status run() {
        SUNFLECK_TRY(start());
        const Status drawn = viewer::survive_lost_devices([&, first = true]() mutable -> Status {
            if (!std::exchange(first, false))
                SUNFLECK_TRY(caught([&] { return take_new_device(); }));
            return caught([&] { return loop(); });
        });
        const bool edits_wait = !session_->quit && session_->still_unsaved(); // a signal, or an error
        if (edits_wait)
            recovery_->leave();
        Status finished = finish(bool(drawn), edits_wait);
        if (drawn)
            return finished;
        return edits_wait ? Error{drawn.error().message + "; the unsaved edits are offered by the next run",
                                  drawn.error().code}
                          : drawn;
    }

private:
    Status start();
    Status start_scene();
    void start_recovery();
    void wake();
    Status loop();
    Status take_new_device();
    bool something_new();
    void replace_document(const Loaded& loaded);
    void keep_edits();
    void tell_scene();
    Status draw(const app::InputState& input);
    void ask_before_closing();
    void after_frame();
    void tell_scripts();
    Status finish(bool whole, bool edits_wait);
    void keep_camera();
    void note_state();
    void keep_state(); // the end of the program need not be a regular one
    float scale() { return options_.scale > 0.0f ? options_.scale : usual_scale * window().scale(); }

    const Options& options_;
    app::Window& window() { return display_->window(); }
    std::unique_ptr<Display> display_;
    std::atomic<bool> woken_{true};
    std::unique_ptr<SceneThread> scene_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<Layout> layout_;
    EditorState state_;
    std::filesystem::path state_path_; // empty: nothing is kept
    bool may_save_state_ = true;
    StateKeeper state_keeper_;
    ChangeCollector collector_;
    HiddenFilter hidden_;
    std::unique_ptr<Recovery> recovery_;
    std::uint64_t kept_revision_ = 0; // of the document
    bool kept_unsaved_ = false;
    std::optional<Recovered> recovered_from_; // until its edits are kept once more, or were saved
    std::uint64_t writes_before_ = 0, events_ = 0;
    std::string title_;
    app::InputState still_input_;
    int frames_due_ = frames_after_event, frames_since_event_ = 0;
    bool widgets_due_ = false; // --widgets is older than the last frame
    Clock::time_point last_frame_ = Clock::now();
    ReportFigures figures_;
};

Status Program::start() {
    watch_stop_signals();
    const NamedFile outputs[] = {
        {"--settings", options_.state_file}, {"--widgets", options_.widgets}, {"--report", options_.report}};
    SUNFLECK_TRY(try_outputs(outputs));
    std::string problem;
    state_path_ = options_.state_file.empty() ? usual_state_file() : std::filesystem::path(options_.state_file);
    state_keeper_ = StateKeeper(state_ = load_state(state_path_, problem, may_save_state_));
    SUNFLECK_ASSIGN(display_, Display::create(options_));
    SUNFLECK_TRY(start_scene());
    if (!problem.empty())
        session_->messages.say(problem, Message::Kind::warning);
    return {};
}

void Program::wake() {
    woken_ = true;
    app::Window::wake();
}

// What earlier runs left, and what this one keeps.
void Program::start_recovery() {
    const std::filesystem::path folder = state_path_.empty() ? state_path_ : state_path_.parent_path() / "recovery";
    session_->recovered = Recovery::left_behind(folder);
    if (!session_->recovered.empty())
        session_->dialog = Dialog::recover;
    recovery_ = std::make_unique<Recovery>(folder);
    if (!recovery_->problem().empty() && !folder.empty()) // else it has been said
        session_->messages.say(recovery_->problem(), Message::Kind::warning);
}

Status Program::start_scene() {
    const auto wakes = [this] { wake(); };
    scene_ = std::make_unique<SceneThread>(display_->device(), wakes);
    session_ = std::make_unique<Session>(*scene_);
    session_->wake = wakes;
    session_->capture_pointer = [this](bool on) { window().capture_pointer(on); };
    session_->recent_files = state_.recent_files;
    session_->budgets = state_.budgets;
    session_->gizmo.steps = state_.steps;
    if (!options_.shaders.empty())
        session_->shaders =
            std::make_unique<ShaderWatch>(options_.shaders, viewer::SceneRenderer::shader_paths(), wakes);
    session_->comparison = std::make_unique<Comparison>(display_->device(), *scene_, wakes);
    session_->preset_folder = state_path_.empty() ? state_path_ : state_path_.parent_path() / "presets";
    session_->allow_outside = options_.allow_outside;
    session_->make_cost_thread = [this, wakes] {
        return std::make_unique<CostThread>(
            display_->device(), [this] { return scene_->busy(); }, wakes);
    };
    session_->commands->change_keys(state_.keys);
    start_recovery();
    layout_ = std::make_unique<Layout>();
    layout_->restore(state_.layout);
    session_->take(session_->document);
    if (!options_.scene.empty())
        if (const auto path = viewer::find_scene(options_.scene);
            session_->messages.check(path ? Status() : Status(path.error())))
            session_->open_now(*path);
    return {};
}

// Whether the GUI has to be drawn.
bool Program::something_new() {
    const bool woken = woken_.exchange(false);
    if (woken || layout_->flying())
        frames_due_ = std::max(frames_due_, 1);
    // The last of many events gets its frames, too, although it arrived with the first.
    if (window().event_count() != std::exchange(events_, window().event_count()) || window().has_more()) {
        frames_due_ = frames_after_event;
        frames_since_event_ = 0;
        session_->comparison->note_hand();
    }
    if (layout_->flying())
        session_->comparison->note_hand();
    return frames_due_ > 0;
}

Status Program::loop() {
    while (!session_->quit && !stop_requested()) {
        const bool quiet = ui::take_quiet_frame();
        if (!quiet && !something_new()) {
            tell_scripts();
            keep_state();
            window().wait(longest_sleep);
            ++figures_.wake_ups;
        }
        const app::InputState& input = quiet ? (still_input_ = window().input().still()) : window().poll();
        session_->finish_opening([this](const Loaded& loaded) { replace_document(loaded); });
        session_->open_dropped(input.dropped);
        ask_before_closing();
        if (!something_new() && !quiet)
            continue;
        if (layout_->flying())
            std::this_thread::sleep_until(last_frame_ + flying_interval);
        frames_due_ = std::max(frames_due_ - 1, 0);
        SUNFLECK_TRY(draw(input));
    }
    return {};
}

void Program::replace_document(const Loaded& loaded) {
    keep_camera();
    session_->take(loaded.document);
    if (loaded.recovered) {
        const Recovered& from = *loaded.recovered;
        if (from.user_file == UserFile::changed && from.made != nullptr && from.made->names.size() < from.count)
            return session_->messages.say("Recovered " + std::to_string(from.made->names.size()) + " of " +
                                              std::to_string(from.count) +
                                              " unsaved edits: the next one has no place in the file as it is now. All "
                                              "are offered again at the next start",
                                          Message::Kind::warning);
        recovered_from_ = loaded.recovered;
        writes_before_ = recovery_->writes();
        return session_->messages.say("Recovered " + std::to_string(from.count) +
                                      " unsaved edits; save them under a name of your choice");
    }
    if (const auto known = state_.cameras.find(full_name(loaded.path)); known != state_.cameras.end())
        session_->camera.set(known->second);
    session_->say_what_was_opened(loaded.path);
}

void Program::keep_camera() {
    if (const std::filesystem::path& path = session_->document->path(); !path.empty())
        state_.cameras[full_name(path)] = session_->camera.view();
}

void Program::ask_before_closing() {
    if (!window().should_close())
        return;
    window().keep_open();
    frames_due_ = frames_after_event;
    session_->unless_unsaved([this] { session_->quit = true; });
}

// What a crash must not take.
void Program::keep_edits() {
    if (recovered_from_ && recovery_->writes() > writes_before_)
        Recovery::discard(*std::exchange(recovered_from_, {}));
    const Document& document = *session_->document;
    const bool unsaved = document.unsaved() && !document.in_gesture();
    if (document.in_gesture() || (document.revision() == kept_revision_ && unsaved == kept_unsaved_))
        return;
    kept_revision_ = document.revision();
    kept_unsaved_ = unsaved;
    const Recovery::Place place(full_name(document.path()), document.folder());
    if (!unsaved)
        return recovery_->saved(place);
    constexpr std::size_t most_names = 20;
    recovery_->unsaved(place, document.history().newest_names(most_names),
                       std::max<std::size_t>(document.history().position(), 1));
}

// Edits and views go to the scene thread.
void Program::tell_scene() {
    // An empty scene that is about to be replaced needs no picture.
    if (session_->opening != nullptr && session_->document->entity_count() == 0 && !session_->document->unsaved())
        return;
    std::optional<SceneChange> change = collector_.collect(session_->document);
    if (change)
        recovery_->change(*change);
    keep_edits();
    const bool outgrown = scene_->wants_everything();
    if (std::exchange(session_->rebuild, false) || outgrown) // all that has been collected so far
        change = ChangeCollector::everything(session_->document);
    hidden_.apply(session_->document, session_->hidden, session_->muted, change);
    session_->hiding = hidden_.count();
    ViewRequest wanted = session_->view.request();
    wanted.camera = session_->camera.view();
    wanted.width = std::uint32_t(session_->viewport_area.z * session_->view.scale);
    wanted.height = std::uint32_t(session_->viewport_area.w * session_->view.scale);
    wanted.exposures = session_->view.exposures;
    wanted.listing = std::exchange(session_->listing, {});
    wanted.read_back = session_->comparison->on();
    if (session_->comparison->with == CompareWith::reference)
        wanted.look.glare = 0.0f; // which the reference has not
    session_->comparison->follow(
        change,
        [this] {
            SceneChange everything = ChangeCollector::everything(session_->document);
            HiddenFilter::hide(session_->hidden, session_->muted, everything);
            everything.hiding = hidden_.count();
            return everything;
        },
        wanted);
    if (change)
        scene_->change(std::move(*change));
    if (same_view(wanted, session_->shown) && wanted.exposures == session_->shown.exposures)
        return;
    session_->shown = wanted;
    scene_->show(wanted);
}

Status Program::draw(const app::InputState& input) {
    session_->follow_focus(input);
    const Result<bool> visible = display_->acquire();
    if ((!visible || !*visible) && &input == &window().input())
        window().repeat(); // a letter that was typed meanwhile is not lost
    if (!visible)
        return visible.error();
    if (!*visible) { // minimised, or resized just now
        frames_due_ = std::max(frames_due_, 1);
        window().wait(0.05);
        return {};
    }
    const auto began = Clock::now();
    const double seconds = std::chrono::duration<double>(began - std::exchange(last_frame_, began)).count();
    session_->input = &input;
    const std::shared_ptr<ScenePicture> picture = scene_->picture();
    session_->note_frame(picture.get());
    session_->take_news();
    ui::begin_notes(!options_.widgets.empty());
    ui::begin_number_boxes();
    const VkExtent2D extent = display_->extent();
    display_->gui().begin_frame(input, extent.width, extent.height, seconds, scale());
    layout_->take_keys(*session_);
    layout_->draw(*session_, picture.get());
    display_->gui().end_frame();
    tell_scene();
    const ImVec4 area = session_->viewport_area;
    const VkRect2D place{{int(area.x), int(area.y)}, {std::uint32_t(area.z), std::uint32_t(area.w)}};
    SUNFLECK_TRY(display_->present(*session_->comparison, picture, place));
    figures_.note_frame(1e3 * std::chrono::duration<double>(Clock::now() - began).count());
    after_frame();
    return {};
}

// Everything lies on the device that is lost but the session, which goes on as it is.
Status Program::take_new_device() {
    session_->cost.reset();
    session_->comparison->forget_device();
    scene_->forget_device();
    SUNFLECK_TRY(display_->replace_device(options_));
    session_->comparison->use_device(display_->device());
    scene_->use_device(display_->device());
    session_->rebuild = true;
    session_->messages.say("The GPU stopped answering; a new device goes on with the picture", Message::Kind::warning);
    frames_due_ = frames_after_event;
    return {};
}

void Program::after_frame() {
    const std::string title = session_->file_name() + (session_->document->unsaved() ? " * - Sunfleck" : " - Sunfleck");
    if (title != title_)
        window().set_title(title_ = title);
    widgets_due_ = !options_.widgets.empty();
    state_keeper_.note_frame();
    keep_state();
    if (++frames_since_event_ > frames_after_event)
        tell_scripts();
}

// Where widgets are, once no event asks for frames (while a scene plays, others may): a key let go may follow the last.
void Program::tell_scripts() {
    if (std::exchange(widgets_due_, false))
        session_->messages.check(write_widgets(options_.widgets, ui::notes(), session_->input->mouse));
}

void Program::note_state() {
    keep_camera();
    state_.layout = layout_->state();
    window().size(state_.width, state_.height);
    state_.recent_files = session_->recent_files;
    state_.budgets = session_->budgets;
    state_.steps = session_->gizmo.steps;
    state_.keys = session_->commands->changed_keys();
}

void Program::keep_state() {
    if (!may_save_state_ || !state_keeper_.is_due())
        return;
    note_state();
    if (!session_->messages.check(state_keeper_.keep(state_path_, state_)))
        frames_due_ = std::max(frames_due_, 1);
}

Status Program::finish(bool whole, bool edits_wait) {
    note_state();
    const Status kept = may_save_state_ ? state_keeper_.finish(state_path_, state_) : Status();
    const Status reported = options_.report.empty()
                                ? Status()
                                : write_report(options_.report, figures_, *session_, display_->validation_messages());
    if (!edits_wait && recovered_from_)
        Recovery::discard(*recovered_from_);
    recovery_.reset();
    end_soon(); // all is saved; what follows may wait for threads
    session_->opening.reset();
    session_->cost.reset();
    session_->comparison.reset();
    scene_.reset(); // cancels, and lets go of its pictures once the GUI has
    SUNFLECK_TRY(display_->finish(whole));
    SUNFLECK_TRY(kept);
    SUNFLECK_TRY(reported);
    if (display_->validation_messages() > 0)
        return Error{"validation printed messages (see above)"};
    return {};
}

} // namespace

Status run(const Options& options) {
    return Program(options).run();
}

} // namespace sunfleck::editor
