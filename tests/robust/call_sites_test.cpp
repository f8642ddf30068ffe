// Which places in the sources call what can fail in Vulkan, and that the stories of the fault tests come by all of
// them. Places are found by their debug information: this test is in the builds with sanitizers only.
#include "tests/robust/faulty_vulkan.h"
#include "tests/robust/host_story.h"

#include "test_places.h"

#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>

namespace sunfleck::tests {
namespace {

namespace fs = std::filesystem;

struct Site {
    std::string file; // from the project's folder, or as the compiler was given it
    int line = 0;
    std::string function;
    bool operator<(const Site& other) const {
        return std::tie(file, line, function) < std::tie(other.file, other.line, other.function);
    }
};

// Of programs with windows, and of the viewer that draws the pictures of tool, demo and editor: no host comes there.
const std::map<std::string, const char*> not_for_hosts = {
    {"engine/app/", "windows"},
    {"engine/render/", "drawing of pictures, which hosts do themselves"},
    {"engine/scene/gpu_textures.cpp", "textures of files, which hosts bind themselves"},
    {"engine/gpu/submission.cpp", "submitting, which hosts do themselves"},
    {"engine/gpu/device.cpp", "waiting for a device, which no call of a host's does"},
};

bool is_for_hosts(const Site& site) {
    return std::none_of(not_for_hosts.begin(), not_for_hosts.end(),
                        [&](const auto& entry) { return site.file.compare(0, entry.first.size(), entry.first) == 0; });
}

// Each mention of a function as a member that is called: `vk.vkCreateBuffer(`.
std::set<Site> sites_in_sources() {
    const fs::path root = SUNFLECK_SOURCE_DIR;
    const std::regex call(R"(\bvk\.(vk\w+)\()");
    const std::set<std::string> fallible(faulty::fallible_names.begin(), faulty::fallible_names.end());
    std::set<Site> sites;
    for (const char* folder : {"engine", "gi_module"})
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h")
                continue;
            std::ifstream file(entry.path());
            std::string text;
            for (int line = 1; std::getline(file, text); ++line)
                for (std::sregex_iterator at(text.begin(), text.end(), call), end; at != end; ++at)
                    if (fallible.count((*at)[1]) != 0)
                        sites.insert({fs::relative(entry.path(), root).string(), line, (*at)[1]});
        }
    return sites;
}

// Files and lines of the calls that the stories made.
std::set<Site> sites_reached() {
    Dl_info program{};
    EXPECT_NE(dladdr(reinterpret_cast<const void*>(&sites_in_sources), &program), 0);
    std::string command = "addr2line -e /proc/" + std::to_string(getpid()) + "/exe";
    std::vector<std::uint8_t> functions;
    for (const auto& [function, address] : faulty::state.sites) {
        char text[32]; // a return address is behind its call
        std::snprintf(text, sizeof text, " %#tx",
                      static_cast<const char*>(address) - static_cast<const char*>(program.dli_fbase) - 1);
        command += text;
        functions.push_back(function);
    }
    std::FILE* pipe = popen(command.c_str(), "r");
    EXPECT_NE(pipe, nullptr);
    std::set<Site> sites;
    char line[4096];
    for (std::size_t i = 0; pipe != nullptr && i < functions.size() && std::fgets(line, sizeof line, pipe); ++i) {
        const std::string text = line;
        const std::size_t colon = text.rfind(':');
        sites.insert(
            {text.substr(0, colon), std::atoi(text.c_str() + colon + 1), faulty::fallible_names[functions[i]]});
    }
    if (pipe != nullptr)
        pclose(pipe);
    return sites;
}

// Debug information names files by whichever path the compiler was given, and of a call that goes over several lines
// the line of some part.
bool is_reached(const Site& site, const std::set<Site>& reached) {
    return std::any_of(reached.begin(), reached.end(), [&](const Site& one) {
        return one.file.ends_with(site.file) && one.function == site.function && std::abs(one.line - site.line) <= 2;
    });
}

class RobustCallSites : public GpuTest {};

TEST_F(RobustCallSites, AreAllReachedByTheStoriesOfFaults) {
    faulty::state = {};
    HostProgram program(device());
    host::VulkanHandles handles = program.handles();
    handles.get_instance_proc_addr = faulty::get_instance_proc_addr;
    {
        auto context = host::Context::create(handles);
        ASSERT_TRUE(context) << context.error().message;
        ASSERT_TRUE(Story::begin(**context));
        Story story;
        for (int frame = 0; frame < frames; ++frame) {
            ASSERT_TRUE(story.step(**context, frame));
            ASSERT_TRUE(program.frame(**context, 0, Story::show(program, frame)));
        }
        program.wait();
    }
    const std::set<Site> reached = sites_reached();
    int sites = 0, of_others = 0;
    for (const Site& site : sites_in_sources()) {
        ++(is_for_hosts(site) ? sites : of_others);
        EXPECT_EQ(is_reached(site, reached), is_for_hosts(site))
            << site.file << ":" << site.line << ": " << site.function;
    }
    EXPECT_GE(sites, 27) << "calls are written in another way than the test looks for";
    std::printf("%d places where hosts' calls can fail, all reached; %d of windows and viewers\n", sites, of_others);
}

} // namespace
} // namespace sunfleck::tests
