#include "engine/core/control_groups.h"
#include "engine/core/description.h"
#include "engine/core/file.h"
#include "engine/core/jobs.h"
#include "engine/core/large_pages.h"
#include "engine/core/memory_limit.h"
#include "engine/core/octahedral.h"
#include "engine/core/random.h"
#include "engine/core/result.h"
#include "engine/core/stage_times.h"
#include "engine/core/stop_signals.h"
#include "gi_module/settings.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <sys/resource.h>
#include <unistd.h>

namespace sunfleck {
namespace {

StageScope scope(const char* name, int begin_ms, int end_ms) {
    const std::chrono::steady_clock::time_point start;
    return {name, start + std::chrono::milliseconds(begin_ms), start + std::chrono::milliseconds(end_ms)};
}

// By hand: two stages follow one another, one has two within it and one of those has another of the first one's name.
TEST(StageTimes, NoTimeCountsTwice) {
    const auto times = own_milliseconds(
        {scope("a", 0, 10), scope("deep", 13, 17), scope("b", 12, 20), scope("whole", 10, 40), scope("a", 30, 35)});
    const std::map<std::string, double> expected{{"a", 15.0}, {"b", 4.0}, {"deep", 4.0}, {"whole", 17.0}};
    EXPECT_EQ(times, expected);
}

TEST(StageTimes, TimersNest) {
    StageTimes times;
    {
        const StageTimer outer(times, "outer");
        const StageTimer inner(times, "inner");
    }
    ASSERT_EQ(times.scopes().size(), 2u);
    const StageScope &inner = times.scopes()[0], &outer = times.scopes()[1];
    EXPECT_EQ(inner.name, "inner");
    EXPECT_LE(outer.begin, inner.begin);
    EXPECT_LE(inner.end, outer.end);
    times.clear();
    EXPECT_TRUE(times.milliseconds().empty());
}

// Elementary intervals: 2^m points of a (0,2)-sequence fall one into each box of area 2^-m, whatever its shape.
TEST(Random, SobolPairsAreStratifiedInEveryElementaryInterval) {
    constexpr std::uint32_t m = 8, count = 1u << m;
    for (const std::uint32_t group : {0u, 1u, 5u})
        for (std::uint32_t shape = 0; shape <= m; ++shape) {
            std::set<std::uint32_t> boxes;
            for (std::uint32_t i = 0; i < count; ++i) {
                const SobolGroup point(7, i, group);
                const std::uint32_t x = shape == 0 ? 0 : point.bits(0) >> (32 - shape);
                const std::uint32_t y = shape == m ? 0 : point.bits(1) >> (32 - (m - shape));
                boxes.insert((x << (m - shape)) | y);
            }
            EXPECT_EQ(boxes.size(), count) << "group " << group << " shape " << shape;
        }
}

TEST(Random, SobolIntegratesBetterThanPseudoRandom) {
    // Mean of x*y over [0,1)^2 is 1/4; Owen-scrambled nets converge near N^-1.5, independent numbers with N^-0.5.
    double worst_sobol = 0, mean_pseudo = 0;
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        double sobol = 0, pseudo = 0;
        for (std::uint32_t i = 0; i < 4096; ++i) {
            const RandomSequence a(SequenceKind::sobol, seed, i), b(SequenceKind::pseudo_random, seed, i);
            sobol += double(a.at(0)) * double(a.at(1));
            pseudo += double(b.at(0)) * double(b.at(1));
        }
        worst_sobol = std::max(worst_sobol, std::abs(sobol / 4096 - 0.25));
        mean_pseudo += std::abs(pseudo / 4096 - 0.25) / 8;
    }
    EXPECT_LT(worst_sobol, 2e-4);
    EXPECT_LT(worst_sobol * 4, mean_pseudo);
}

TEST(Random, IsAFunctionOfSeedIndexAndDimension) {
    const RandomSequence a(SequenceKind::sobol, 3, 17), b(SequenceKind::sobol, 3, 17), c(SequenceKind::sobol, 4, 17);
    EXPECT_EQ(a.at(9), b.at(9));
    EXPECT_EQ(a.at(2), b.at(2));
    EXPECT_NE(a.at(2), c.at(2));
}

TEST(Octahedral, PackedNormalsComeBackWithin7e5Radians) {
    RandomSequence random(SequenceKind::pseudo_random, 11, 0);
    for (int i = 0; i < 100000; ++i) {
        const float z = 2.0f * random.next() - 1.0f, angle = 2.0f * pi * random.next();
        const float r = std::sqrt(1.0f - z * z);
        const vec3 n(r * std::cos(angle), r * std::sin(angle), z);
        const vec3 back = shared::unpack_normal(shared::pack_normal(n));
        ASSERT_LT(glm::length(glm::cross(n, back)), 7e-5f);
        ASSERT_GT(glm::dot(n, back), 0.9f);
    }
}

TEST(Jobs, ChunksCoverEverythingOnceWhateverTheThreads) {
    for (const std::size_t threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        std::vector<int> seen(1003);
        parallel_for_chunks(seen.size(), 64, [&](std::size_t begin, std::size_t end) {
            EXPECT_EQ(begin % 64, 0u);
            for (std::size_t i = begin; i < end; ++i)
                ++seen[i];
        });
        EXPECT_EQ(std::set<int>(seen.begin(), seen.end()), std::set<int>{1});
    }
}

TEST(Description, TextRoundTripsAndRangesHold) {
    gi::SamplingSettings settings;
    const TypeDescription& type = gi::SamplingSettings::description();
    for (const Field& field : type.fields) {
        const std::string text = field_to_text(field, &settings);
        EXPECT_TRUE(field_from_text(field, &settings, text)) << field.name;
        EXPECT_EQ(field_to_text(field, &settings), text) << field.name;
        EXPECT_FALSE(field.tooltip.empty()) << field.name;
    }
    const Field& share = *type.find("direct_share");
    for (const char* bad : {"nan", "inf", "-0.1", "1.5", "", "0.5x", "abc", "1e999"})
        EXPECT_FALSE(field_from_text(share, &settings, bad)) << bad;
    EXPECT_EQ(settings.direct_share, 0.25f);
    EXPECT_FALSE(field_from_text(*type.find("lights"), &settings, "3.5"));
    EXPECT_FALSE(field_from_text(*type.find("sequence"), &settings, "halton"));
    settings.direct_share = NAN;
    EXPECT_FALSE(validate(type, &settings));
}

TEST(File, AFailedWriteLeavesTheOldContentAndNoTemporaryFile) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "sunfleck_file_test";
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / "data.json";
    ASSERT_TRUE(write_file(file, "old"));
    // A limit of file size acts like a full disk: the write stops in the middle.
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit small = before;
    small.rlim_cur = 4096;
    setrlimit(RLIMIT_FSIZE, &small);
    const Status status = write_file(file, std::string(100000, 'x'));
    setrlimit(RLIMIT_FSIZE, &before);
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find("data.json"), std::string::npos);
    EXPECT_EQ(read_file(file).value(), "old");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
    EXPECT_FALSE(write_file(folder / "missing" / "x.json", "x"));
    EXPECT_FALSE(read_file(folder));
    std::filesystem::remove_all(folder);
}

TEST(File, AFreeNameIsThatOfNoFile) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "sunfleck_free_name_test";
    std::filesystem::create_directories(folder);
    for (const char* name : {"trace.json", "trace 2.json", "trace 3.json"}) {
        const std::filesystem::path free = free_path(folder / "trace.json");
        EXPECT_EQ(free, folder / name);
        ASSERT_TRUE(write_file(free, name));
    }
    std::filesystem::remove(folder / "trace 2.json");
    EXPECT_EQ(free_path(folder / "trace.json"), folder / "trace 2.json");
    EXPECT_EQ(free_path(folder / "other"), folder / "other");
    std::filesystem::remove_all(folder);
}

TEST(File, AFolderThatCannotBeReadIsNoException) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "sunfleck_folder_test";
    std::filesystem::create_directories(folder);
    ASSERT_TRUE(write_file(folder / "data.json", "x"));
    std::error_code code;
    EXPECT_EQ(folder_content(folder, code), std::vector<std::filesystem::path>{folder / "data.json"});
    EXPECT_FALSE(code);
    for (const char* bad : {"missing", "data.json"}) {
        EXPECT_TRUE(folder_content(folder / bad, code).empty());
        EXPECT_TRUE(code) << bad;
    }
    std::filesystem::remove_all(folder);
}

TEST(MemoryLimit, CountsWhatIsAskedForBesideWhatIsThere) {
    const std::uint64_t by_default = memory_limit();
    EXPECT_GT(by_default, std::uint64_t(256) << 20);
    EXPECT_GT(memory_in_use(), std::uint64_t(1) << 20);
    set_memory_limit(memory_in_use() + (std::uint64_t(200) << 20));
    EXPECT_TRUE(check_memory(std::uint64_t(100) << 20, "a picture", "--size"));
    const Status refused = check_memory(std::uint64_t(3) << 30, "a picture of 16384x16384", "--size");
    set_memory_limit(0);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::memory);
    for (const char* word : {"a picture of 16384x16384", "3.0 GiB", "--size", "--memory"})
        EXPECT_NE(refused.error().message.find(word), std::string::npos) << refused.error().message;
    EXPECT_EQ(memory_limit(), by_default);
}

// Pieces that lie between others stay with the C library when they are freed, until they are given back.
TEST(MemoryLimit, FreeMemoryGoesBackToTheSystem) {
    if (tests::sanitized())
        GTEST_SKIP() << "the sanitizer has a heap of its own";
    constexpr std::size_t size = 16'384, count = 6'000; // 94 MiB
    constexpr std::uint64_t most_of_it = std::uint64_t(60) << 20;
    std::vector<std::vector<char>> pieces, kept;
    for (std::size_t i = 0; i < count; ++i) {
        pieces.emplace_back(size, 'x');
        if (i % 100 == 0)
            kept.emplace_back(size, 'x');
    }
    const std::uint64_t full = memory_in_use();
    pieces.clear();
    return_free_memory();
    EXPECT_LT(memory_in_use() + most_of_it, full);
    for (const std::vector<char>& piece : kept)
        EXPECT_EQ(std::count(piece.begin(), piece.end(), 'x'), std::ptrdiff_t(size));
}

// A level has hundreds of textures, none of them large.
TEST(MemoryLimit, SmallPiecesAreLookedAtTogether) {
    set_memory_limit(1); // less than anything has
    int let_through = 0;
    while (let_through < 100 && check_memory(std::uint64_t(8) << 20, "a picture", "their number"))
        ++let_through;
    set_memory_limit(0);
    EXPECT_LT(let_through, 8) << "pieces of 8 MiB, looked at each 64";
}

// Files as Linux has them: a group of 1,000 bytes in one of 700, of which 100 and 600 are taken and 250 can be dropped.
TEST(MemoryLimit, FollowsControlGroupsAndThoseTheyLieIn) {
    namespace fs = std::filesystem;
    const fs::path mount = fs::temp_directory_path() / ("control_groups_" + std::to_string(::getpid()));
    const auto write = [&](const char* name, const char* text) {
        fs::create_directories((mount / name).parent_path());
        ASSERT_TRUE(write_file(mount / name, text));
    };
    const auto free = [&](const char* membership) {
        write("membership", membership);
        return free_in_control_groups(mount, mount / "membership", 5000);
    };
    write("outer/memory.max", "700\n");
    write("outer/memory.current", "600\n");
    write("outer/memory.stat", "anon 350\nfile 250\ninactive_file 250\n");
    write("outer/inner/memory.max", "1000\n");
    write("outer/inner/memory.current", "100\n");
    write("outer/endless/memory.max", "max\n");
    write("outer/endless/memory.current", "100\n");
    write("memory/old/memory.limit_in_bytes", "400\n");
    write("memory/old/memory.usage_in_bytes", "300\n");
    write("memory/old/memory.stat", "cache 50\ntotal_inactive_file 50\n");
    EXPECT_EQ(free("0::/outer/inner\n"), 350u);
    EXPECT_EQ(free("0::/outer/endless\n"), 350u);
    EXPECT_EQ(free("0::/elsewhere\n"), 5000u) << "a mount that shows less";
    EXPECT_EQ(free("8:pids:/x\n4:memory:/old\n0::/\n"), 150u);
    EXPECT_EQ(free("4:cpu,memory:/old\n"), 150u);
    EXPECT_EQ(free(""), 5000u);
    fs::remove_all(mount);
}

// Whether the system was asked for large pages where `address` lies.
bool asked_for_large_pages(const void* address) {
    std::ifstream mappings("/proc/self/smaps");
    bool inside = false;
    for (std::string line; std::getline(mappings, line);) {
        std::uintptr_t begin = 0, end = 0;
        char minus = 0;
        if (std::istringstream range(line); range >> std::hex >> begin >> minus >> end && minus == '-')
            inside =
                begin <= reinterpret_cast<std::uintptr_t>(address) && reinterpret_cast<std::uintptr_t>(address) < end;
        else if (inside && line.starts_with("VmFlags:"))
            return line.find(" hg") != std::string::npos;
    }
    return false;
}

// A program that waits for something that never comes, in its end: first where the signals of timers mean that all is
// to be saved, as in the demo, then after that.
void end_after(int signal) {
    end_at_interrupts();
    watch_stop_signals();
    std::raise(signal);
    if (stop_signal() != signal)
        ::_exit(1);
    end_soon();
    ::sleep(20);
    ::sleep(20); // the first may be interrupted
}

TEST(StopSignalsDeathTest, AnEndThatHangsIsEnded) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    for (const int signal : {SIGTERM, SIGUSR1, SIGALRM})
        EXPECT_EXIT(end_after(signal), testing::ExitedWithCode(128 + signal), "") << signal;
}

// Whoever starts a program may have it spared.
TEST(StopSignalsDeathTest, IgnoredSignalsStayIgnored) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto spared = [] {
        for (const int signal : {SIGHUP, SIGUSR1, SIGUSR2, SIGALRM})
            std::signal(signal, SIG_IGN);
        watch_stop_signals();
        for (const int signal : {SIGHUP, SIGUSR1, SIGUSR2, SIGALRM})
            std::raise(signal);
        ::_exit(stop_signal() == 0 ? 0 : 1);
    };
    EXPECT_EXIT(spared(), testing::ExitedWithCode(0), "");
}

TEST(LargePages, LargePiecesAlone) {
    if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage"))
        GTEST_SKIP() << "the system has no large pages";
    for (const bool large : {false, true}) {
        const std::size_t bytes = large ? large_piece + 1000 : large_piece / 2;
        void* const mapping = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        ASSERT_NE(mapping, MAP_FAILED);
        char* const piece = static_cast<char*>(mapping) + 16; // as malloc has it
        prefer_large_pages(piece, bytes - 16);
        EXPECT_EQ(asked_for_large_pages(piece + bytes / 2), large);
        ::munmap(mapping, bytes);
    }
}

} // namespace
} // namespace sunfleck
