// What a crash must not take: unsaved edits are written to a folder of the run's own, behind the user's back and on a
// thread of their own, and offered by the next run. The user's files are never touched.
//
//     FOLDER/RUN/lock              held while the program lives
//     FOLDER/RUN/edits.scene.json  the scene with all edits, and its geometry; edits2.scene.json in turn with it
//     FOLDER/RUN/about.json        which of the two is whole, which file it was, and what was done to it
//     FOLDER/RUN/base.json         the user's file, while nothing else was kept yet
//     FOLDER/RUN/journal           every edit, a line each (journal.h)
//
// An edit is in the journal before the next frame is drawn. A scene is written again a moment after each edit, but so
// that writing takes a quarter of the time at most; the journal has what was done since.
#pragma once

#include "editor/document/journal.h"
#include "editor/window/scene_copy.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace sunfleck::editor {

// The user's file, where edits go on from that.
enum class UserFile { as_it_was, changed, gone };

struct Recovered {
    std::filesystem::path folder, scene; // of the run; of its edits
    std::string file;                    // that was edited; empty: it had never been saved
    std::string home;                    // the folder that names in the scene are meant from; empty: as the file's
    std::vector<std::string> edits;      // the last ones
    std::uint64_t count = 0;             // of all
    bool complete = true;                // false: an edit after them could not be kept
    std::string journal;                 // what was done since, as its lines
    JournalBase base;                    // the scene, for these
    UserFile user_file = UserFile::as_it_was;
    std::shared_ptr<Replayed> made; // where not null, what load() has made of the journal
};

class Recovery {
public:
    // Makes a folder of its own in `folder`; where that cannot be, or has no name, nothing is kept, and problem() says
    // why.
    explicit Recovery(const std::filesystem::path& folder);
    // The program ends as it should: what was kept is removed.
    ~Recovery();
    Recovery(const Recovery&) = delete;
    Recovery& operator=(const Recovery&) = delete;

    // The program ends with unsaved edits that nobody gave up (a signal): they are for the next run.
    void leave();
    const std::string& problem() const { return problem_; }
    // All changes of the document, in order.
    void change(const SceneChange& change);
    // Of the document: its file, if it has one, and the folder that its names are meant from.
    struct Place {
        std::string file;
        std::filesystem::path folder;
        Place(std::string the_file, std::filesystem::path the_folder = {})
            : file(std::move(the_file)), folder(std::move(the_folder)) {}
    };
    // What is unsaved now; nothing: what was kept is removed.
    void unsaved(const Place& place, std::vector<std::string> edits, std::uint64_t count);
    void saved(const Place& place) { unsaved(place, {}, 0); }
    // How often a scene was written.
    std::uint64_t writes() const { return writes_; }

    // What runs that are gone have left, oldest first; what has no edits is removed. Edits that go on from a file which
    // is another now, or gone, are kept, and say so.
    static std::vector<Recovered> left_behind(const std::filesystem::path& folder);
    static void discard(const Recovered& recovered);
    // The scene with all edits, as a document without a file.
    static Result<std::unique_ptr<Document>>
    load(const Recovered& recovered, const std::function<bool(float)>& progress = {}, bool allow_outside = false);

private:
    struct Copy;
    void run();
    void write(std::unique_ptr<Copy>& copy);
    void remove_files() const;
    void write_base(Copy& copy, const Recovered& about) const;
    void note_edit(const std::string& name);

    // Of the thread that edits.
    JournalWriter journal_;
    const void* document_ = nullptr;
    std::uint64_t revision_ = 0;    // of the document, noted so far
    std::uint64_t about_epoch_ = 0; // raised by every document and every save
    bool journal_failed_ = false, is_saved_ = false;

    std::filesystem::path own_;
    std::string problem_;
    int lock_ = -1;

    std::mutex mutex_; // of all until the next comment
    std::condition_variable changed_;
    SceneChange next_;
    Recovered about_;
    bool has_work_ = false, stop_ = false, leave_ = false;

    std::uint64_t copy_revision_ = 0; // of the thread's copy
    int slot_ = 1;                    // that about.json names, if there is one
    std::atomic<std::uint64_t> writes_{0};
    std::thread thread_;
};

} // namespace sunfleck::editor
