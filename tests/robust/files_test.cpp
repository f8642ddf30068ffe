// Written files: old or new and never broken, whatever the name leads to and whenever the writer is killed.
#include "engine/core/file.h"
#include "engine/core/log.h"
#include "engine/core/memory_limit.h"
#include "engine/core/output.h"
#include "engine/core/random.h"
#include "engine/io/image.h"
#include "tests/support/gltf_files.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <set>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

class RobustFiles : public testing::Test {
protected:
    void SetUp() override {
        set_log_sink([this](LogLevel, std::string_view text) { log += std::string(text) + "\n"; });
    }
    void TearDown() override { set_log_sink({}); }
    // Names in the folder; a temporary file would be one of them.
    std::set<std::string> names() const {
        std::set<std::string> result;
        for (const auto& entry : fs::directory_iterator(folder.path))
            result.insert(entry.path().filename().string());
        return result;
    }
    fs::path at(const std::string& name) const { return folder.path / name; }
    static mode_t mode_of(const fs::path& path) {
        struct stat information {};
        return ::lstat(path.c_str(), &information) == 0 ? information.st_mode : 0;
    }

    tests::Folder folder;
    std::string log;
};

void expect_error(const Status& status, const std::string& word) {
    ASSERT_FALSE(status) << "should fail: " << word;
    EXPECT_NE(status.error().message.find(word), std::string::npos) << status.error().message;
}

TEST_F(RobustFiles, LinksAreFollowedAndSaid) {
    fs::create_directory(at("other"));
    ASSERT_TRUE(write_file(at("other/target.txt"), "old"));
    fs::create_symlink("other/target.txt", at("first"));
    fs::create_symlink("first", at("second"));
    fs::create_symlink("other/new.txt", at("dangling"));
    ASSERT_TRUE(write_file(at("second"), "new"));
    ASSERT_TRUE(write_file(at("dangling"), "made"));
    EXPECT_EQ(read_file(at("other/target.txt")).value(), "new");
    EXPECT_EQ(read_file(at("other/new.txt")).value(), "made");
    for (const char* link : {"first", "second", "dangling"})
        EXPECT_TRUE(fs::is_symlink(at(link))) << link;
    EXPECT_NE(log.find("second"), std::string::npos) << log;
    EXPECT_NE(log.find("other/target.txt"), std::string::npos) << log;
    EXPECT_EQ(names(), (std::set<std::string>{"dangling", "first", "other", "second"}));
    fs::create_symlink("round", at("about"));
    fs::create_symlink("about", at("round"));
    expect_error(write_file(at("round"), "x"), "round");
    EXPECT_TRUE(fs::is_symlink(at("round")));
}

TEST_F(RobustFiles, PipesAreWrittenTo) {
    ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
    const std::string content(300'000, 'x'); // more than a pipe holds
    std::string read;
    std::thread reader([&] {
        std::ifstream stream(at("pipe"));
        read.assign(std::istreambuf_iterator<char>(stream), {});
    });
    EXPECT_TRUE(write_file(at("pipe"), content));
    reader.join();
    EXPECT_EQ(read, content);
    EXPECT_TRUE(S_ISFIFO(mode_of(at("pipe"))));
    // A reader that goes away is an error, and no signal ends the program.
    std::thread leaving([&] { ::close(::open(at("pipe").c_str(), O_RDONLY)); });
    expect_error(write_file(at("pipe"), content), "pipe");
    leaving.join();
    EXPECT_EQ(names(), (std::set<std::string>{"pipe"}));
}

// As root the devices are made for the test: what it is about would replace those of the system.
TEST_F(RobustFiles, DevicesStayDevices) {
    fs::path null = "/dev/null", full = "/dev/full";
    if (::getuid() == 0) {
        null = at("null");
        full = at("full");
        if (::mknod(null.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0 ||
            ::mknod(full.c_str(), S_IFCHR | 0600, makedev(1, 7)) != 0 || !std::ofstream(null))
            GTEST_SKIP() << "no device can be made here";
    }
    EXPECT_TRUE(write_file(null, "x"));
    expect_error(write_file(full, "x"), "No space left");
    fs::create_symlink(full, at("link"));
    expect_error(write_file(at("link"), "x"), "link");
    EXPECT_TRUE(S_ISCHR(mode_of(null)));
    EXPECT_TRUE(S_ISCHR(mode_of(full)));
}

// What /dev/stdout leads to is written to and not replaced, also where it is a file.
TEST_F(RobustFiles, OpenFilesOfTheProcessAreWrittenTo) {
    const int file = ::open(at("open.txt").c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_GE(file, 0);
    ASSERT_TRUE(write_file("/proc/self/fd/" + std::to_string(file), "by number"));
    char text[32] = {};
    EXPECT_EQ(::pread(file, text, sizeof text, 0), 9) << "the open file has it";
    EXPECT_EQ(std::string(text), "by number");
    ::close(file);
}

TEST_F(RobustFiles, FoldersSocketsAndEmptyNamesAreRefused) {
    fs::create_directory(at("folder"));
    expect_error(write_file(at("folder"), "x"), "folder");
    expect_error(write_file(at("folder") / "", "x"), "folder");
    expect_error(write_file(at("missing/x"), "x"), "missing");
    expect_error(write_file("", "x"), "name");
    expect_error(write_file(at(std::string(256, 'a')), "x"), "too long");
    const int file = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{AF_UNIX, {}};
    std::snprintf(address.sun_path, sizeof address.sun_path, "%s", at("socket").c_str());
    ASSERT_EQ(::bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::close(file);
    expect_error(write_file(at("socket"), "x"), "socket");
    EXPECT_TRUE(S_ISSOCK(mode_of(at("socket"))));
    EXPECT_EQ(names(), (std::set<std::string>{"folder", "socket"}));
}

TEST_F(RobustFiles, NamesOfAnyBytesAndLength) {
    for (const std::string& name : {std::string(255, 'n'), std::string("a b\nc\t'\"$;*"), std::string("\xff\xfe.png"),
                                    std::string("-o"), std::string("..."), std::string(127, '\xc3')}) {
        ASSERT_TRUE(write_file(at(name), "1")) << name;
        ASSERT_TRUE(write_file(at(name), "22")) << name;
        EXPECT_EQ(read_file(at(name)).value(), "22");
    }
    EXPECT_EQ(names().size(), 6u);
}

TEST_F(RobustFiles, PermissionsStay) {
    ASSERT_TRUE(write_file(at("a"), "1"));
    ASSERT_EQ(::chmod(at("a").c_str(), 0640), 0);
    ASSERT_TRUE(write_file(at("a"), "2"));
    EXPECT_EQ(mode_of(at("a")) & 07777u, 0640u);
    const mode_t mask = ::umask(027);
    ASSERT_TRUE(write_file(at("b"), "1"));
    ::umask(mask);
    EXPECT_EQ(mode_of(at("b")) & 07777u, 0640u);
    if (::getuid() == 0) {
        ASSERT_EQ(::chown(at("a").c_str(), 12, 34), 0);
        ASSERT_TRUE(write_file(at("a"), "3"));
        struct stat information {};
        ASSERT_EQ(::stat(at("a").c_str(), &information), 0);
        EXPECT_EQ(information.st_uid, 12u);
        EXPECT_EQ(information.st_gid, 34u);
    }
}

// In a process without root's rights: a file that may not be written is not replaced, though its folder would allow it.
TEST_F(RobustFiles, FilesWithoutPermissionAreNotReplaced) {
    ASSERT_TRUE(write_file(at("read_only"), "old"));
    ASSERT_EQ(::chmod(at("read_only").c_str(), 0444), 0);
    ASSERT_EQ(::chmod(folder.path.c_str(), 0777), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        if (::getuid() == 0 && ::setuid(65534) != 0)
            ::_exit(2);
        ::_exit(write_file(at("read_only"), "new") ? 1 : 0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0);
    EXPECT_EQ(read_file(at("read_only")).value(), "old");
}

TEST_F(RobustFiles, TwoOutputsThatAreOneFileAreRefused) {
    fs::create_directory(at("folder"));
    ASSERT_TRUE(write_file(at("a.png"), "x"));
    fs::create_symlink("a.png", at("link.png"));
    fs::create_hard_link(at("a.png"), at("hard.png"));
    const auto check = [&](const fs::path& a, const fs::path& b) {
        const NamedFile files[] = {{"-o", a}, {"--stats", b}};
        return check_outputs(files);
    };
    const auto expect_refused = [&](const fs::path& a, const fs::path& b) {
        expect_error(check(a, b), "--stats");
        const NamedFile output{"-o", a}, input{"SCENE", b};
        if (fs::exists(b))
            expect_error(check_outputs({&output, 1}, {&input, 1}), "SCENE");
    };
    expect_refused(at("a.png"), at("a.png"));
    expect_refused(at("a.png"), at("folder/../a.png"));
    expect_refused(at("a.png"), at("link.png"));
    expect_refused(at("a.png"), at("hard.png"));
    expect_refused(at("new.png"), at("./new.png"));
    EXPECT_TRUE(check(at("a.png"), at("b.png")));
    EXPECT_TRUE(check(at("a.png"), ""));
    EXPECT_TRUE(check("/dev/null", "/dev/null"));
    EXPECT_EQ(read_file(at("a.png")).value(), "x");
}

TEST_F(RobustFiles, TryingFindsWhatAWriteWouldMeet) {
    ASSERT_TRUE(write_file(at("a"), "old"));
    EXPECT_TRUE(try_output(at("a"), 1'000'000));
    EXPECT_TRUE(try_output(at("b")));
    EXPECT_TRUE(try_output("/dev/null"));
    expect_error(try_output(at("missing/a")), "missing");
    expect_error(try_output(folder.path), "folder");
    expect_error(try_output(at("a"), std::uint64_t(1) << 60), "MB");
    expect_error(try_output("/proc/a"), "/proc/a");
    EXPECT_EQ(names(), std::set<std::string>{"a"});
    EXPECT_EQ(read_file(at("a")).value(), "old");
}

// A file system of 1 MB that fills up; needs root's rights.
TEST_F(RobustFiles, AFullDiskKeepsTheOldContent) {
    const fs::path disk = at("disk");
    fs::create_directory(disk);
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=1m") != 0)
        GTEST_SKIP() << "no file system can be mounted here";
    ASSERT_TRUE(write_file(disk / "a", std::string(400'000, 'o')));
    expect_error(write_file(disk / "a", std::string(900'000, 'n')), "No space left");
    expect_error(try_output(disk / "b", 900'000), "No space left");
    expect_error(write_file(disk / "b", std::string(900'000, 'n')), "No space left");
    EXPECT_EQ(read_file(disk / "a").value(), std::string(400'000, 'o'));
    EXPECT_EQ(std::distance(fs::directory_iterator(disk), {}), 1);
    ASSERT_TRUE(write_file(disk / "a", std::string(500'000, 'n'))) << "it still fits";
    EXPECT_EQ(::umount2(disk.c_str(), MNT_DETACH), 0);
}

TEST_F(RobustFiles, ManyThreadsWriteOneFile) {
    std::vector<std::thread> threads;
    threads.reserve(4);
    std::atomic<int> failed{0};
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < 25; ++i)
                failed += write_file(at("a"), std::string(20'000, char('a' + t))) ? 0 : 1;
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(failed, 0);
    const std::string content = read_file(at("a")).value();
    EXPECT_EQ(content, std::string(20'000, content[0]));
    EXPECT_EQ(names(), std::set<std::string>{"a"});
}

// Writes without end; counts what it has written.
[[noreturn]] void write_forever(const fs::path& file, std::atomic<int>& written) {
    for (char letter = 'b';; letter = letter == 'z' ? 'b' : char(letter + 1)) {
        if (!write_file(file, std::string(60'000, letter)))
            ::_exit(1);
        ++written;
    }
}

// Killed at random moments, after none to four whole writes, however long this machine takes for one: old or new, and
// what they left goes with the next write.
TEST_F(RobustFiles, KilledWritersLeaveOldOrNew) {
    const int kills = tests::by_size(60, 300);
    void* shared = ::mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(shared, MAP_FAILED);
    std::atomic<int>& written = *new (shared) std::atomic<int>(0);
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 8; ++i)
        ASSERT_TRUE(write_file(at("a"), std::string(60'000, 'a')));
    const auto writes = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
    const std::uint32_t latest = std::uint32_t(std::max<long long>(writes.count() / 4, 1));
    int left = 0;
    std::set<char> seen;
    for (int attempt = 0; attempt < kills; ++attempt) {
        written = 0;
        const pid_t child = ::fork();
        if (child == 0)
            write_forever(at("a"), written);
        while (written < attempt % 5 && ::waitpid(child, nullptr, WNOHANG) == 0)
            ::usleep(20);
        ::usleep(useconds_t(pcg_hash(std::uint32_t(attempt)) % latest));
        ::kill(child, SIGKILL);
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child) << "a write failed";
        EXPECT_TRUE(WIFSIGNALED(status)) << "a write failed";
        const std::string content = read_file(at("a")).value();
        ASSERT_EQ(content, std::string(60'000, content[0])) << "attempt " << attempt;
        seen.insert(content[0]);
        left += names().size() > 1;
    }
    ::munmap(shared, sizeof(std::atomic<int>));
    EXPECT_GT(left, kills / 20) << "the kills came at the same harmless moment";
    EXPECT_GT(seen.size(), 3u);
    ASSERT_TRUE(write_file(at("a"), "end"));
    EXPECT_EQ(names(), std::set<std::string>{"a"}) << "what killed writers left";
}

// Before their pixels take any memory; headers are small, whatever they claim.
TEST(RobustPictures, CountAgainstTheLimit) {
    constexpr std::uint32_t side = 4096;
    const std::string png =
        io::encode_png(side, side, std::vector<std::uint8_t>(std::size_t(side) * side * 4, 77)).value();
    set_memory_limit(memory_in_use() + (std::uint64_t(32) << 20));
    const auto refused = io::decode_bytes(png);
    set_memory_limit(0);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::memory);
    for (const char* word : {"4096x4096", "128.0 MiB", "pictures", "--memory"}) // four channels, and as RGBA
        EXPECT_NE(refused.error().message.find(word), std::string::npos) << refused.error().message;
    EXPECT_EQ(io::decode_bytes(png).value().pixels.size(), std::size_t(side) * side * 4);
}

} // namespace
} // namespace sunfleck
