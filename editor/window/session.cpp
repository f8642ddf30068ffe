#include "editor/window/session.h"

#include "editor/document/content_hash.h"
#include "editor/window/commands.h"
#include "editor/window/comparison.h"
#include "editor/window/cost_thread.h"
#include "editor/window/opening.h"
#include "editor/window/saving.h"
#include "engine/scene/entity_names.h"
#include "viewer/scene_renderer.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

constexpr std::size_t most_messages = 500;

} // namespace

std::string full_name(const std::filesystem::path& path) {
    if (path.empty())
        return {};
    std::error_code code;
    const std::filesystem::path full = std::filesystem::absolute(path, code);
    return (code ? path : full).string();
}

void Messages::say(std::string text, Message::Kind kind) {
    all_.push_back({kind, std::move(text), ++count_});
    if (all_.size() > most_messages)
        all_.pop_front();
}

bool Messages::check(const Status& status) {
    if (!status)
        say(status.error().message, Message::Kind::error);
    return bool(status);
}

ViewRequest ViewOptions::request() const {
    ViewRequest result;
    result.view = picture;
    result.lighting_view = lighting_view;
    result.overlays = overlays;
    result.chosen_sample = chosen_sample;
    result.look = look;
    result.ev100 = ev100;
    result.playing = playing;
    result.paused = paused;
    return result;
}

Session::Session(SceneThread& the_scene)
    : scene(the_scene), document(std::make_shared<Document>()), commands(std::make_unique<Commands>()) {}

Session::~Session() = default;

void Session::take(std::shared_ptr<Document> opened) {
    end_saving();
    document = std::move(opened);
    size_revision_ = 0; // of another document
    opening.reset();    // what still loads is not wanted any more
    recovering.reset();
    view.playing = view.paused = false;
    view.ev100.reset();
    hidden.clear();
    muted.clear();
    solo.reset();
    locked.clear();
    reloading_.reset();
    if (profiling) // else they are kept to be looked at
        frames.clear();
    if (cost != nullptr)
        cost->stop();
    own_ = FollowedFile(document->path(), FileContent::of(*document));
    find_import();
    if (inspecting)
        scene.inspect(std::nullopt);
    view.chosen_sample.reset();
    const auto seen = viewer::find_camera(document->registry(), bounds_of_all(*document), "");
    if (seen)
        camera.set(*seen);
    for (const std::string& note : document->notes())
        messages.say(note, Message::Kind::warning);
    if (!document->path().empty())
        note_recent(document->path());
}

// The glTF file that the scene came from, in this session or an earlier one.
void Session::find_import() {
    imported_ = {};
    import_was_changed_ = file_was_changed_ = false;
    hashes_ = {};
    if (own_.is_gltf()) // an edit that is kept for a crash takes it along
        remember_source(document->folder());
    if (document->source() == nullptr || own_.is_gltf())
        return;
    auto link = source_link_of(*document, *document->source(), document->folder(), hashes_);
    if (!messages.check(link ? Status() : Status(link.error())))
        return;
    const bool newer = is_newer(*link, document->folder(), allow_outside);
    imported_ = FollowedFile(link->file, std::move(link->content));
    if (newer)
        imported_.see(FileStamp()); // it was exported again meanwhile, which will be said
}

void Session::follow_focus(const app::InputState& now) {
    if ((!now.focused || now.lost_focus) && document->in_gesture())
        document->cancel();
}

void Session::open(const std::filesystem::path& path) {
    unless_unsaved([this, path] { open_now(path); });
}

void Session::open_now(const std::filesystem::path& path) {
    recovering.reset();
    begin_opening(std::make_unique<Opening>(path, allow_outside, wake));
}

void Session::open_dropped(const std::vector<std::filesystem::path>& files) {
    if (files.empty())
        return;
    if (files.size() > 1)
        messages.say(std::to_string(files.size()) + " files were dropped; only the first is opened",
                     Message::Kind::warning);
    open(files.front());
}

void Session::begin_opening(std::unique_ptr<Opening> loads) {
    opening = std::move(loads);
    given_up_ = edits();
}

void Session::finish_opening(const std::function<void(const Loaded&)>& replace) {
    if (opening == nullptr || !opening->finished())
        return;
    const bool has_edits = document->unsaved() && given_up_ != edits();
    // A scene is being saved, or whoever is asked may still want to save it.
    const bool is_asked = dialog == Dialog::save_as || dialog == Dialog::unsaved;
    if (document->in_gesture() || is_asked || (has_edits && dialog != Dialog::none))
        return; // when the hand has let go, and one question after the other
    Loaded loaded{opening->path(), nullptr, std::exchange(recovering, {})};
    auto result = opening->take();
    opening.reset();
    if (!messages.check(result ? Status() : Status(result.error())))
        return;
    loaded.document = std::move(*result);
    if (has_edits)
        unless_unsaved([replace, loaded] { replace(loaded); });
    else
        replace(loaded);
}

void Session::inspect(vec2 place) {
    InspectRequest request;
    request.camera = camera.view();
    request.width = shown.width;
    request.height = shown.height;
    request.x = place.x / std::max(viewport_area.z, 1.0f);
    request.y = place.y / std::max(viewport_area.w, 1.0f);
    request.serial = inspecting ? inspecting->serial + 1 : 1;
    if (request.width == 0 || request.height == 0)
        return;
    inspecting = request;
    view.chosen_sample.reset();
    scene.inspect(request);
    front = "Pixel";
}

void Session::say_what_was_opened(const std::filesystem::path& path) {
    const std::size_t notes = document->notes().size();
    messages.say("Opened " + path.filename().string() + ", " + std::to_string(document->entity_count()) + " entities" +
                 (notes == 0 ? ""
                             : "; " + std::to_string(notes) + (notes == 1 ? " note" : " notes") +
                                   " on what was left out: Messages"));
}

void Session::measure_cost(const std::string& setting, const std::string& old_value) {
    if (cost == nullptr)
        cost = make_cost_thread();
    SceneChange everything = ChangeCollector::everything(document);
    HiddenFilter::hide(hidden, muted, everything);
    everything.settings = document->settings();
    gi::Settings old = document->settings();
    if (messages.check(old.set(setting, old_value)) && messages.check(old.validate()))
        cost->measure(std::move(everything), setting, old, shown);
}

void Session::recover(const Recovered& one) {
    recovering = one;
    recovering->made = std::make_shared<Replayed>();
    begin_opening(std::make_unique<Opening>(
        one.scene,
        [one = *recovering, outside = allow_outside](const std::function<bool(float)>& progress) {
            return Recovery::load(one, progress, outside);
        },
        wake));
}

// The newest first.
void Session::note_recent(const std::filesystem::path& path) {
    const std::string name = full_name(path);
    std::erase(recent_files, name);
    recent_files.insert(recent_files.begin(), name);
    recent_files.resize(std::min(recent_files.size(), most_recent));
}

void Session::reload_file() {
    end_saving();
    if (!can_reload())
        return;
    const bool own = imported_.path().empty() || (own_.changed() && !imported_.changed());
    reloaded_ = own ? &own_ : &imported_;
    stamp_ = FileStamp::of(reloaded_->path());
    reloading_ = std::make_unique<Opening>(reloaded_->path(), allow_outside, wake);
}

void Session::finish_reload() {
    if (reloading_ == nullptr || !reloading_->finished() || document->in_gesture())
        return;
    auto now = reloading_->take();
    reloading_.reset();
    if (!messages.check(now ? Status() : Status(now.error())))
        return;
    const ReloadReport report = reloaded_->reload(*document, **now);
    reloaded_->see(stamp_);
    if (reloaded_ == &own_)
        document->saw_file(stamp_);
    remember_source(document->folder()); // a crash must not make edits of what was taken over
    messages.say(report.text(reloaded_->path().filename().string()));
    if (const std::size_t skies = document->read_skies_again(); skies > 0)
        messages.say("Pictures of the sky that are other ones now: " + std::to_string(skies));
    for (const std::string& name : report.lost)
        messages.say("'" + name + "' is no longer in the file; it was edited here, and undo brings it back",
                     Message::Kind::warning);
    if (reloaded_ == &imported_ && own_.changed())
        reload_file();
}

void Session::take_news() {
    finish_saving();
    watch_file();
    finish_reload();
    for (std::string& remark : document->take_remarks())
        messages.say(std::move(remark), Message::Kind::warning);
    if (shaders == nullptr)
        return;
    ShaderWatch::News news = shaders->take();
    for (const std::string& error : news.errors)
        messages.say(error, Message::Kind::error);
    for (CompiledShader& shader : news.compiled) {
        messages.say("Compiled " + shader.path);
        scene.replace_shader(std::move(shader));
    }
    const std::string bad = scene.status().bad_shader;
    if (!bad.empty() && bad != bad_shader_)
        messages.say(bad, Message::Kind::error);
    bad_shader_ = bad;
}

// Says so, once, when another program has written the document's file or the one that it came from.
void Session::watch_file() {
    const auto watch = [this](bool changed, bool& was_changed, const std::filesystem::path& path) {
        if (changed && !was_changed)
            messages.say("'" + path.string() +
                             "' was changed by another program; File, Reload takes over what is new there, and keeps "
                             "the edits made here",
                         Message::Kind::warning);
        was_changed = changed;
    };
    watch(document->file_changed(), file_was_changed_, document->path());
    watch(imported_.changed(), import_was_changed_, imported_.path());
}

void Session::unless_unsaved(std::function<void()> action) {
    if (!still_unsaved())
        return action();
    after_unsaved = std::move(action);
    dialog = Dialog::unsaved;
}

float Session::scene_size() {
    if (size_revision_ != document->revision()) {
        size_revision_ = document->revision();
        const vec3 extent = bounds_of_all(*document).extent();
        size_ = std::cbrt(std::max(extent.x, 1e-3f) * std::max(extent.y, 1e-3f) * std::max(extent.z, 1e-3f));
        if (document->entity_count() == 0 || extent == vec3(0.0f))
            size_ = 5.0f;
    }
    return size_;
}

float Session::grid_step() {
    return 5.0f * std::pow(10.0f, std::floor(std::log10(std::max(scene_size(), 1e-6f))) - 1.0f);
}

void Session::note_frame(const ScenePicture* picture) {
    played = picture != nullptr ? picture->played : nullptr;
    if (picture == nullptr || !profiling || (!frames.empty() && frames.back().number == picture->number))
        return;
    frames.push_back({picture->number, picture->statistics});
    frames.back().statistics.frame_ms = picture->frame_ms;
    if (frames.size() > ProfiledFrame::most)
        frames.pop_front();
}

std::string Session::file_name() const {
    return document->path().empty() ? "untitled" : document->path().filename().string();
}

} // namespace sunfleck::editor
