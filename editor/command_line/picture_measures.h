// What a viewer notices first in a displayed picture: stairs along edges, stains, lines that crawl. FLIP and mean
// errors hardly see these. All compare display values with a picture of the same view without noise and stairs.
#pragma once

#include "engine/io/image.h"

#include <span>

namespace sunfleck::command_line {

// The mean of each square of `side` x `side` pixels; sizes that are no multiple of it lose the rest.
io::Picture box_filtered(const io::Picture& picture, std::uint32_t side);

// Mean difference in luminance within two pixels of the reference's edges (its steepest twentieth of all pixels), both
// brought to one mean in each block of 16x16 pixels: how bright a surface is does not count.
double edge_error(const io::Picture& picture, const io::Picture& reference);

// Share of the pixels where luminance changes by more than 3/255 from one pixel to the next, although the reference's
// changes by less than 1/255 everywhere within three pixels.
double stain_share(const io::Picture& picture, const io::Picture& reference);

// How far changes from frame to frame are from those of a supersampled picture of the same frames, over the size of
// those. Both have as many frames, two at least.
double crawl(std::span<const io::Picture> frames, std::span<const io::Picture> references);

} // namespace sunfleck::command_line
