// The writer of files, with each of its system calls failing in turn: old or new content, one error, nothing left over.
#include "tests/robust/writers.h"

#include "engine/core/file.h"
#include "engine/core/output.h"
#include "tests/support/gltf_files.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <poll.h>
#include <set>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

class RobustWriteFaults : public testing::Test {
protected:
    std::set<std::string> names() const {
        std::set<std::string> result;
        for (const auto& entry : fs::directory_iterator(folder.path))
            result.insert(entry.path().filename().string());
        return result;
    }
    // `act` with the call of that number failing.
    Status with_fault(int at, int error, const std::function<Status()>& act) {
        fault = {at, error};
        tests::fail_calls_of_this_thread(&fault);
        Status status = act();
        tests::fail_calls_of_this_thread(nullptr);
        return status;
    }
    tests::Folder folder;
    tests::CallFault fault;
};

// What a call that fails means for the write: others are done without.
bool matters(const std::string& call, int error) {
    if (call == "fchown" || call == "fchmod" || call == "flock")
        return false;
    return error != 0 && (error != EINTR || call == "rename"); // what is interrupted is called again
}

// Every call of a write over an old file and of one to a new name, with each error: full, denied, broken, interrupted
// (once), and cut short.
TEST_F(RobustWriteFaults, EachCallMayFail) {
    const std::string old(50'000, 'o'), content(70'000, 'n');
    const fs::path file = folder.path / "file";
    int tried = 0, refused = 0, written = 0;
    std::map<std::string, int> reached;
    for (const bool replaces : {true, false})
        for (const int error : {ENOSPC, EACCES, EIO, EROFS, EDQUOT, EINTR, 0}) {
            for (int at = 0;; ++at) {
                fs::remove(file);
                if (replaces) {
                    ASSERT_TRUE(write_file(file, old));
                }
                const Status status = with_fault(at, error, [&] { return write_file(file, content); });
                if (fault.name == nullptr)
                    break;
                ++tried;
                ++reached[fault.name];
                const std::string what =
                    std::string(fault.name) + ", call " + std::to_string(at) + ", " + std::strerror(error);
                const auto now = read_file(file);
                if (status) {
                    ++written;
                    ASSERT_TRUE(now) << what;
                    EXPECT_EQ(*now, content) << what;
                } else {
                    ++refused;
                    EXPECT_NE(status.error().message.find(file.string()), std::string::npos) << status.error().message;
                    EXPECT_NE(status.error().message.find(std::strerror(error)), std::string::npos) << what;
                    EXPECT_EQ(bool(now), replaces) << what;
                    EXPECT_TRUE(!now || *now == old) << what;
                }
                EXPECT_TRUE(status || matters(fault.name, error)) << what << ": " << status.error().message;
                EXPECT_LE(names().size(), now ? 1u : 0u) << what << ": a temporary file is left";
            }
        }
    for (const char* call : {"open", "write", "fsync", "rename", "flock", "fchown", "fchmod"})
        EXPECT_GT(reached[call], 0) << call;
    std::printf("%d tried, %d refused, %d written\n", tried, refused, written);
}

// A pipe is written to, not replaced: each call with each error, more than a pipe holds at once.
TEST_F(RobustWriteFaults, EachCallToAPipeMayFail) {
    const std::string content(200'000, 'n');
    const fs::path pipe = folder.path / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::map<std::string, int> reached;
    for (const int error : {ENOSPC, EACCES, EIO, EINTR, 0})
        for (int at = 0;; ++at) {
            std::string received;
            // Opened for writing, too, so that neither side waits for the other to open it.
            const int file = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);
            ASSERT_GE(file, 0);
            std::atomic<bool> written_all = false;
            std::thread reader([&] {
                std::array<char, 4096> piece;
                pollfd waits{file, POLLIN, 0};
                while (::poll(&waits, 1, 10) > 0 || !written_all)
                    if ((waits.revents & POLLIN) != 0)
                        received.append(piece.data(),
                                        std::size_t(std::max<ssize_t>(::read(file, piece.data(), piece.size()), 0)));
            });
            const Status status = with_fault(at, error, [&] { return write_file(pipe, content); });
            written_all = true;
            reader.join();
            ::close(file);
            if (fault.name == nullptr)
                break;
            ++reached[fault.name];
            const std::string what =
                std::string(fault.name) + ", call " + std::to_string(at) + ", " + std::strerror(error);
            // Opening a pipe may wait for long: what interrupts it ends it.
            const bool opening = std::string_view(fault.name) == "open" && error != 0;
            EXPECT_EQ(bool(status), !opening && !matters(fault.name, error)) << what;
            EXPECT_TRUE(status ? received == content : content.starts_with(received)) << what;
            EXPECT_TRUE(fs::is_fifo(pipe)) << what;
        }
    EXPECT_GT(reached["open"], 0);
    EXPECT_GT(reached["write"], 0);
}

// The same for a scene of two files: whatever fails, an old or a new scene is there.
TEST_F(RobustWriteFaults, ASceneIsOldOrNew) {
    const fs::path place = folder / "files", path = place / "room.scene.json";
    fs::create_directory(place);
    tests::GltfBuilder square;
    square.add_square();
    const auto save = [&](int which) {
        tests::World world;
        EXPECT_TRUE(world.import(square.glb()));
        const ecs::Entity entity = world.registry.create();
        world.registry.emplace<scene::Name>(entity, {which == 0 ? "old" : "new"});
        world.registry.emplace<scene::Transform>(entity, {});
        return io::save_scene(path, world.registry, world.meshes, world.textures);
    };
    const auto load = [&] {
        tests::World world;
        if (!io::load_scene(path, world.registry, world.meshes, world.textures))
            return -1;
        const bool is_old = !scene::find_by_name(world.registry, "old").is_null(),
                   is_new = !scene::find_by_name(world.registry, "new").is_null();
        return is_old == is_new ? -1 : int(is_new);
    };
    const tests::Writer scene{"scene", save, load};
    const tests::WriterCounts counts = tests::FailingWriter(place, scene).try_all();
    std::printf("%d tried, %d kept the old scene\n", counts.tried, counts.refused);
}

// Beforehand, with the space that a write takes: what cannot reserve any has nothing to say; all else counts.
TEST_F(RobustWriteFaults, ATrialFindsWhatAWriteWouldMeet) {
    const fs::path file = folder / "file";
    ASSERT_TRUE(write_file(file, "old"));
    std::map<std::string, int> reached;
    for (const int error :
         {ENOSPC, EDQUOT, EFBIG, EACCES, EIO, EROFS, EPERM, EINTR, EOPNOTSUPP, ENOSYS, EINVAL, ENODEV})
        for (int at = 0;; ++at) {
            const Status status = with_fault(at, error, [&] { return try_output(file, 10'000'000); });
            if (fault.name == nullptr)
                break;
            ++reached[fault.name];
            const std::string_view call = fault.name;
            const bool cannot_reserve = error == EOPNOTSUPP || error == ENOSYS || error == EINVAL || error == ENODEV;
            const bool matters =
                call == "fallocate" ? !cannot_reserve && error != EINTR : call == "open" && error != EINTR;
            const std::string what = std::string(call) + ", " + std::strerror(error);
            EXPECT_EQ(bool(status), !matters) << what;
            if (!status) {
                EXPECT_NE(status.error().message.find(file.string()), std::string::npos) << what;
                EXPECT_NE(status.error().message.find(std::strerror(error)), std::string::npos) << what;
                EXPECT_EQ(status.error().message.find("10 MB") != std::string::npos, call == "fallocate") << what;
            }
            EXPECT_EQ(names(), std::set<std::string>{"file"}) << what;
            EXPECT_EQ(read_file(file).value(), "old") << what;
        }
    for (const char* call : {"open", "flock", "fallocate"})
        EXPECT_GT(reached[call], 0) << call;
    EXPECT_FALSE(try_output(file, ~std::uint64_t(0))) << "more than a file can have";
}

} // namespace
} // namespace sunfleck
