#include "engine/core/stage_times.h"

#ifdef SUNFLECK_SLOW_WORK
#include "engine/core/slow_work.h"
#endif

#include <algorithm>
#include <new>

namespace sunfleck {
namespace {

double milliseconds(const StageScope& scope) {
    return std::chrono::duration<double, std::milli>(scope.end - scope.begin).count();
}

#ifdef SUNFLECK_SLOW_WORK
// Real work in addition, in thousands of operations.
void add_slow_work(const char* stage) {
    const int amount = slow_work_amount(stage);
    volatile float value = 0.0f;
    for (int i = 0; i < 1000 * amount; ++i)
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
    const auto end = std::chrono::steady_clock::now();
    try {
        times_.scopes_.push_back({stage_, begin_, end});
    } catch (const std::bad_alloc&) { // a time that is not kept is better than a program that ends in a destructor
    }
}

} // namespace sunfleck
