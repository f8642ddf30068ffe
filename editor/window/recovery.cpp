#include "editor/window/recovery.h"

#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/io/scene_file.h"
#include "viewer/quality.h"

#include <algorithm>
#include <chrono>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;
using RecoveryClock = std::chrono::steady_clock;

constexpr const char *scene_name = "edits.scene.json", *about_name = "about.json", *lock_name = "lock";
constexpr double pause_share = 3.0; // of a write's time: pause after it
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

std::optional<Recovered> read_about(const fs::path& folder) {
    const auto text = read_file(folder / about_name, 1u << 20);
    const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    std::error_code code;
    if (!json.is_object() || !fs::exists(folder / scene_name, code))
        return std::nullopt;
    Recovered result;
    result.folder = folder;
    result.scene = folder / scene_name;
    if (const auto file = json.find("file"); file != json.end() && file->is_string())
        result.file = file->get<std::string>();
    if (const auto count = json.find("count"); count != json.end() && count->is_number_unsigned())
        result.count = count->get<std::uint64_t>();
    if (const auto edits = json.find("edits"); edits != json.end() && edits->is_array())
        for (const auto& edit : *edits)
            if (edit.is_string())
                result.edits.push_back(edit.get<std::string>());
    return result;
}

} // namespace

// The thread's own copy of the document.
struct Recovery::Copy : PlainCopy {};

Recovery::Recovery(const fs::path& folder) {
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
    thread_ = std::thread([this] { run(); });
}

Recovery::~Recovery() {
    if (lock_ < 0)
        return;
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
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
    const std::scoped_lock lock(mutex_);
    next_.add(change);
}

void Recovery::unsaved(const std::string& file, std::vector<std::string> edits, std::uint64_t count) {
    if (lock_ < 0)
        return;
    {
        const std::scoped_lock lock(mutex_);
        about_.file = file;
        about_.edits = std::move(edits);
        about_.count = count;
        has_work_ = true;
    }
    changed_.notify_one();
}

void Recovery::remove_files() const {
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(own_, code))
        if (entry.path().filename() != lock_name)
            fs::remove(entry.path(), code);
}

// The scene first: about.json says that it is complete.
void Recovery::write(std::unique_ptr<Copy>& copy) {
    Recovered about;
    {
        const std::scoped_lock lock(mutex_);
        if (next_.everything)
            copy = std::make_unique<Copy>();
        if (next_.source != nullptr)
            copy->apply(std::exchange(next_, {}));
        about = about_;
    }
    if (about.count == 0)
        return remove_files();
    io::SaveOptions options;
    options.settings = viewer::unusual_lighting(copy->settings);
    const nlohmann::json json = {{"file", about.file}, {"edits", about.edits}, {"count", about.count}};
    Status status = io::save_scene(own_ / scene_name, copy->registry, copy->meshes, copy->textures, options);
    if (status)
        status = write_file(own_ / about_name, json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
    if (!status)
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
        write(copy);
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
    std::vector<fs::path> runs;
    for (const auto& entry : fs::directory_iterator(folder, code))
        if (entry.is_directory(code))
            runs.push_back(entry.path());
    for (const fs::path& run : runs) {
        const int lock = take_lock(run);
        if (lock < 0)
            continue; // it lives
        if (std::optional<Recovered> about = read_about(run))
            found.emplace_back(fs::last_write_time(about->scene, code), std::move(*about));
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

void Recovery::discard(const Recovered& recovered) {
    std::error_code code;
    std::filesystem::remove_all(recovered.folder, code);
}

} // namespace sunfleck::editor
