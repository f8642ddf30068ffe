#include "editor/command_line/flicker_meter.h"

#include <cassert>

namespace sunfleck::command_line {
namespace {

double squared(vec3 v) {
    return double(glm::dot(v, v));
}

} // namespace

void FlickerMeter::add(const io::Picture& picture, const io::Picture& limit) {
    assert(picture.pixels.size() == limit.pixels.size());
    io::Picture difference = limit;
    double mean = 0.0, counted = 0.0;
    for (std::size_t i = 0; i < limit.pixels.size(); ++i) {
        const bool counts = picture.pixels[i].w > 0.0f && limit.pixels[i].w > 0.0f;
        difference.pixels[i] = vec4(vec3(picture.pixels[i]) - vec3(limit.pixels[i]), counts ? 1.0f : 0.0f);
        mean += counts ? double(glm::length(vec3(limit.pixels[i]))) : 0.0;
        counted += counts ? 1.0 : 0.0;
    }
    if (counted <= 0.0)
        return;
    mean /= counted;
    double error = 0.0, change = 0.0, compared = 0.0;
    for (std::size_t i = 0; i < limit.pixels.size(); ++i) {
        const vec4 now = difference.pixels[i];
        if (now.w <= 0.0f)
            continue;
        const double scale = 1.0 / (squared(vec3(limit.pixels[i])) + 0.01 * mean * mean);
        error += squared(vec3(now)) * scale;
        if (!last_ || last_->pixels[i].w <= 0.0f)
            continue;
        change += squared(vec3(now) - vec3(last_->pixels[i])) * scale;
        compared += 1.0;
    }
    error_ += error / counted;
    change_ += compared > 0.0 ? change / compared : 0.0;
    ++frames_;
    last_ = std::move(difference);
}

} // namespace sunfleck::command_line
