// Sounds at places, by OpenAL. Clips are samples that the program computes; nothing is read from files. Without a sound
// device every call works and nothing is heard. One thread at a time.
#pragma once

#include "engine/core/maths.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace sunfleck::app {

class Sound {
public:
    static constexpr std::uint32_t sample_rate = 22050; // Hz
    using Clip = std::uint32_t;

    // Opens the system's default device.
    Sound();
    ~Sound();
    Sound(const Sound&) = delete;
    Sound& operator=(const Sound&) = delete;

    // The device's name; empty: there is none.
    const std::string& device() const { return device_; }
    // Mono, -1 to 1. The clip is valid as long as this.
    Clip add(std::span<const float> samples);
    // Where the listener is and looks to, Y up, in metres.
    void listen(vec3 place, vec3 forward);
    // Of all sounds, 0 to 1.
    void set_volume(float volume);
    // Once. Where more than a dozen sound at the same time, the oldest ends.
    void play(Clip clip, vec3 place, float gain);
    // A sound that goes on, one per key, until it is set with a gain of 0. `pitch`: times the clip's.
    void keep(std::uint64_t key, Clip clip, vec3 place, float gain, float pitch);

private:
    struct Device;
    std::unique_ptr<Device> open_; // null: silent
    std::string device_;
};

} // namespace sunfleck::app
