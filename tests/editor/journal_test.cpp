// What a crash leaves: all edits but the one that was being made, wherever the program was killed.
#include "tests/editor/journal_fixture.h"

#include "tests/support/test_size.h"

#include <sys/resource.h>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

// Killed at counted places, some before anything but the journal was written, some while scenes are.
TEST_F(EditorJournal, KeepsEveryEditWhereverTheProgramIsKilled) {
    for (std::uint32_t seed = 1; seed <= tests::by_size(24u, 200u); ++seed) {
        if (!tests::in_part(seed))
            continue;
        SCOPED_TRACE("seed " + std::to_string(seed));
        const int count = 1 + int(seed * 7 % 40), pause = seed % 3 == 0 ? 9000 : seed % 3 == 1 ? 0 : 1500;
        edit_and_die(seed, count, pause);
        const std::shared_ptr<Document> wanted = open();
        tests::RandomEdits edits(*wanted, seed);
        ChangeCollector collector;
        for (int i = 0; i < count; ++i)
            edit(wanted, edits, collector, nullptr);
        const std::vector<Recovered> left = Recovery::left_behind(folder_ / "recovery");
        if (!wanted->unsaved()) { // nothing was changed in the end
            EXPECT_TRUE(left.empty());
            fs::remove_all(folder_ / "recovery");
            continue;
        }
        ASSERT_EQ(left.size(), 1u);
        auto found = Recovery::load(left[0]);
        ASSERT_TRUE(found) << found.error().message;
        EXPECT_EQ(content(**found), content(*wanted)) << first_difference(content(**found), content(*wanted));
        EXPECT_FALSE(left[0].edits.empty()) << "it is said what would be restored";
        EXPECT_TRUE((*found)->unsaved());
        EXPECT_TRUE((*found)->path().empty()) << "no file is replaced";
        Recovery::discard(left[0]);
    }
}

// Whatever throws on the way out of the program, before anything was saved.
TEST_F(EditorJournal, AnExceptionLosesNothing) {
    const std::shared_ptr<Document> document = open();
    try {
        ChangeCollector collector;
        Recovery recovery(folder_ / "recovery");
        recovery.change(*collector.collect(document));
        recovery.saved(document->path().string());
        tests::RandomEdits edits(*document, 5);
        for (int i = 0; i < 20; ++i)
            edit(document, edits, collector, &recovery);
        throw std::runtime_error("any");
    } catch (const std::runtime_error&) {
    }
    const std::vector<Recovered> left = Recovery::left_behind(folder_ / "recovery");
    ASSERT_EQ(left.size(), 1u);
    auto found = Recovery::load(left[0]);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(content(**found), content(*document));
    Recovery::discard(left[0]);
}

// What was kept is from the future then.
TEST_F(EditorJournal, AClockThatWasSetBack) {
    for (const int pause : {0, 9000}) {
        edit_and_die(5, 20, pause);
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / "recovery"))
            fs::last_write_time(entry, fs::file_time_type::clock::now() + std::chrono::years(20));
        const std::shared_ptr<Document> wanted = open();
        tests::RandomEdits edits(*wanted, 5);
        ChangeCollector collector;
        for (int i = 0; i < 20; ++i)
            edit(wanted, edits, collector, nullptr);
        const std::vector<Recovered> left = Recovery::left_behind(folder_ / "recovery");
        ASSERT_EQ(left.size(), 1u);
        auto found = Recovery::load(left[0]);
        ASSERT_TRUE(found) << found.error().message;
        EXPECT_EQ(content(**found), content(*wanted));
        Recovery::discard(left[0]);
    }
}

// Killed at random moments, a third of the runs while they save all the time: the file is always one that was saved
// whole, and file and journal together have all edits but the one that was being made.
TEST_F(EditorJournal, KeepsFileAndEditsWheneverTheProgramIsKilled) {
    std::mt19937 random(11);
    int offered = 0, in_saves = 0, tried = 0;
    for (std::uint32_t seed = 1; seed <= tests::by_size(15u, 200u); ++seed) {
        const auto after = useconds_t(random() % 60'000);
        if (!tests::in_part(seed))
            continue;
        ++tried;
        SCOPED_TRACE("seed " + std::to_string(seed));
        const bool saves = seed % 3 == 0;
        const std::shared_ptr<Document> wanted = open();
        const int made = edit_until_killed(seed, saves, after);
        in_saves += saves ? 1 : 0;
        const std::shared_ptr<Document> file = open();
        ASSERT_NE(file, nullptr);
        const std::string in_file = content(*file);
        // What it may be: after each edit that was made, and the one that may have been on its way.
        std::vector<std::string> contents{content(*wanted)}, files{content(*wanted)};
        tests::RandomEdits edits(*wanted, seed);
        for (int i = 0; i <= made; ++i) {
            edits.once();
            contents.push_back(content(*wanted));
            files.push_back(saves ? content_of_save(*wanted) : files.front());
        }
        EXPECT_NE(std::find(files.begin(), files.end(), in_file), files.end())
            << "the file is neither: " << first_difference(in_file, files[std::size_t(made)]);
        std::string found = in_file;
        const std::vector<Recovered> left = Recovery::left_behind(folder_ / "recovery");
        if (!left.empty()) {
            auto recovered = Recovery::load(left[0]);
            ASSERT_TRUE(recovered) << recovered.error().message;
            found = content(**recovered);
            ++offered;
        }
        const auto newest = std::size_t(made);
        const auto is_newest = [&](const std::string& text, const std::vector<std::string>& of) {
            return text == of[newest] || text == of[newest + 1];
        };
        EXPECT_TRUE(is_newest(found, contents) || (saves && (is_newest(in_file, files) || is_newest(found, files))))
            << made << " edits were made";
        fs::remove_all(folder_ / "recovery");
    }
    EXPECT_GE(4 * offered, tried);
    EXPECT_GE(4 * in_saves, tried) << "of parts, too, unless their number is a multiple of 3";
}

// The disk is full, at any byte of a save: one error, and the file is the old one or the new one.
TEST_F(EditorJournal, AFullDiskLosesNothing) {
    std::mt19937 random(3);
    int failed = 0, tried = 0;
    for (std::uint32_t seed = 1; seed <= tests::by_size(12u, 50u); ++seed) {
        const auto bytes = rlim_t(random() % 30'000);
        if (!tests::in_part(seed))
            continue;
        ++tried;
        SCOPED_TRACE("seed " + std::to_string(seed));
        const std::shared_ptr<Document> document = open();
        const std::string before = content(*document);
        tests::RandomEdits edits(*document, seed);
        for (int i = 0; i < 5; ++i)
            edits.once();
        const std::string after = content(*document);
        const pid_t child = ::fork();
        if (child == 0) {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlim_t limit = bytes * (seed % 4);
            const rlimit size{limit, limit};
            ::setrlimit(RLIMIT_FSIZE, &size);
            ::_exit(document->save(folder_ / "room.scene.json") ? 0 : 3);
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFEXITED(status));
        const bool saved = WEXITSTATUS(status) == 0;
        failed += saved ? 0 : 1;
        EXPECT_EQ(content(*open()), saved ? after : before);
    }
    EXPECT_GE(4 * failed, tried);
}

// The last line is cut off anywhere: all edits before it are there.
TEST_F(EditorJournal, ALineThatWasCutOffIsLeftOut) {
    const std::shared_ptr<Document> document = open();
    const JournalBase base = base_of(*document);
    JournalWriter writer;
    ASSERT_TRUE(writer.create(folder_ / "journal"));
    writer.start_over(document->settings(), document->meshes().size());
    ChangeCollector collector;
    static_cast<void>(collector.collect(document));
    tests::RandomEdits edits(*document, 5);
    std::vector<std::string> contents{content(*document)};
    std::vector<std::size_t> ends{0};
    while (ends.size() < 12) {
        edits.once();
        const auto change = collector.collect(document);
        if (!change || change->is_empty())
            continue;
        writer.note(change->updates, change->settings, change->meshes);
        ASSERT_TRUE(writer.append(1, document->revision(), "edit"));
        contents.push_back(content(*document));
        ends.push_back(read_file(folder_ / "journal").value().size());
    }
    const std::string journal = read_file(folder_ / "journal").value();
    for (std::size_t i = 1; i < ends.size(); ++i)
        for (const std::size_t cut : {ends[i] - 1, ends[i - 1] + 1, (ends[i] + ends[i - 1]) / 2, ends[i]}) {
            const std::shared_ptr<Document> found = open();
            const Replayed replayed = replay(*found, journal.substr(0, cut), base);
            const std::size_t whole = cut == ends[i] ? i : i - 1;
            EXPECT_EQ(replayed.names.size(), whole);
            EXPECT_EQ(content(*found), contents[whole]) << "cut at " << cut;
        }
}

} // namespace
} // namespace sunfleck::editor
