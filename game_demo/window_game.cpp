// The demo in a window: real time, the simulation on its fixed step.
#include "engine/core/caught.h"
#include "engine/core/log.h"
#include "engine/core/stop_signals.h"
#include "engine/core/user_folders.h"
#include "game_demo/controls.h"
#include "game_demo/frame_pace.h"
#include "game_demo/game_display.h"
#include "game_demo/game_session.h"
#include "game_demo/game_sounds.h"
#include "game_demo/hitch_log.h"
#include "game_demo/kept_settings.h"
#include "game_demo/loading_screen.h"
#include "game_demo/menu.h"
#include "game_demo/options.h"
#include "game_demo/overlay_data.h"
#include "game_demo/presets.h"
#include "game_demo/screenshot.h"
#include "game_demo/state_file.h"
#include "viewer/lost_devices.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace sunfleck::demo {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int pad_start = 7;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class Game {
public:
    explicit Game(const Options& options)
        : options_(options), state_(options.state), hitches_(options.hitches), recording_(options.record) {}

    // However it ends, settings and recording are written.
    Status run() {
        SUNFLECK_TRY(check_window_files(options_));
        SUNFLECK_TRY(start());
        const Status played = viewer::survive_lost_devices([&, first = true]() mutable -> Status {
            if (!std::exchange(first, false))
                SUNFLECK_TRY(take_new_device());
            return caught([&] { return play(); });
        });
        const Status finished = finish(played);
        return played ? finished : played;
    }

private:
    Status play() {
        const auto ends = [&](std::uint32_t frame) {
            return window_->should_close() || stop_requested() || (options_.frames > 0 && frame >= options_.frames);
        };
        for (std::uint32_t frame = 0; !ends(frame);) {
            const auto began = Clock::now();
            if (loading_) {
                SUNFLECK_TRY(loading_frame());
                std::this_thread::sleep_until(began + std::chrono::milliseconds(33));
                continue;
            }
            SUNFLECK_ASSIGN(const bool shown, frame_once());
            if (!shown)
                continue;
            ++frame;
            pace_.worked(1e3 * seconds_since(began));
            const double shortest = std::max(1.0 / frame_rate(), pace_.shortest_frame());
            std::this_thread::sleep_for(std::chrono::duration<double>(shortest - seconds_since(began)));
        }
        return {};
    }

    // Behind the title, frames leave most of the time to the light that is being prepared.
    double frame_rate() const {
        constexpr double preparing = 6.0; // Hz
        const bool prepares = !started_ && level_->light_share();
        return prepares ? std::min(preparing, double(settings_.frame_cap)) : double(settings_.frame_cap);
    }

    bool playing() const { return started_ && menu_.screen() == Screen::playing; }

    Status start() {
        LoadedSettings loaded = kept_.load(options_.settings_file);
        settings_ = loaded.settings;
        SUNFLECK_ASSIGN(display_, GameDisplay::create("Lantern House", options_));
        window_ = &display_->window();
        if (options_.preset || !loaded.found)
            settings_.preset = options_.preset.value_or(default_preset(display_->device().traits().software));
        apply_preset(settings_);
        if (options_.transfer && *options_.transfer != settings_.transfer) {
            settings_.transfer = *options_.transfer;
            settings_.preset = Preset::custom;
        }
        kept_.begin(settings_, loaded.found);
        start_loading();
        window_->set_full_screen(settings_.full_screen);
        if (!loaded.problem.empty()) {
            log_warning(loaded.problem);
            menu_.say(loaded.problem, 8.0);
        }
        last_ = Clock::now();
        return {};
    }

    // The level, which lies on the device that is lost, moves to another one behind the loading screen.
    Status take_new_device() {
        if (loading_)
            level_ = loading_->give_back();
        loading_.reset();
        SUNFLECK_TRY(display_->replace_device(options_));
        start_loading();
        return {};
    }

    void start_loading() {
        window_->set_title("Lantern House - loading");
        loading_ =
            level_ ? std::make_unique<LoadingScreen>(display_->device(), std::move(level_), settings_)
                   : std::make_unique<LoadingScreen>(display_->device(), source_of(options_), first_light(settings_));
    }

    // The device is idle when the level takes over, because submission serials restart.
    Status loading_frame() {
        app::Swapchain& swapchain = display_->swapchain();
        SUNFLECK_ASSIGN(level_, loading_->frame(*window_, swapchain, display_->screen(),
                                                GameDisplay::ui_scale(settings_, swapchain.extent())));
        if (!level_)
            return {};
        loading_.reset();
        watch_stop_signals(); // from now on there is something to save
        SUNFLECK_ASSIGN(const bool another_device, display_->begin_renderer());
        if (another_device)
            menu_.say("The GPU stopped answering; a new device goes on with the picture", 8.0);
        window_->set_title("Lantern House");
        level_->apply_later(settings_); // all of the light comes in view
        hitches_.log("first picture", seconds_since(began_));
        last_ = Clock::now();
        return {};
    }

    // False: the window cannot be presented to at the moment.
    Result<bool> frame_once() {
        SUNFLECK_TRY(GameDisplay::wait_for_slot(level_->renderer()));
        const app::InputState& input = window_->poll();
        const double seconds = std::min(seconds_since(last_), 1.0);
        last_ = Clock::now();
        display_->swapchain().set_vertical_sync(settings_.vertical_sync);
        handle_keys(input);
        const bool playing = menu_.screen() == Screen::playing && input.focused;
        window_->capture_pointer(playing);
        controls_.take(input, settings_, seconds, playing);
        simulate(seconds);
        sounds_.update(level_->game(), settings_, seconds, started_ && playing);
        follow_light();
        SUNFLECK_ASSIGN(const bool visible, display_->swapchain().acquire(level_->renderer().submission().serial()));
        if (!visible) {
            window_->wait(0.05);
            SUNFLECK_TRY(state_.write([&] { return state(); }));
            return false;
        }
        SUNFLECK_TRY(show(input, seconds));
        return true;
    }

    void follow_light() {
        const bool changes = level_->light_share().has_value();
        if (const Status status = level_->advance_light(); !status)
            menu_.say("The new settings could not be applied: " + status.error().message, 6.0);
        else if (changes && !level_->light_share())
            hitches_.log("all of the light", seconds_since(began_));
    }

    // In the order in which keys went down: a slow frame may hold several.
    void handle_keys(const app::InputState& input) {
        for (const app::Key key : input.went_down)
            handle_key(key);
        const bool start_button = input.gamepad.pressed(pad_start);
        const bool away = !input.focused || controls_.lost_gamepad();
        if ((start_button && !start_before_) || (away && menu_.screen() == Screen::playing))
            menu_.back();
        if (controls_.lost_gamepad())
            menu_.say("The gamepad is gone: plug it in, or go on with the keyboard", 6.0);
        start_before_ = start_button;
        if (menu_.screen() == Screen::playing && controls_.pad_pressed_indirect_light())
            toggle_indirect_light();
    }

    void handle_key(app::Key key) {
        if (key == app::key_escape)
            menu_.back();
        else if (menu_.screen() == Screen::playing)
            if (const auto action = settings_.action_of(key))
                act(*action);
    }

    // Actions that are held, or part of a step, are left to `controls_`.
    void act(Action action) {
        if (action == Action::indirect_light)
            toggle_indirect_light();
        else if (action == Action::frame_times)
            settings_.show_times = !settings_.show_times;
        else if (action == Action::screenshot)
            wants_screenshot_ = true;
        else if (action == Action::help)
            menu_.show(Screen::help);
        else if (action == Action::full_screen)
            window_->set_full_screen(settings_.full_screen = !settings_.full_screen);
    }

    void toggle_indirect_light() {
        indirect_ = !indirect_;
        menu_.say(indirect_ ? "Indirect light on" : "Indirect light off: direct light only", 2.5);
    }

    // The simulation runs behind the title and stops while paused.
    void simulate(double seconds) {
        const Screen screen = menu_.screen();
        title_seconds_ += seconds;
        if (screen == Screen::paused || (started_ && screen != Screen::playing))
            return;
        for (std::uint32_t due = clock_.advance(seconds); due > 0; --due) {
            simulation::StepInput step = controls_.next_step();
            if (std::exchange(wants_reset_, false))
                step.buttons |= simulation::button_reset;
            level_->step(step);
            if (started_)
                recording_.add(step);
        }
        recording_.save_if_due();
        if (!started_)
            return;
        session_.update(seconds);
        menu_.say(session_.take_message(), 8.0);
        if (session_.finished())
            menu_.show(Screen::finished);
    }

    Status show(const app::InputState& input, double seconds) {
        const VkExtent2D extent = display_->swapchain().extent();
        viewer::SceneRenderer& renderer = level_->renderer();
        controls_.turn(window_->poll_motion(), settings_); // none where the pointer is not captured
        const simulation::DrawnMoment moment{clock_.fraction(), controls_.pending_look()};
        const FrameQuality quality = pace_.choose(settings_, *level_, seconds_since(began_), moment.turns(), playing());
        menu_.say(pace_.take_message(), 6.0);
        DemoSettings shown = settings_;
        shown.render_scale = quality.render_scale;
        level_->adapt(settings_, seconds);
        viewer::FrameRequest request = level_->request(shown, extent.width, extent.height, moment);
        request.strength_budget = quality.strength_budget;
        if (!started_)
            request.camera = level_->title_camera(title_seconds_);
        request.indirect_scale = float(indirect_); // fades, since only some samples follow in each frame
        request.keep_samples = true;               // new ones are prepared beside the frames
        request.milliseconds = 1e3 * seconds_since(began_);
        SUNFLECK_TRY(renderer.collect_statistics());
        hitches_.log(seconds, renderer.statistics());
        app::Gui& gui = display_->screen().gui();
        gui.begin_frame(input, extent.width, extent.height, seconds, GameDisplay::ui_scale(settings_, extent));
        if (menu_.screen() == Screen::playing) {
            session_.draw();
            sounds_.draw();
        }
        bool changed = false;
        const Decision decision = menu_.draw(settings_, shown_data(request, seconds), input, changed);
        gui.end_frame();
        SUNFLECK_TRY(level_->update(request, moment));
        SUNFLECK_ASSIGN(const VkCommandBuffer commands, display_->begin_frame(renderer));
        SUNFLECK_TRY(renderer.record(commands, request, display_->overlay()));
        SUNFLECK_TRY(display_->present(commands, renderer));
        if (std::exchange(wants_screenshot_, false))
            menu_.say(save_screenshot(renderer, options_.screenshots));
        if (changed) {
            level_->apply_later(settings_);
            window_->set_full_screen(settings_.full_screen);
            if (const Status status = kept_.store(settings_); !status)
                menu_.say(status.error().message, 6.0);
        }
        decide(decision);
        return state_.write([&] { return state(); });
    }

    GameState state() const {
        return {screen_name(menu_.screen()), menu_.selected(),     session_.progress(), sounds_.device(),
                sounds_.subtitles(),         menu_.message_text(), session_.kept(),     indirect_,
                pace_.reaches_target()};
    }

    OverlayData shown_data(const viewer::FrameRequest& request, double seconds) {
        smooth_ms_ = smooth_ms_ <= 0.0 ? seconds * 1e3 : smooth_ms_ + 0.1 * (seconds * 1e3 - smooth_ms_);
        OverlayData result = overlay_data(*level_, request);
        result.indirect_light = indirect_;
        result.frame_ms = smooth_ms_;
        result.can_resume = result.is_game && session_.can_resume();
        result.with_gamepad = controls_.plays_with_gamepad();
        result.game_seconds = session_.seconds();
        result.device = display_->device().traits().name;
        return result;
    }

    void decide(Decision decision) {
        switch (decision) {
        case Decision::none:
            break;
        case Decision::play:
        case Decision::resume:
        case Decision::restart:
            if (decision != Decision::play || !started_)
                restart(decision == Decision::resume);
            started_ = true;
            menu_.show(Screen::playing);
            break;
        case Decision::hint:
            session_.show_hint();
            menu_.show(Screen::playing);
            break;
        case Decision::reset_room:
            wants_reset_ = true;
            sounds_.forget(); // what is put back makes no noise
            menu_.show(Screen::playing);
            break;
        case Decision::title:
            started_ = false;
            renew();
            menu_.show(Screen::title);
            break;
        case Decision::quit:
            window_->close();
            break;
        }
    }

    // The world as it was loaded, and seen as at first.
    void renew() {
        level_->restart();
        sounds_.forget();
        clock_.reset();
        indirect_ = true;
    }

    // `resume`: at the last checkpoint.
    void restart(bool resume) {
        renew();
        if (!session_.begin(level_->game(), resume))
            return restart(false);
        level_->jumped();
        recording_.clear(resume ? on_one_line(session_.saved()) : std::string());
    }

    Status finish(const Status& played) {
        hitches_.log_summary();
        const Status stored = kept_.store(settings_), recorded = recording_.finish();
        const Status kept = started_ ? session_.keep() : Status();
        end_soon();
        loading_.reset(); // may take a moment
        if (played)
            SUNFLECK_TRY(display_->device().wait_idle());
        if (kept_.differ_from_start(settings_)) // else nothing is lost
            SUNFLECK_TRY(stored);
        SUNFLECK_TRY(recorded);
        SUNFLECK_TRY(kept);
        SUNFLECK_TRY(state_.finish());
        if (played && display_->device().validation_messages() > 0)
            return Error{"validation printed messages (see above)"};
        return {};
    }

    const Options& options_;
    DemoSettings settings_;
    KeptSettings kept_;
    std::unique_ptr<GameDisplay> display_;
    app::Window* window_ = nullptr; // the display's
    std::unique_ptr<Level> level_;
    std::unique_ptr<LoadingScreen> loading_;
    Menu menu_;
    GameSounds sounds_;
    StateFile state_;
    GameSession session_{options_.scene, user_data_folder()};
    Controls controls_;
    WindowHitches hitches_;
    Clock::time_point last_;
    simulation::StepClock clock_;
    FramePace pace_;
    double title_seconds_ = 0.0, smooth_ms_ = 0.0;
    bool started_ = false, indirect_ = true, wants_screenshot_ = false, wants_reset_ = false, start_before_ = false;
    const Clock::time_point began_ = Clock::now();
    simulation::RecordingWriter recording_;
};

} // namespace

Status run_window(const Options& options) {
    Game game(options);
    return game.run();
}

} // namespace sunfleck::demo
