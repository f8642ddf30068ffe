#include "editor/gate/revision_build.h"

namespace sunfleck::gate {
namespace {

namespace fs = std::filesystem;

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

// The sources of a revision, without touching the working tree.
Status extract(const fs::path& root, const std::string& revision, const fs::path& to, const Patience& patience) {
    std::error_code code;
    fs::create_directories(to, code);
    if (code)
        return Error{"cannot make '" + to.string() + "': " + code.message()};
    const fs::path archive = to.string() + ".tar";
    SUNFLECK_TRY(run_command({"git", "-C", root.string(), "archive", "-o", archive.string(), revision}, patience));
    SUNFLECK_TRY(run_command({"tar", "-xf", archive.string(), "-C", to.string()}, patience));
    fs::remove(archive, code);
    return {};
}

} // namespace

Result<std::string> run_command(const std::vector<std::string>& arguments, const Patience& patience) {
    SUNFLECK_ASSIGN(const auto child, ChildProcess::start("'" + arguments.front() + "'", arguments, patience));
    return child->read_to_end();
}

Result<fs::path> project_root(const Patience& patience) {
    const Result<std::string> top = run_command({"git", "rev-parse", "--show-toplevel"}, patience);
    if (!top)
        return Error{"the current folder must lie in a git working tree of the project: " + top.error().message};
    return fs::path(first_line(*top));
}

Result<fs::path> build_revision(const std::string& revision, const Patience& patience,
                                const std::function<void(const std::string&)>& say) {
    SUNFLECK_ASSIGN(const fs::path root, project_root(patience));
    const Result<std::string> commit =
        run_command({"git", "-C", root.string(), "rev-parse", "--verify", "--quiet", revision + "^{commit}"}, patience);
    if (!commit)
        return Error{"--base '" + revision + "': git knows no such revision"};
    const std::string name = first_line(*commit).substr(0, 12);
    const fs::path folder = root / "build" / "gate" / name, source = folder / "source", build = folder / "build";
    const fs::path program = build / "bin" / "sunfleck", done = folder / "built";
    std::error_code code;
    if (fs::exists(done, code) && fs::exists(program, code))
        return program;
    say("building revision " + name + " in " + folder.string());
    SUNFLECK_TRY(extract(root, first_line(*commit), source, patience));
    // File names inside of the program are those of the project itself: the same source gives the same program.
    SUNFLECK_TRY(run_command({"cmake", "-S", source.string(), "-B", build.string(), "-G", "Ninja",
                              "-DCMAKE_BUILD_TYPE=Release", "-DSUNFLECK_BUILD_TESTS=OFF", "-DSUNFLECK_PRECOMPILE=ON",
                              "-DSUNFLECK_BATCHES=ON", // as the release preset
                              "-DCMAKE_CXX_FLAGS=-ffile-prefix-map=" + source.string() + "=" + root.string()},
                             patience));
    SUNFLECK_TRY(run_command({"cmake", "--build", build.string(), "--target", "sunfleck"}, patience));
    fs::create_directory(done, code);
    return program;
}

} // namespace sunfleck::gate
