#include "editor/window/recovery.h"

#include "engine/core/caught.h"
#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/io/scene_file.h"
#include "viewer/quality.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;
using RecoveryClock = std::chrono::steady_clock;

constexpr const char *about_name = "about.json", *lock_name = "lock", *base_name = "base.json",
                     *journal_name = "journal";
// In turn: about.json says which of them is whole.
constexpr const char* scene_names[] = {"edits.scene.json", "edits2.scene.json"};
constexpr std::uint64_t most_bytes = std::uint64_t(1) << 30; // of a journal
constexpr double pause_share = 3.0;                          // of a write's time: pause after it
constexpr auto shortest_pause = std::chrono::milliseconds(150);

// Of a lock that nobody else has; -1: somebody has it, or it cannot be made.
int take_lock(const fs::path& folder) {
    const int file = ::open((folder / lock_name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file >= 0 && ::flock(file, LOCK_EX | LOCK_NB) == 0)
        return file;
    if (file >= 0)
        ::close(file);
    return -1;
}

nlohmann::json read_json(const fs::path& path) {
    const auto text = read_file(path, most_bytes);
    return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
}

// Of a file that the user edited; null: there is none.
nlohmann::json stamp_of(const fs::path& path) {
    std::error_code no_time, no_size;
    const auto time = fs::last_write_time(path, no_time).time_since_epoch().count();
    const auto bytes = fs::file_size(path, no_size);
    return no_time || no_size ? nlohmann::json() : nlohmann::json{time, bytes};
}

// What the journal has beyond the scene that was kept, or beyond the user's file.
void add_journal(Recovered& result, const nlohmann::json& about) {
    const auto names = about.value("names", nlohmann::json());
    const auto base = JournalBase::from_text(names.is_string() ? names.get<std::string>() : std::string());
    const auto journal = read_file(result.folder / journal_name, most_bytes);
    if (!base || !journal)
        return;
    const Replayed edits = edits_of_journal(*journal, *base);
    result.count += edits.names.size();
    result.complete = edits.complete;
    result.edits.insert(result.edits.end(), edits.names.begin(), edits.names.end());
    constexpr std::size_t most_names = 20;
    if (result.edits.size() > most_names)
        result.edits.erase(result.edits.begin(), result.edits.end() - most_names);
    result.journal = *journal;
    result.base = *base;
}

// Nothing was kept yet but the journal: it goes on from the user's file.
std::optional<Recovered> read_base(const fs::path& folder) {
    const nlohmann::json json = read_json(folder / base_name);
    if (!json.is_object() || !json.value("file", nlohmann::json()).is_string())
        return std::nullopt;
    Recovered result;
    result.folder = folder;
    result.file = json["file"].get<std::string>();
    result.scene = result.file;
    if (!result.file.empty())
        result.user_file = stamp_of(result.file).is_null()          ? UserFile::gone
                           : stamp_of(result.file) != json["stamp"] ? UserFile::changed
                                                                    : UserFile::as_it_was;
    add_journal(result, json);
    return result.count > 0 ? std::optional(result) : std::nullopt;
}

std::optional<Recovered> read_about(const fs::path& folder) {
    const nlohmann::json json = read_json(folder / about_name);
    std::error_code code;
    const std::size_t slot = json.is_object() && json.value("slot", 0) == 1 ? 1 : 0;
    if (!json.is_object() || !fs::exists(folder / scene_names[slot], code))
        return read_base(folder);
    Recovered result;
    result.folder = folder;
    result.scene = folder / scene_names[slot];
    if (const auto file = json.find("file"); file != json.end() && file->is_string())
        result.file = file->get<std::string>();
    if (const auto home = json.find("home"); home != json.end() && home->is_string())
        result.home = home->get<std::string>();
    if (const auto count = json.find("count"); count != json.end() && count->is_number_unsigned())
        result.count = count->get<std::uint64_t>();
    if (const auto edits = json.find("edits"); edits != json.end() && edits->is_array())
        for (const auto& edit : *edits)
            if (edit.is_string())
                result.edits.push_back(edit.get<std::string>());
    add_journal(result, json);
    return result;
}

} // namespace

// The thread's own copy of the document.
struct Recovery::Copy : PlainCopy {};

Recovery::Recovery(const fs::path& folder) {
    if (folder.empty()) {
        problem_ = "unsaved edits are not kept: there is no folder for them";
        return;
    }
    std::error_code code;
    for (int number = 0; number < 1000 && lock_ < 0; ++number) {
        own_ = folder / (std::to_string(::getpid()) + "." + std::to_string(number));
        if (fs::exists(own_, code))
            continue;
        fs::create_directories(own_, code);
        if (code)
            break;
        lock_ = take_lock(own_);
    }
    if (lock_ < 0) {
        problem_ =
            "unsaved edits cannot be kept in '" + folder.string() + "': " + (code ? code.message() : "it is full");
        return;
    }
    if (const Status made = journal_.create(own_ / journal_name); !made)
        problem_ = made.error().message;
    thread_ = std::thread([this] { run(); });
}

Recovery::~Recovery() {
    if (lock_ < 0)
        return;
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
        leave_ = leave_ || std::uncaught_exceptions() > 0; // else nobody had the time to save
    }
    changed_.notify_one();
    thread_.join();
    std::error_code code;
    if (!leave_)
        fs::remove_all(own_, code);
    ::close(lock_);
}

void Recovery::leave() {
    const std::scoped_lock lock(mutex_);
    leave_ = true;
}

void Recovery::change(const SceneChange& change) {
    if (lock_ < 0)
        return;
    revision_ = change.revision;
    if (change.everything && change.source.get() != document_) {
        document_ = change.source.get();
        is_saved_ = false;
        ++about_epoch_;
        journal_.start_over(change.settings.value_or(gi::Settings()), std::uint32_t(change.meshes.size()));
    } else if (change.everything) {
        journal_.note_unknown(); // what of it is new is not said
    } else {
        journal_.note(change.updates, change.settings, change.meshes);
        if (!change.textures.empty())
            journal_.note_unknown();
    }
    const std::scoped_lock lock(mutex_);
    next_.add(change);
}

void Recovery::note_edit(const std::string& name) {
    if (!journal_.has_notes())
        return;
    const Status kept = journal_.append(about_epoch_, revision_, name);
    if (!kept && !std::exchange(journal_failed_, true))
        log_warning(kept.error().message);
}

void Recovery::unsaved(const Place& place, std::vector<std::string> edits, std::uint64_t count) {
    if (lock_ < 0)
        return;
    if (count > 0) {
        is_saved_ = false;
        note_edit(edits.empty() ? std::string() : edits.back());
    } else {
        if (std::exchange(is_saved_, true))
            return; // and nothing has been noted since
        ++about_epoch_;
        journal_.forget();
    }
    {
        const std::scoped_lock lock(mutex_);
        about_.base.epoch = about_epoch_;
        about_.base.revision = revision_;
        about_.file = place.file;
        std::error_code code;
        about_.home = place.folder.empty() ? std::string() : fs::absolute(place.folder, code).string();
        about_.edits = std::move(edits);
        about_.count = count;
        has_work_ = true;
    }
    changed_.notify_one();
}

void Recovery::remove_files() const {
    std::error_code code;
    for (const fs::path& path : folder_content(own_, code))
        if (path.filename() != lock_name && path.filename() != journal_name)
            fs::remove(path, code);
}

// The user's file has everything: only the journal is needed from here on.
void Recovery::write_base(Copy& copy, const Recovered& about) const {
    remove_files();
    if (copy_revision_ != about.base.revision)
        return; // there are edits already, whose names the file does not have
    JournalBase base = JournalBase::of(copy.registry);
    base.epoch = about.base.epoch;
    base.revision = about.base.revision;
    if (about.file.empty() && !base.entities.empty())
        return;
    const nlohmann::json json = {{"file", about.file}, {"stamp", stamp_of(about.file)}, {"names", base.text()}};
    if (const Status status =
            write_file(own_ / base_name, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
        !status)
        log_warning("edits could not be kept: " + status.error().message);
}

// The scene first: about.json says that it is complete.
void Recovery::write(std::unique_ptr<Copy>& copy) {
    Recovered about;
    SceneChange change;
    {
        const std::scoped_lock lock(mutex_);
        change = std::exchange(next_, {});
        about = about_;
    }
    if (change.everything)
        copy = std::make_unique<Copy>();
    if (change.source != nullptr) {
        copy_revision_ = change.revision;
        copy->apply(change);
        change = {}; // and the document may go
    }
    if (about.count == 0)
        return write_base(*copy, about);
    JournalBase base = JournalBase::of(copy->registry);
    base.epoch = about.base.epoch;
    base.revision = copy_revision_;
    const io::SaveOptions options = Document::save_options(copy->settings, copy->encoded.get(), copy->link.get());
    // Whatever fails, about.json goes on naming what was whole before.
    const int slot = 1 - slot_;
    const nlohmann::json json = {{"file", about.file},   {"home", about.home},   {"edits", about.edits},
                                 {"count", about.count}, {"names", base.text()}, {"slot", slot}};
    Status status = io::save_scene(own_ / scene_names[slot], copy->registry, copy->meshes, copy->textures, options);
    if (status)
        status = write_file(own_ / about_name, json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
    if (status)
        slot_ = slot;
    else
        log_warning("unsaved edits could not be kept: " + status.error().message);
    ++writes_;
}

void Recovery::run() {
    auto copy = std::make_unique<Copy>();
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return stop_ || has_work_; });
            if (stop_ && !(leave_ && has_work_))
                return;
            has_work_ = false;
        }
        const auto began = RecoveryClock::now();
        const Status written = caught([&] {
            write(copy);
            return Status();
        });
        if (!written)
            log_warning("unsaved edits could not be kept: " + written.error().message);
        const auto pause = std::max<RecoveryClock::duration>(
            shortest_pause,
            std::chrono::duration_cast<RecoveryClock::duration>((RecoveryClock::now() - began) * pause_share));
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, pause, [this] { return stop_; });
    }
}

std::vector<Recovered> Recovery::left_behind(const fs::path& folder) {
    std::vector<std::pair<fs::file_time_type, Recovered>> found;
    std::error_code code;
    for (const fs::path& run : folder_content(folder, code)) {
        if (!fs::is_directory(run, code))
            continue;
        const int lock = take_lock(run);
        if (lock < 0)
            continue; // it lives
        if (std::optional<Recovered> about = read_about(run))
            found.emplace_back(fs::last_write_time(run / journal_name, code), std::move(*about));
        else
            fs::remove_all(run, code);
        ::close(lock);
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Recovered> result;
    result.reserve(found.size());
    for (auto& [time, recovered] : found)
        result.push_back(std::move(recovered));
    return result;
}

Result<std::unique_ptr<Document>> Recovery::load(const Recovered& recovered, const std::function<bool(float)>& progress,
                                                 bool allow_outside) {
    auto document = std::make_unique<Document>();
    if (!recovered.scene.empty()) {
        SUNFLECK_ASSIGN(document, Document::open(recovered.scene, progress, allow_outside));
    }
    // Names that the scene has or that were typed are meant from where it was.
    if (!recovered.home.empty())
        document->set_folder(recovered.home);
    else if (!recovered.file.empty())
        document->set_folder(fs::path(recovered.file).parent_path());
    Replayed made = replay(*document, recovered.journal, recovered.base);
    if (recovered.made != nullptr)
        *recovered.made = std::move(made);
    document->forget_file();
    return document;
}

void Recovery::discard(const Recovered& recovered) {
    std::error_code code;
    std::filesystem::remove_all(recovered.folder, code);
}

} // namespace sunfleck::editor
