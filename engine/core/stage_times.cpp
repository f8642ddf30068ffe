#include "engine/core/stage_times.h"

#include <algorithm>
#ifdef SUNFLECK_SLOW_WORK
#include <cstdlib>
#endif

namespace sunfleck {
namespace {

double milliseconds(const StageScope& scope) {
    return std::chrono::duration<double, std::milli>(scope.end - scope.begin).count();
}

#ifdef SUNFLECK_SLOW_WORK
// Builds that the frame-time gate tests itself with (engine/gpu/slow_work.h): real work in addition, in thousands of
// operations.
void add_slow_work(const std::string& stage) {
    const char *wanted = std::getenv("SUNFLECK_SLOW"), *amount = std::getenv("SUNFLECK_SLOW_AMOUNT");
    if (wanted == nullptr || amount == nullptr || stage != wanted)
        return;
    volatile float value = 0.0f;
    for (int i = 0; i < 1000 * std::atoi(amount); ++i)
        value = value * 0.999f + float(i);
}
#endif

} // namespace

void sort_by_begin(std::vector<StageScope>& scopes) {
    std::stable_sort(scopes.begin(), scopes.end(), [](const StageScope& a, const StageScope& b) {
        return a.begin != b.begin ? a.begin < b.begin : a.end > b.end;
    });
}

std::map<std::string, double> own_milliseconds(std::vector<StageScope> scopes) {
    sort_by_begin(scopes);
    std::map<std::string, double> result;
    std::vector<const StageScope*> open;
    for (const StageScope& scope : scopes) {
        while (!open.empty() && scope.begin >= open.back()->end)
            open.pop_back();
        if (!open.empty())
            result[open.back()->name] -= milliseconds(scope);
        result[scope.name] += milliseconds(scope);
        open.push_back(&scope);
    }
    return result;
}

StageTimer::~StageTimer() {
#ifdef SUNFLECK_SLOW_WORK
    add_slow_work(stage_);
#endif
    times_.scopes_.push_back({stage_, begin_, std::chrono::steady_clock::now()});
}

} // namespace sunfleck
