// What writes files of a kind, tried with each of its system calls failing: once, from then on, and two of them.
#pragma once

#include "engine/core/result.h"
#include "tests/robust/failing_calls.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <string>

namespace sunfleck::tests {

struct Writer {
    std::string name;
    std::function<Status(int which)> write; // 0: what was there before; 1: what takes its place
    std::function<int()> read;              // which of them is there; -1: neither, or not whole
    bool writes_twice = false;              // the same once more, so that after an error either may be there
    bool other_threads = false;             // write, too
};

struct WriterCounts {
    int tried = 0, refused = 0, written = 0;
};

// All of it in the writer's folder, which has nothing else.
class FailingWriter {
public:
    FailingWriter(std::filesystem::path folder, const Writer& writer) : folder_(std::move(folder)), writer_(writer) {}

    WriterCounts try_all() {
        for (const int error : {EACCES, EIO, EROFS, EDQUOT, EMFILE, EINTR})
            try_calls(error);
        for (int at = 0; try_fault({at, EIO}); ++at)
            for (int again = at + 1, calls = fault_.count; again < calls; ++again)
                try_fault({at, EIO, 0, again});
        return try_some();
    }
    // Less, for writers that take long.
    WriterCounts try_some() {
        try_calls(ENOSPC);
        try_calls(0);
        EXPECT_GT(counts_.refused, 0) << writer_.name;
        EXPECT_GT(counts_.written, 0) << writer_.name;
        return counts_;
    }

private:
    // Each call once, and once with all that come after it.
    void try_calls(int error) {
        for (int at = 0; try_fault({at, error}); ++at) {
        }
        for (int at = 0; error != EINTR && error != 0 && try_fault({at, error, error}); ++at) {
        }
    }
    std::set<std::string> names() const {
        std::set<std::string> result;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
            result.insert(entry.path().string());
        return result;
    }
    Status write_new() {
        (writer_.other_threads ? fail_calls_of_all_threads : fail_calls_of_this_thread)(&fault_);
        Status status = writer_.write(1);
        (writer_.other_threads ? fail_calls_of_all_threads : fail_calls_of_this_thread)(nullptr);
        return status;
    }
    // False: there are not so many calls.
    bool try_fault(const CallFault& fault) {
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            std::filesystem::remove_all(entry.path());
        const Status before = writer_.write(0);
        EXPECT_TRUE(before) << writer_.name << ": " << (before ? "" : before.error().message);
        EXPECT_EQ(writer_.read(), 0) << writer_.name;
        fault_ = fault;
        const Status status = write_new();
        if (fault_.name == nullptr)
            return false;
        ++counts_.tried;
        ++(status ? counts_.written : counts_.refused);
        judge(status);
        return true;
    }
    void judge(const Status& status) const {
        const std::string what = writer_.name + ", " + fault_.name + ", call " + std::to_string(fault_.at) +
                                 (fault_.later != 0 ? " and all after it, " : ", ") +
                                 (fault_.again >= 0 ? "and call " + std::to_string(fault_.again) + ", " : "") +
                                 std::strerror(fault_.error) + (status ? ": written" : ": " + status.error().message);
        const int found = writer_.read();
        if (status) {
            EXPECT_EQ(found, 1) << what;
        } else {
            EXPECT_TRUE(found == 0 || (found == 1 && writer_.writes_twice)) << what << ", and there is " << found;
            EXPECT_NE(status.error().message.find(folder_.parent_path().string()), std::string::npos) << what;
            EXPECT_NE(status.error().message.find(std::strerror(fault_.error)), std::string::npos) << what;
        }
        for (const std::string& name : names())
            EXPECT_FALSE(name.ends_with(".tmp")) << what << " left " << name;
        EXPECT_TRUE(writer_.write(1)) << what << ": and again";
        EXPECT_EQ(writer_.read(), 1) << what << ": and again";
    }

    const std::filesystem::path folder_;
    const Writer& writer_;
    CallFault fault_;
    WriterCounts counts_;
};

} // namespace sunfleck::tests
