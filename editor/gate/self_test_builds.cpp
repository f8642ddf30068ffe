#include "editor/gate/self_test_builds.h"

#include "editor/gate/revision_build.h"
#include "engine/core/file.h"
#include "engine/core/random.h"

#include <algorithm>
#include <sstream>

namespace sunfleck::gate {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t alignments[] = {16, 32, 64}; // bytes

struct Builder {
    const fs::path& root;
    const fs::path& folder;
    const Patience& patience;
    const std::function<void(const std::string&)>& say;

    // Programs find their scenes beside their folder.
    fs::path program(const std::string& name) const { return folder / "bin" / name; }
    fs::path tree(const std::string& name) const { return folder / name; }

    Status configure(const std::string& name, const std::vector<std::string>& options) const {
        std::vector<std::string> arguments = {"cmake",
                                              "-S",
                                              root.string(),
                                              "-B",
                                              tree(name).string(),
                                              "-G",
                                              "Ninja",
                                              "-DCMAKE_BUILD_TYPE=Release",
                                              "-DSUNFLECK_BUILD_TESTS=OFF",
                                              "-DSUNFLECK_PRECOMPILE=ON",
                                              "-DSUNFLECK_BATCHES=ON"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const Result<std::string> output = run_command(arguments, patience);
        return output ? Status() : Status(output.error());
    }
    Status build(const std::string& name) const {
        const Result<std::string> output =
            run_command({"cmake", "--build", tree(name).string(), "--target", "sunfleck"}, patience);
        return output ? Status() : Status(output.error());
    }
    // The tree's program under its own name. Renamed last: one that is there is whole.
    Status keep(const std::string& tree_name, const std::string& name) const {
        SUNFLECK_ASSIGN(const std::string bytes, read_file(tree(tree_name) / "bin" / "sunfleck"));
        return write_file(program(name), bytes, 0777);
    }
    Status make(const std::string& name, const std::vector<std::string>& options) const {
        std::error_code code;
        if (fs::exists(program(name), code))
            return {};
        say("building '" + name + "' in " + tree(name).string());
        SUNFLECK_TRY(configure(name, options));
        SUNFLECK_TRY(build(name));
        return keep(name, name);
    }
};

// Names of the program's functions, shuffled: the linker lays their sections in this order.
Result<std::string> random_order(const fs::path& program, std::uint32_t seed, const Patience& patience) {
    SUNFLECK_ASSIGN(const std::string symbols, run_command({"nm", "--defined-only", program.string()}, patience));
    std::vector<std::pair<std::uint32_t, std::string>> order;
    std::istringstream lines(symbols);
    std::string address, kind, name;
    while (lines >> address >> kind >> name)
        if (kind == "t" || kind == "T" || kind == "W")
            order.emplace_back(hash_combine(seed, std::uint32_t(order.size())), ".text." + name);
    std::sort(order.begin(), order.end());
    std::string text;
    for (const auto& [key, section] : order)
        text += section + "\n";
    return text;
}

// One of the rebuilds: objects compiled for an alignment, which the rebuilds of that alignment share, in a new order.
Status make_rebuild(const Builder& builder, std::uint32_t index, const std::string& name) {
    std::error_code code;
    if (fs::exists(builder.program(name), code))
        return {};
    const std::string alignment = std::to_string(alignments[index % std::size(alignments)]);
    const std::string tree = "align" + alignment;
    const fs::path order_file = builder.folder / (tree + ".order");
    builder.say("building '" + name + "' in " + builder.tree(tree).string());
    fs::create_directories(builder.folder, code);
    if (!fs::exists(order_file, code))
        SUNFLECK_TRY(write_file(order_file, ""));
    SUNFLECK_TRY(builder.configure(
        tree, {"-DCMAKE_CXX_FLAGS=-ffunction-sections -falign-functions=" + alignment,
               "-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=gold -Wl,--section-ordering-file=" + order_file.string()}));
    SUNFLECK_TRY(builder.build(tree));
    const fs::path built = builder.tree(tree) / "bin" / "sunfleck";
    SUNFLECK_ASSIGN(const std::string order, random_order(built, index + 1, builder.patience));
    SUNFLECK_TRY(write_file(order_file, order));
    fs::remove(built, code); // the linker does not know that the order is an input
    SUNFLECK_TRY(builder.build(tree));
    return builder.keep(tree, name);
}

} // namespace

Result<SelfTestPrograms> build_self_test_programs(const fs::path& root, const fs::path& folder, std::uint32_t rebuilds,
                                                  const Patience& patience,
                                                  const std::function<void(const std::string&)>& say) {
    const Builder builder{root, folder, patience, say};
    std::error_code code;
    fs::create_directories(folder / "bin", code);
    SUNFLECK_TRY(builder.make("base", {}));
    SUNFLECK_TRY(builder.make("slow", {"-DSUNFLECK_SLOW_WORK=ON"}));
    SelfTestPrograms programs{builder.program("base"), builder.program("slow"), {}};
    for (std::uint32_t i = 0; i < rebuilds; ++i) {
        const std::string name = (i < 9 ? "rebuild_0" : "rebuild_") + std::to_string(i + 1);
        SUNFLECK_TRY(make_rebuild(builder, i, name));
        programs.rebuilds.push_back(builder.program(name));
    }
    fs::create_directory_symlink(builder.tree("base") / "scenes", folder / "scenes", code);
    return programs;
}

} // namespace sunfleck::gate
