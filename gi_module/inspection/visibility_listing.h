// What the visibility database says of one surface patch: a row for each light sample.
#pragma once

#include "gi_module/light_sampling/sample_set.h"
#include "gi_module/transport/listing.h"
#include "gi_module/visibility/visibility_database.h"

namespace sunfleck::gi {

std::span<const Listing> visibility_listings();

// `entity`: whose surface it is; `position`, `normal` (geometric, on the side that is looked at): in the space that is
// lit. `is_mover`: the entity is no static geometry. `database`: null, or not of these samples: there are no rows, and
// the summary says why.
ListingContent list_visibility(const VisibilityDatabase* database, const SampleSet& samples, ecs::Entity entity,
                               bool is_mover, vec3 position, vec3 normal);

} // namespace sunfleck::gi
