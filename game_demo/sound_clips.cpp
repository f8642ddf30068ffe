#include "game_demo/sound_clips.h"

#include "engine/app/sound.h"
#include "engine/core/random.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {
namespace {

constexpr float rate = float(app::Sound::sample_rate);

// `sample` gets the time in seconds.
template <typename F>
std::vector<float> clip(float seconds, const F& sample) {
    std::vector<float> samples;
    const auto count = std::size_t(seconds * rate);
    samples.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        samples.push_back(sample(float(i) / rate));
    return samples;
}

float tone(float frequency, float time) {
    return std::sin(2.0f * pi * frequency * time);
}

// White noise below a cut-off, in Hz, by a filter of the first order.
class Noise {
public:
    Noise(std::uint32_t seed, float cut_off) : seed_(seed), share_(1.0f - std::exp(-2.0f * pi * cut_off / rate)) {}
    float next() {
        const float white = 2.0f * to_unit_float(hash_combine(seed_, count_++)) - 1.0f;
        return value_ += share_ * (white - value_);
    }

private:
    std::uint32_t seed_, count_ = 0;
    float share_, value_ = 0.0f;
};

// Rises within `attack` and falls towards the end.
float bump(float time, float attack, float seconds) {
    return std::min({time / attack, (seconds - time) / (0.5f * seconds), 1.0f});
}

std::vector<float> step_clip() {
    Noise noise(1, 900.0f);
    return clip(0.14f, [&](float t) { return std::exp(-t / 0.03f) * (2.2f * noise.next() + 0.35f * tone(70.0f, t)); });
}

std::vector<float> slide_clip() {
    constexpr float seconds = 1.1f;
    Noise noise(2, 500.0f);
    return clip(seconds,
                [&](float t) { return bump(t, 0.15f, seconds) * (1.6f * noise.next() + 0.12f * tone(55.0f, t)); });
}

std::vector<float> creak_clip() {
    constexpr float seconds = 0.9f;
    Noise noise(3, 2500.0f);
    float phase = 0.0f;
    return clip(seconds, [&](float t) {
        phase += (240.0f + 90.0f * std::sin(9.0f * t)) / rate;
        const float pulse = std::pow(std::max(std::sin(2.0f * pi * phase), 0.0f), 8.0f);
        return 0.5f * bump(t, 0.1f, seconds) * (pulse - 0.2f + 0.3f * noise.next());
    });
}

std::vector<float> click_clip() {
    Noise noise(4, 4000.0f);
    return clip(0.12f, [&](float t) {
        return std::exp(-t / 0.012f) * 0.8f * noise.next() + 0.4f * std::exp(-t / 0.03f) * tone(1150.0f, t);
    });
}

std::vector<float> chime_clip() {
    return clip(2.2f, [](float t) {
        const float later = std::max(t - 0.16f, 0.0f);
        const float first = std::exp(-t / 0.5f) * (tone(659.0f, t) + 0.3f * tone(1318.0f, t));
        const float second = std::exp(-later / 0.6f) * (tone(988.0f, later) + 0.3f * tone(1976.0f, later));
        return 0.35f * std::min(t / 0.004f, 1.0f) * (first + second);
    });
}

// Whole numbers of waves a second repeat each second.
std::vector<float> hum_clip() {
    return clip(1.0f, [](float t) {
        return (0.75f + 0.25f * tone(3.0f, t)) * (0.4f * tone(220.0f, t) + 0.2f * tone(330.0f, t));
    });
}

std::vector<float> lift_clip() {
    return clip(1.0f, [](float t) {
        return 0.4f * tone(60.0f, t) + 0.25f * tone(121.0f, t) + 0.1f * tone(182.0f, t) * (1.0f + tone(7.0f, t));
    });
}

// Noise whose end is blended into its beginning.
std::vector<float> scrape_clip() {
    constexpr float blend = 0.2f;
    Noise noise(5, 700.0f);
    std::vector<float> longer = clip(1.0f + blend, [&](float) { return 1.8f * noise.next(); });
    const auto count = std::size_t(rate), blended = longer.size() - count;
    for (std::size_t i = 0; i < blended; ++i) {
        const float t = float(i) / float(blended);
        longer[i] = std::sqrt(t) * longer[i] + std::sqrt(1.0f - t) * longer[count + i];
    }
    longer.resize(count);
    return longer;
}

} // namespace

std::vector<float> clip_of(SoundKind kind) {
    constexpr std::vector<float> (*clips[sound_kinds])() = {step_clip,  slide_clip, creak_clip, click_clip,
                                                            chime_clip, hum_clip,   lift_clip,  scrape_clip};
    std::vector<float> samples = clips[std::size_t(kind)]();
    for (float& sample : samples)
        sample = std::clamp(sample, -1.0f, 1.0f);
    return samples;
}

} // namespace sunfleck::demo
