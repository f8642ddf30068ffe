// The journal of edits, with each of its system calls failing in turn: what is cut short or interrupted is written on;
// what fails costs that edit and those after it, and never one before.
#include "tests/editor/journal_fixture.h"
#include "tests/robust/failing_calls.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

namespace sunfleck::editor {
namespace {

class EditorJournalFaults : public EditorJournal {
protected:
    // Edits that are appended to a journal of their own, and what the document has after each.
    struct Edited {
        Edited(const std::shared_ptr<Document>& opened, const fs::path& path)
            : document(opened), base(base_of(*opened)), edits(*opened, 5) {
            EXPECT_TRUE(writer.create(path));
            writer.start_over(document->settings(), std::uint32_t(document->meshes().size()));
            static_cast<void>(collector.collect(document));
            contents.push_back(content(*document));
        }
        // One more edit that changes something; its journal's calls as `fault` says, if there is one.
        Status append(tests::CallFault* fault = nullptr) {
            for (;;) {
                edits.once();
                const auto change = collector.collect(document);
                if (!change || change->is_empty())
                    continue;
                writer.note(change->updates, change->settings, change->meshes);
                contents.push_back(content(*document));
                tests::fail_calls_of_this_thread(fault);
                Status kept = writer.append(1, document->revision(), "edit");
                tests::fail_calls_of_this_thread(nullptr);
                return kept;
            }
        }
        std::shared_ptr<Document> document;
        JournalBase base;
        tests::RandomEdits edits;
        ChangeCollector collector;
        JournalWriter writer;
        std::vector<std::string> contents;
    };

    // Three edits, one with the fault, two more; whether the fault came. `reached`: the calls that failed.
    bool go_on_after(tests::CallFault fault, std::set<std::string>& reached) {
        Edited edited(open(), folder_ / "journal");
        for (int i = 0; i < 3; ++i)
            EXPECT_TRUE(edited.append());
        const Status kept = edited.append(&fault);
        if (fault.name == nullptr) {
            EXPECT_TRUE(kept);
            return false;
        }
        reached.insert(fault.name);
        const std::string what =
            std::string(fault.name) + ", " + std::strerror(fault.error) + ", then " + std::strerror(fault.later);
        const bool harmless = fault.later == 0 && (fault.error == 0 || fault.error == EINTR);
        EXPECT_EQ(bool(kept), harmless) << what;
        if (!kept) {
            EXPECT_NE(kept.error().message.find((folder_ / "journal").string()), std::string::npos) << what;
        }
        for (int i = 0; i < 2; ++i)
            EXPECT_TRUE(edited.append()) << what;
        EXPECT_EQ(std::ranges::count(read_file(folder_ / "journal").value(), '\n'), kept ? 6 : 5)
            << what << ": no line goes on from remains of another";
        const std::size_t whole = kept ? 6 : 3;
        const std::shared_ptr<Document> found = open();
        const Replayed replayed = replay(*found, read_file(folder_ / "journal").value(), edited.base);
        EXPECT_EQ(replayed.names.size(), whole) << what;
        EXPECT_EQ(replayed.complete, bool(kept)) << what << ": it is said that edits are missing";
        EXPECT_EQ(content(*found), edited.contents[whole]) << what;
        return true;
    }
};

TEST_F(EditorJournalFaults, EachCallMayFailOnceOrFromThenOn) {
    std::set<std::string> reached;
    int tried = 0;
    for (const int error : {ENOSPC, EIO, EDQUOT, EINTR, 0})
        for (const int later : {0, EIO}) // with the second, what was written of a line cannot be cut off, either
            for (int at = 0; go_on_after({at, error, later}, reached); ++at)
                ++tried;
    EXPECT_EQ(reached, std::set<std::string>{"write"}) << "of an edit that is written whole, nothing else is called";
    EXPECT_GE(tried, 10);
    std::printf("%d tried\n", tried);
}

} // namespace
} // namespace sunfleck::editor
