#include "gi_module/light_sampling/sampling_settings.h"

#include "gi_module/light_sampling/sample_source.h"

namespace sunfleck::gi {
namespace {

Field source_field() {
    Field field = SUNFLECK_CHOICE(SamplingSettings, source, "How light samples are generated");
    for (const SampleSource& source : sample_sources())
        field.choices.push_back(source.name);
    return field.flagged(needs_new_samples);
}

std::vector<Field> sampling_fields() {
    std::vector<Field> fields = {
        source_field(),
        SUNFLECK_FIELD(SamplingSettings, lights, "", 0, 65536, "Number of light samples; more is smoother and slower"),
        SUNFLECK_FIELD(SamplingSettings, baked_samples, "", 0, 16384,
                       "Light that is baked is refined by so many samples over some hundred frames, and costs no more "
                       "afterwards; 0: it is that of the light samples"),
        SUNFLECK_FIELD(SamplingSettings, direct_share, "", 0, 1,
                       "Share of the samples that lie on emitters: direct light"),
        SUNFLECK_FIELD(SamplingSettings, dynamic_share, "", 0, 1,
                       "Share of the samples for emitters that move or vary, if there are any"),
        SUNFLECK_FIELD(
            SamplingSettings, mover_share, "", 0, 1,
            "Share of the samples for the light that movers reflect, if there are any; 0: they reflect none"),
        SUNFLECK_FIELD(SamplingSettings, punctual_lights, "lights", 0, 256,
                       "Suns, point lights and spots, the brightest first, that are punctual light in the light plan: "
                       "sharp shadows, at a cost for each; others are light samples like all else"),
        SUNFLECK_FIELD(SamplingSettings, bounces, "", 0, 64, "Maximum number of reflections; 0 is direct light only"),
        SUNFLECK_FIELD(SamplingSettings, seed, "", 0, 4294967295.0, "Another seed gives another set of samples"),
        SUNFLECK_CHOICE(SamplingSettings, sequence, "Random numbers of the samples; sobol is smoother at equal count",
                        "pseudo_random", "sobol"),
        SUNFLECK_CHOICE(
            SamplingSettings, termination,
            "Random walks end at the bounce limit only, or also by Russian roulette, with samples of nearly "
            "equal flux",
            "bounce_limit", "russian_roulette"),
        SUNFLECK_FIELD(SamplingSettings, candidates, "", 1, 1024,
                       "Reflected samples are clustered from this many times as many; 1: no clustering"),
        SUNFLECK_FIELD(SamplingSettings, spread, "", 0, 1,
                       "How clusters are subdivided: 0 by their flux, 1 by the surface that they cover"),
        SUNFLECK_CHOICE(SamplingSettings, sampled_light,
                        "Light that samples are made for: what some technique lights, or all of it, so that pictures "
                        "of parts of the light have the samples of the whole",
                        "used", "all")};
    for (Field& field : fields)
        field = field.flagged(needs_new_samples);
    return fields;
}

} // namespace

const TypeDescription& SamplingSettings::description() {
    static const TypeDescription type{"SamplingSettings", 1,
                                      "Light samples (VPLs): how many, and how they are generated.", sampling_fields()};
    return type;
}

bool SampleRequest::same_samples(const SampleRequest& other) const {
    return direct == other.direct && indirect == other.indirect && movers_are_static == other.movers_are_static &&
           equal_fields(description(), static_cast<const SamplingSettings*>(this),
                        static_cast<const SamplingSettings*>(&other), needs_new_samples);
}

const TypeDescription& LightSettings::description() {
    static const TypeDescription type{
        "LightSettings",
        1,
        "How light samples become lights.",
        {SUNFLECK_FIELD(LightSettings, mover_paths, "", 0, 1,
                        "Doors and other large boxes that move block the paths of reflected light"),
         SUNFLECK_FIELD(LightSettings, clamp_scale, "", 0.001, 1e6,
                        "Scales the bound of the geometry term; more is brighter in corners and blotchier")}};
    return type;
}

} // namespace sunfleck::gi
