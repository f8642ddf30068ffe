#include "engine/app/sound.h"

#include <AL/al.h>
#include <AL/alc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <vector>

namespace sunfleck::app {
namespace {

constexpr float reference_distance = 1.5f; // m, within which a sound is no louder
constexpr float roll_off = 1.3f;

ALuint make_source() {
    ALuint source = 0;
    alGenSources(1, &source);
    alSourcef(source, AL_REFERENCE_DISTANCE, reference_distance);
    alSourcef(source, AL_ROLLOFF_FACTOR, roll_off);
    return source;
}

void place_source(ALuint source, vec3 place, float gain) {
    alSource3f(source, AL_POSITION, place.x, place.y, place.z);
    alSourcef(source, AL_GAIN, gain);
}

// OpenAL, ALSA and sndio say on standard error what they do not find. That there is no sound is no error of the
// program's: the first is asked for silence, the others are left out where there is no card, since nothing keeps them
// quiet. What the user has set goes first.
void expect_no_device() {
    std::error_code code;
    ::setenv("ALSOFT_LOGLEVEL", "0", 0);
    if (!std::filesystem::exists("/dev/snd", code))
        ::setenv("ALSOFT_DRIVERS", "-alsa,-sndio,", 0); // the last comma: all others are tried
}

} // namespace

struct Sound::Device {
    ALCdevice* device = nullptr;
    ALCcontext* context = nullptr;
    std::vector<ALuint> buffers;
    std::array<ALuint, 12> once{};
    std::size_t next = 0;
    std::map<std::uint64_t, ALuint> kept;

    ~Device() {
        if (context != nullptr) {
            for (const auto& [key, source] : kept)
                alDeleteSources(1, &source);
            alDeleteSources(ALsizei(once.size()), once.data());
            alDeleteBuffers(ALsizei(buffers.size()), buffers.data());
            alcMakeContextCurrent(nullptr);
            alcDestroyContext(context);
        }
        if (device != nullptr)
            alcCloseDevice(device);
    }
};

Sound::Sound() : open_(std::make_unique<Device>()) {
    expect_no_device();
    open_->device = alcOpenDevice(nullptr);
    open_->context = open_->device != nullptr ? alcCreateContext(open_->device, nullptr) : nullptr;
    if (open_->context == nullptr || alcMakeContextCurrent(open_->context) != ALC_TRUE) {
        open_.reset();
        return;
    }
    device_ = alcGetString(open_->device, ALC_DEVICE_SPECIFIER);
    alDistanceModel(AL_INVERSE_DISTANCE_CLAMPED);
    for (ALuint& source : open_->once)
        source = make_source();
}

Sound::~Sound() = default;

Sound::Clip Sound::add(std::span<const float> samples) {
    if (!open_)
        return 0;
    std::vector<std::int16_t> whole;
    whole.reserve(samples.size());
    for (const float sample : samples)
        whole.push_back(std::int16_t(std::lround(32767.0f * std::clamp(sample, -1.0f, 1.0f))));
    ALuint buffer = 0;
    alGenBuffers(1, &buffer);
    alBufferData(buffer, AL_FORMAT_MONO16, whole.data(), ALsizei(2 * whole.size()), ALsizei(sample_rate));
    open_->buffers.push_back(buffer);
    return buffer;
}

void Sound::listen(vec3 place, vec3 forward) {
    if (!open_)
        return;
    const float orientation[6] = {forward.x, forward.y, forward.z, 0.0f, 1.0f, 0.0f};
    alListener3f(AL_POSITION, place.x, place.y, place.z);
    alListenerfv(AL_ORIENTATION, orientation);
}

void Sound::set_volume(float volume) {
    if (open_)
        alListenerf(AL_GAIN, volume);
}

void Sound::play(Clip clip, vec3 place, float gain) {
    if (!open_)
        return;
    const ALuint source = open_->once[open_->next];
    open_->next = (open_->next + 1) % open_->once.size();
    alSourceStop(source);
    alSourcei(source, AL_BUFFER, ALint(clip));
    place_source(source, place, gain);
    alSourcePlay(source);
}

void Sound::keep(std::uint64_t key, Clip clip, vec3 place, float gain, float pitch) {
    if (!open_)
        return;
    const auto found = open_->kept.find(key);
    if (gain <= 0.0f) {
        if (found == open_->kept.end())
            return;
        alDeleteSources(1, &found->second);
        open_->kept.erase(found);
        return;
    }
    const ALuint source = found != open_->kept.end() ? found->second : make_source();
    place_source(source, place, gain);
    alSourcef(source, AL_PITCH, pitch);
    if (found != open_->kept.end())
        return;
    open_->kept.emplace(key, source);
    alSourcei(source, AL_BUFFER, ALint(clip));
    alSourcei(source, AL_LOOPING, AL_TRUE);
    alSourcePlay(source);
}

} // namespace sunfleck::app
