// The parts of ./run bench smoothness; see tests/bench/smoothness.sh.
#include "engine/core/exit_status.h"
#include "tests/bench/smoothness/measure.h"
#include "tests/bench/smoothness/report.h"
#include "tests/bench/smoothness/views.h"

#include <cstdio>
#include <cstdlib>

namespace sunfleck {
namespace {

constexpr const char* usage = "smoothness_bench rooms FOLDER\n"
                              "smoothness_bench views LEVEL FOLDER\n"
                              "smoothness_bench halve PICTURE OUTPUT\n"
                              "smoothness_bench pacing DEMO ROOMS ROOM SECONDS OUTPUT [ARGUMENTS OF THE DEMO...]\n"
                              "smoothness_bench latency DEMO ROOMS ROOM SAMPLES OUTPUT [ARGUMENTS OF THE DEMO...]\n"
                              "smoothness_bench report FOLDER\n";

int fail(const Status& status) {
    if (status)
        return exit_done;
    std::fprintf(stderr, "error: %s\n", status.error().message.c_str());
    return exit_failed;
}

int run(const std::vector<std::string>& arguments) {
    const std::string what = arguments.empty() ? "" : arguments[0];
    if (what == "rooms" && arguments.size() == 2)
        return fail(bench::write_rooms(arguments[1]));
    if (what == "views" && arguments.size() == 3)
        return fail(bench::write_views(arguments[1], arguments[2]));
    if (what == "halve" && arguments.size() == 3)
        return fail(bench::halve_picture(arguments[1], arguments[2]));
    if (what == "report" && arguments.size() == 2) {
        const Result<bool> held = bench::report(arguments[1]);
        return held ? (*held ? exit_done : exit_failed) : fail(held.error());
    }
    if ((what == "pacing" || what == "latency") && arguments.size() >= 6) {
        const std::filesystem::path output = std::filesystem::absolute(arguments[5]);
        bench::GameStart start{std::filesystem::absolute(arguments[1]),
                               std::filesystem::absolute(arguments[2]),
                               output.string() + ".run",
                               arguments[3],
                               {arguments.begin() + 6, arguments.end()}};
        const double count = std::atof(arguments[4].c_str());
        return fail(what == "pacing" ? bench::measure_pacing(start, count, output)
                                     : bench::measure_latency(start, unsigned(count), output));
    }
    std::fputs(usage, stderr);
    return exit_usage;
}

} // namespace
} // namespace sunfleck

int main(int count, char** arguments) {
    return sunfleck::run({arguments + 1, arguments + count});
}
